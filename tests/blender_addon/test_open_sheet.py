"""Which open surfaces are floors, and the solid below them."""

import numpy as np
import pytest

from toile.blender_addon.snapshot.open_sheet import DEPTH, OpenSheets
from toile.geometry.arrays import Float, Int


def grid(count: int = 4) -> tuple[Float, Int]:
    """A sheet of 2 m, level, that looks up along Y."""
    line = np.linspace(-1.0, 1.0, count + 1)
    x, z = np.meshgrid(line, line, indexing="ij")
    number = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    a, b, c, d = (
        part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    )
    faces = np.concatenate([np.column_stack([a, d, c]), np.column_stack([a, c, b])]).astype(np.int32)
    return np.column_stack([x.ravel(), np.zeros(x.size), z.ravel()]), faces


def ball() -> tuple[Float, Int]:
    """A closed octahedron."""
    points = np.concatenate([np.eye(3), -np.eye(3)])
    faces = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]
    return points, np.array(faces, np.int32)


def volume(points: Float, faces: Int) -> float:
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def assert_closed(faces: Int) -> None:
    """Every edge is run along once in each direction."""
    ways = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    assert len(np.unique(ways, axis=0)) == len(ways)
    assert {tuple(way) for way in ways.tolist()} == {(b, a) for a, b in ways.tolist()}


@pytest.mark.parametrize("flipped", [False, True])
def test_a_floor_gets_a_closed_solid_below_its_side(flipped: bool) -> None:
    """Looking up, or turned to look up."""
    points, faces = grid()
    if flipped:
        faces = faces[:, ::-1]
    sheets = OpenSheets(points, faces, is_closed=False)
    assert sheets and not sheets.is_folded(points)
    sheets.turn_to(points, np.array((0.3, 1.0, 0.0)))
    solid = sheets.with_below(points)
    assert_closed(sheets.faces)
    assert volume(solid, sheets.faces) == pytest.approx(4.0 * DEPTH)
    assert solid[:, 1].max() == 0.0 and solid[:, 1].min() == pytest.approx(-DEPTH)


def test_the_solid_follows_a_floor_that_tilts() -> None:
    points, faces = grid()
    sheets = OpenSheets(points, faces, is_closed=False)
    turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    assert np.allclose(sheets.with_below(points @ turn.T), sheets.with_below(points) @ turn.T)


def test_small_sheets_get_less() -> None:
    points, faces = grid()
    sheets = OpenSheets(0.1 * points, faces, is_closed=False)
    assert sheets.with_below(0.1 * points)[:, 1].min() == pytest.approx(-0.02)


def test_bodies_with_holes_and_what_hangs_on_bodies_are_left_alone() -> None:
    points, faces = ball()
    assert not OpenSheets(points, faces[1:], is_closed=False)
    sheet, its = grid()
    both = OpenSheets(np.concatenate([points, sheet]), np.concatenate([faces, its + 6]), is_closed=False)
    assert not both and np.array_equal(both.faces, np.concatenate([faces, its + 6]))


def test_faces_that_look_to_both_sides_are_found() -> None:
    points, faces = grid()
    faces[: len(faces) // 2] = faces[: len(faces) // 2, ::-1]
    sheets = OpenSheets(points, faces, is_closed=False)
    assert sheets and sheets.is_folded(points)
