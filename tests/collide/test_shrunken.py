"""The thinner copy of the avatar: inside, no deeper than asked, and simple where the body is wide."""

import numpy as np
import pytest
import trimesh

from tests.collide.surfaces import stacked
from toile.collide.audit import Auditor
from toile.collide.shrunken import WIDE_GAP, shrunken
from toile.geometry.arrays import Float, Int
from toile.geometry.normals import vertex_normals


def arrays(mesh: trimesh.Trimesh) -> tuple[Float, Int]:
    return np.ascontiguousarray(mesh.vertices, np.float64), np.ascontiguousarray(mesh.faces, np.int32)


def sphere(radius: float) -> tuple[Float, Int]:
    return arrays(trimesh.creation.icosphere(subdivisions=3, radius=radius))


def box(x: float, y: float, z: float) -> tuple[Float, Int]:
    mesh = trimesh.creation.box((x, y, z))
    vertices, faces = trimesh.remesh.subdivide_to_size(mesh.vertices, mesh.faces, 0.04)
    return arrays(trimesh.Trimesh(vertices, faces))


def capsule(radius: float, height: float) -> tuple[Float, Int]:
    mesh = trimesh.creation.capsule(height=height, radius=radius, count=[16, 16])
    vertices, faces = trimesh.remesh.subdivide_to_size(mesh.vertices, mesh.faces, 2.0 * radius)
    return arrays(trimesh.Trimesh(vertices, faces))


def assert_inside(vertices: Float, faces: Int, thin: Float, depth: float) -> None:
    """The copy moves no vertex beyond depth, and lies inside."""
    assert np.linalg.norm(thin - vertices, axis=1).max() <= depth * (1 + 1e-9)
    found = Auditor(vertices, faces).audit(thin, faces, np.arange(len(vertices), dtype=np.int32))
    assert len(found.avatar) == 0
    assert 0.0 < trimesh.Trimesh(thin, faces).volume < trimesh.Trimesh(vertices, faces).volume


def assert_simple(thin: Float, faces: Int) -> None:
    """The copy does not cross itself."""
    assert len(Auditor(None, None).audit(thin, faces, np.arange(len(thin), dtype=np.int32)).cloth) == 0


@pytest.mark.parametrize("depth", [0.001, 0.01, 0.03])
def test_a_wide_sphere_shrinks_by_the_depth(depth: float) -> None:
    vertices, faces = sphere(0.2)
    thin = shrunken(vertices, faces, depth)
    assert np.linalg.norm(thin, axis=1) == pytest.approx(0.2 - depth, rel=1e-3)
    assert_inside(vertices, faces, thin, depth)
    assert_simple(thin, faces)


def test_a_thin_part_keeps_a_core() -> None:
    """A capsule of 2 cm across, asked for 3 cm: at most 0.35 of the thickness goes on either side."""
    vertices, faces = capsule(0.01, 0.2)
    thin = shrunken(vertices, faces, 0.03)
    middle = np.abs(vertices[:, 2] - vertices[:, 2].mean()) < 0.06
    radius = np.hypot(thin[middle, 0], thin[middle, 1])
    assert radius.min() > 0.002 and radius.max() < 0.006
    assert_inside(vertices, faces, thin, 0.03)


def test_a_plate_shrinks_by_its_thickness_only() -> None:
    vertices, faces = box(0.4, 0.02, 0.4)
    thin = shrunken(vertices, faces, 0.03)
    centre = np.abs(vertices[:, [0, 2]]).max(axis=1) < 0.08
    assert np.abs(thin[centre, 1]) == pytest.approx(0.01 - 0.35 * 0.02, abs=5e-4)
    assert_inside(vertices, faces, thin, 0.03)


def test_a_box_with_sharp_edges_stays_whole() -> None:
    vertices, faces = box(0.3, 0.3, 0.3)
    thin = shrunken(vertices, faces, 0.02)
    assert_inside(vertices, faces, thin, 0.02)
    assert_simple(thin, faces)
    flat = (np.abs(np.abs(vertices[:, 0]) - 0.15) < 1e-9) & (np.abs(vertices[:, 1:]).max(axis=1) < 0.02)
    assert np.abs(thin[flat, 0]) == pytest.approx(0.13, abs=2e-3)


@pytest.mark.parametrize("gap", [0.005, 0.05])
def test_a_narrow_gap_is_not_opened(gap: float) -> None:
    """Two blocks face each other: there the surface moves by the gap's share of a wide gap."""
    one, faces = box(0.3, 0.3, 0.3)
    vertices, both = stacked([(one, faces), (one + np.array([0.3 + gap, 0.0, 0.0]), faces)])
    thin = shrunken(vertices, both, 0.02)
    central = (np.abs(vertices[:, 1:]).max(axis=1) < 0.05) & (np.abs(vertices[:, 0] - 0.15) < 1e-9)
    opened = vertices[central, 0] - thin[central, 0]
    assert opened.max() <= 0.02 * gap / WIDE_GAP * 1.5 + 1e-4
    away = (np.abs(vertices[:, 1:]).max(axis=1) < 0.05) & (np.abs(vertices[:, 0] + 0.15) < 1e-9)
    assert (thin[away, 0] - vertices[away, 0]).min() > 0.018
    assert_inside(vertices, both, thin, 0.02)
    assert_simple(thin, both)


def test_no_depth_no_motion() -> None:
    vertices, faces = sphere(0.1)
    assert shrunken(vertices, faces, 0.0) == pytest.approx(vertices, abs=1e-15)


def test_normals_point_outward() -> None:
    vertices, faces = sphere(0.1)
    assert vertex_normals(vertices, faces) == pytest.approx(vertices / 0.1, abs=0.02)
    # A vertex that no face uses has no direction, and no NaN either.
    lonely = np.vstack([vertices, [(9.0, 9.0, 9.0)]])
    assert (vertex_normals(lonely, faces)[-1] == 0.0).all()
