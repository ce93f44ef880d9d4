import numpy as np
import pytest

from toile.geometry.arrays import Float, Int
from toile.geometry.patch import Patches, bending_patches
from toile.geometry.topology import triangle_topology
from toile.studies.scenes.flat_meshes import KINDS, mesh


def patches_of(points: Float, faces: Int, rest: Float | None = None) -> Patches:
    corners = np.ascontiguousarray(points[faces]) if rest is None else rest
    return bending_patches(faces, corners, triangle_topology(faces), len(points))


@pytest.mark.parametrize("kind", KINDS)
def test_second_derivatives_of_quadratics_are_exact_on_every_face_borders_included(kind: str) -> None:
    points, faces = mesh(kind, 1.0, 0.7, 0.12)
    u, v = points.T
    values = np.column_stack((0.5 * u * u - 3 * v + 1, 0.5 * v * v + u, u * v))
    derivatives = (patches_of(points, faces).second_derivatives @ values).reshape(-1, 3, 3)
    exact = np.eye(3)[:, [0, 1, 2]]  # columns: functions; rows: uu, vv, uv
    assert np.abs(derivatives - exact).max() < 1e-9


def test_every_face_may_have_a_frame_of_its_own() -> None:
    points, faces = mesh("random", 1.0, 1.0, 0.2)
    generator = np.random.default_rng(0)
    angles = generator.uniform(0, 2 * np.pi, len(faces))
    cosine, sine = np.cos(angles), np.sin(angles)
    turn = np.stack((np.stack((cosine, -sine), 1), np.stack((sine, cosine), 1)), 1)
    rest = np.einsum("tij,tcj->tci", turn, points[faces]) + generator.normal(size=(len(faces), 1, 2))
    u, v = points.T
    hessian = np.array([[1.0, 0.4], [0.4, -0.7]])
    values = 0.5 * (hessian[0, 0] * u * u + hessian[1, 1] * v * v) + hessian[0, 1] * u * v
    found = (patches_of(points, faces, np.ascontiguousarray(rest)).second_derivatives @ values).reshape(-1, 3)
    turned = turn @ hessian @ turn.swapaxes(1, 2)
    exact = np.column_stack((turned[:, 0, 0], turned[:, 1, 1], turned[:, 0, 1]))
    assert np.abs(found - exact).max() < 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_a_constant_moment_is_in_equilibrium_inside(kind: str) -> None:
    """The weak patch test: forces of a constant moment vanish at nodes that no border slope depends on."""
    points, faces = mesh(kind, 1.0, 1.0, 0.08)
    patches = patches_of(points, faces)
    moment = np.tile([1.3, -0.4, 0.9], len(faces)) * np.repeat(patches.areas, 3)
    forces = patches.second_derivatives.T @ moment
    topology = triangle_topology(faces)
    border_slopes = np.unique(patches.side_slopes[topology.border_sides])
    reached = np.zeros(len(points), bool)
    reached[np.unique(patches.slopes[border_slopes].indices)] = True
    reached[np.unique(topology.border_edges)] = True
    assert (~reached).sum() > 30
    assert np.abs(forces[~reached]).max() < 1e-12
    assert np.abs(forces[reached]).max() > 1e-3


def test_formulas_stay_short_on_random_meshes() -> None:
    for seed in range(3):
        points, faces = mesh("random", 1.0, 1.0, 0.1, seed)
        patches = patches_of(points, faces)
        amplification = abs(patches.slopes).sum(axis=1) * np.sqrt(patches.areas.mean())
        assert amplification.max() < 20.0
        assert np.diff(patches.slopes.indptr).max() <= 20


@pytest.mark.parametrize("faces", [[[0, 1, 2]], [[0, 1, 2], [2, 1, 3]], [[0, 1, 2], [0, 2, 3], [0, 3, 1]]])
def test_meshes_too_small_for_a_quadratic_are_exact_on_linear_functions(faces: list[list[int]]) -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.1], [0.2, 0.9], [1.1, 1.2]])
    if len(faces) == 3:
        points = np.array([[0.3, 0.3], [0.0, 0.0], [1.0, 0.1], [0.2, 0.9]])
    patches = patches_of(points, np.array(faces, np.int32))
    linear = np.column_stack((np.ones(len(points)), points))
    assert np.abs(patches.second_derivatives @ linear).max() < 1e-11


def test_a_rolled_sheet_is_unfolded_across_its_seam() -> None:
    """A closed tube has curvature 1/R around it at every face, also where its first and last columns meet."""
    around, along, radius = 40, 5, 0.1
    width = 2 * np.pi * radius / around
    points, faces = mesh("right", around * width, along * width, width)
    rest = np.ascontiguousarray(points[faces])
    column = np.round(points[:, 0] / width).astype(int) % around
    row = np.round(points[:, 1] / width).astype(int)
    node = (column * (along + 1) + row).astype(np.int32)
    angle = 2 * np.pi * np.arange(around) / around
    x = np.stack(
        np.broadcast_arrays(
            radius * np.cos(angle)[:, None], radius * np.sin(angle)[:, None], width * np.arange(along + 1.0)
        ),
        2,
    ).reshape(-1, 3)
    nodes = np.ascontiguousarray(node[faces])
    patches = bending_patches(nodes, rest, triangle_topology(nodes), len(x))
    derivatives = (patches.second_derivatives @ x).reshape(-1, 3, 3)
    bent = np.linalg.norm(derivatives, axis=2) * radius
    assert np.abs(bent[:, 0] - 1.0).max() < 0.01
    # along the surface: first order in edge / radius = 0.157, and squared in the energy
    assert np.abs(bent[:, 1:]).max() < 0.06


def test_a_gathered_seam_keeps_rigid_motions_free() -> None:
    """Across a seam whose rest sides differ in length, a translation still costs nothing."""
    points, faces = mesh("right", 1.0, 1.0, 0.25)
    rest = points[faces]
    wide = points[faces].mean(axis=1)[:, 0] > 0.5
    rest[wide] *= (1.0, 1.4)
    patches = patches_of(points, faces, np.ascontiguousarray(rest))
    assert np.abs(patches.second_derivatives @ np.ones(len(points))).max() < 1e-11


def test_a_held_face_prescribes_the_slope_of_its_plane() -> None:
    points, faces = mesh("random", 1.0, 1.0, 0.2)
    topology = triangle_topology(faces)
    rigid = np.zeros(len(faces), bool)
    rigid[7] = True
    patches = bending_patches(faces, np.ascontiguousarray(points[faces]), topology, len(points), rigid)
    for side in range(3):
        row = patches.slopes[[patches.side_slopes[7, side]]]
        assert set(row.indices.tolist()) <= set(faces[7].tolist())
        a, b = points[faces[7, (side + 1) % 3]], points[faces[7, (side + 2) % 3]]
        normal = np.array([b[1] - a[1], a[0] - b[0]]) / np.linalg.norm(b - a)
        assert (row @ points)[0] * patches.side_signs[7, side] == pytest.approx(normal, abs=1e-10)


def test_a_face_without_area_disturbs_nothing() -> None:
    points, faces = mesh("right", 1.0, 1.0, 0.25)
    rest = np.ascontiguousarray(points[faces])
    rest[5] = rest[5, :1]
    rest[9, 2] = 0.5 * (rest[9, 0] + rest[9, 1])
    derivatives = patches_of(points, faces, rest).second_derivatives
    assert np.isfinite(derivatives.data).all()
    assert np.abs(derivatives @ np.ones(len(points))).max() < 1e-3
    assert not derivatives[15:18].nnz or np.abs(derivatives[15:18].toarray()).max() == 0.0
