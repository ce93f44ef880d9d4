"""Cells that a surface comes near: no face that could cross it is left out, far ones are."""

import numpy as np
import pytest

from toile.geometry.arrays import Float, Int
from toile.geometry.cells import SIDE, Cells


def triangles(generator: np.random.Generator, count: int, size: float, spread: float) -> tuple[Float, Int]:
    centre = generator.uniform(-spread, spread, (count, 1, 3))
    corners = centre + generator.normal(scale=size, size=(count, 3, 3))
    return np.ascontiguousarray(corners.reshape(-1, 3)), np.arange(3 * count, dtype=np.int32).reshape(-1, 3)


def boxes_meet(one: tuple[Float, Int], other: tuple[Float, Int], margin: float) -> Float:
    """Whether the box of every face of `other` comes within a margin of any face's box of `one`."""
    a, b = one[0][one[1]], other[0][other[1]]
    apart = (a.min(axis=1)[:, None] - margin > b.max(axis=1)) | (
        a.max(axis=1)[:, None] + margin < b.min(axis=1)
    )
    return np.asarray((~apart.any(axis=2)).any(axis=0))


@pytest.mark.parametrize("size", [0.01, 0.05, 0.5])
@pytest.mark.parametrize("offset", [0.0, 1e4])
def test_no_face_that_meets_the_surface_is_left_out(size: float, offset: float) -> None:
    """Small faces and large ones, near the origin and far from it; and none of those around the box."""
    generator = np.random.default_rng(3)
    cloth, body = triangles(generator, 60, size, 0.3), triangles(generator, 400, size, 1.0)
    cloth, body = (cloth[0] + offset, cloth[1]), (body[0] + offset, body[1])
    near = Cells.around(*cloth).faces_within(*body)
    assert set(np.flatnonzero(boxes_meet(cloth, body, 0.0))) <= set(near)
    if size == 0.01:
        assert not set(near) - set(np.flatnonzero(boxes_meet(cloth, body, SIDE)))
    here = Cells.around(*cloth)
    grown = here.grown(2)
    assert set(np.flatnonzero(boxes_meet(cloth, body, 2.0 * SIDE))) <= set(grown.faces_within(*body))
    assert here.include(here) and grown.include(here) and not here.include(grown)
    moved = Cells.around(cloth[0] + 1.9 * SIDE, cloth[1])
    assert grown.include(moved) and not here.include(moved)


def test_a_large_scene_has_larger_cells() -> None:
    generator = np.random.default_rng(4)
    cloth = triangles(generator, 50, 0.1, 500.0)
    cells = Cells.around(*cloth)
    assert cells.side > SIDE and cells.marked.size < 5_000_000
    assert len(cells.faces_within(*cloth)) == 50
