"""Meshes with the usual faults of exports become the garment that was meant, with a note."""

from pathlib import Path

import numpy as np
import pytest

from tests.dressing.garment.mesh_parts import octahedron, read, tube
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.geometry.arrays import Int


def area(mesh: GarmentMesh) -> float:
    corners = mesh.positions[mesh.faces]
    return 0.5 * float(
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    )


def edge_face_counts(faces: Int) -> Int:
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    return np.asarray(np.unique(ends, axis=0, return_counts=True)[1])


def test_doubled_faces_count_once(tmp_path: Path) -> None:
    vertices, faces = tube()
    clean = read(tmp_path, (vertices, faces))
    doubled = read(tmp_path, (vertices, [*faces, faces[3], faces[7][::-1]]))
    assert doubled.notes == ("2 faces (480, 481) are left out: other faces lie there",)
    assert np.array_equal(doubled.faces, clean.faces)


def test_double_sided_export_is_one_layer(tmp_path: Path) -> None:
    vertices, faces = tube()
    clean = read(tmp_path, (vertices, faces))
    both = read(tmp_path, (np.concatenate([vertices, vertices]), [*faces, *(
        tuple(corner + len(vertices) for corner in reversed(face)) for face in faces
    )]))  # fmt: skip
    assert area(both) == pytest.approx(area(clean), rel=1e-12)
    assert len(both.notes) == 1 and "other faces lie there" in both.notes[0]


def test_caps_and_needles_close_without_changing_the_area(tmp_path: Path) -> None:
    """A square whose lower triangle has a vertex in the middle of the diagonal, and one split to nothing."""
    square = np.array([(0, 1, 0.3), (1, 1, 0.3), (1, 2, 0.3), (0, 2, 0.3), (0.5, 1.5, 0.3)], float)
    cap = read(tmp_path, (square, [(0, 1, 2), (0, 2, 4), (0, 4, 3), (4, 2, 3)]))
    assert area(cap) == pytest.approx(1.0) and len(cap.faces) == 4
    assert (edge_face_counts(cap.faces) == 1).sum() == 4, "only the outline of the square is a border"
    needle = np.array([(0, 1, 0.3), (1, 1, 0.3), (1, 2, 0.3), (1, 2 + 1e-9, 0.3), (0, 2, 0.3)], float)
    mended = read(tmp_path, (needle, [(0, 1, 2), (0, 2, 3), (0, 3, 4)]))
    assert area(mended) == pytest.approx(1.0) and len(mended.faces) == 2
    assert mended.notes == ("face 1 is mended: no area",)


def test_borders_that_all_but_touch_are_joined(tmp_path: Path) -> None:
    vertices, faces = tube(around=40)
    left = [face for number, face in enumerate(faces) if number % 40 < 20]
    right = [face for number, face in enumerate(faces) if number % 40 >= 20]
    moved = vertices + np.array([2e-5, 0.0, 0.0])
    mesh = read(tmp_path, (vertices, left), (moved, right))
    clean = read(tmp_path, (vertices, faces))
    assert mesh.notes == ("26 vertices on borders that lie up to 20 um apart are joined",)
    assert (edge_face_counts(mesh.faces) == 1).sum() == (edge_face_counts(clean.faces) == 1).sum() == 80
    far = read(tmp_path, (vertices, left), (vertices + np.array([5e-4, 0.0, 0.0]), right))
    assert not far.notes and (edge_face_counts(far.faces) == 1).sum() == 80 + 4 * 12


def test_a_piece_sewn_on_stays_joined(tmp_path: Path) -> None:
    vertices, faces = tube()
    fin = [(160 + 0, 200 + 0, 521, 520), (200 + 0, 240 + 0, 522, 521)]
    out = np.array([(0.0, 1.08 + 0.02 * row, 0.33) for row in range(3)])
    mesh = read(tmp_path, (np.concatenate([vertices, out]), [*faces, *fin]))
    assert (edge_face_counts(mesh.faces) == 3).sum() == 2
    assert area(mesh) == pytest.approx(area(read(tmp_path, (vertices, faces))) + 0.04 * 0.03, rel=1e-6)
    assert "sewn on" in mesh.notes[0]


@pytest.mark.parametrize("thickness", [3e-4, 1.5e-3])
def test_two_walls_are_one_layer_of_that_thickness(tmp_path: Path, thickness: float) -> None:
    (outer, faces), (inner, _) = tube(0.3), tube(0.3 - thickness)
    count = len(outer)
    rims = [
        (first + i, first + (i + 1) % 40, count + first + (i + 1) % 40, count + first + i)
        for first in (0, 480) for i in range(40)
    ]  # fmt: skip
    walls = [*faces, *(tuple(count + corner for corner in reversed(face)) for face in faces), *rims]
    solid = (np.concatenate([outer, inner]), walls)
    mesh, single = read(tmp_path, solid), read(tmp_path, (outer, faces))
    assert mesh.thickness == pytest.approx(thickness, rel=0.02)
    assert area(mesh) == pytest.approx(area(single), rel=1e-9)
    two = read(tmp_path, solid, walls=2)
    assert two.thickness is None
    radius = np.linalg.norm(two.positions[:, [0, 2]], axis=1)
    assert np.ptp(radius) == pytest.approx(2e-3, abs=2e-5), "two layers, 2 mm apart"
    assert area(two) == pytest.approx(2.0 * area(single), rel=0.01)


def test_small_shells_ride_along_rigidly(tmp_path: Path) -> None:
    buttons = [octahedron((0.0, 1.06 + 0.06 * number, 0.305), 0.008) for number in range(3)]
    mesh = read(tmp_path, tube(), *buttons)
    assert mesh.trims is not None and len(mesh.trims.seat) == 3
    assert mesh.notes[0].startswith("3 small shells ride along as rigid trims")
    assert area(mesh) == pytest.approx(area(read(tmp_path, tube())))
    assert mesh.trims.carried(mesh.positions, mesh.positions) == pytest.approx(
        mesh.trims.positions, abs=1e-12
    )
    # The garment turns about a slanted axis and moves: so do the buttons.
    axis = np.array([0.6, 0.0, 0.8])
    cross = np.cross(np.eye(3), axis)
    turn = np.eye(3) + np.sin(0.7) * cross + (1.0 - np.cos(0.7)) * cross @ cross
    moved = mesh.trims.carried(mesh.positions, mesh.positions @ turn.T + (0.1, -0.2, 0.3))
    assert moved == pytest.approx(mesh.trims.positions @ turn.T + (0.1, -0.2, 0.3), abs=1e-10)


def test_loose_triangles_and_small_cloth_are_no_trims(tmp_path: Path) -> None:
    triangle = np.array([(0.0, 1.1, 0.31), (0.01, 1.1, 0.31), (0.0, 1.11, 0.31)])
    assert read(tmp_path, tube(), (triangle, [(0, 1, 2)])).trims is None
    assert read(tmp_path, octahedron((0.0, 1.0, 0.0), 0.02)).trims is None
