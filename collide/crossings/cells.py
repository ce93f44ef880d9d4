"""A surface in a grid of cells: which of its faces have boxes that overlap a given one."""

from typing import NamedTuple

import numpy as np
from numba import types

from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_2, I32_1, I32_2, OUT_F64_2, OUT_I32_1, OUT_I32_2, helper, kernel

CELLS_PER_FACE = 64
"""Cells at most, as a multiple of the number of faces: where a surface is spread thin, cells are larger."""
LONGEST = 1024
"""Cells at most along an axis."""


class Cells(NamedTuple):
    """Faces by the cells that their boxes overlap.

    box: boxes of the faces [m], shape (t, 6). first: cell of each box's lower corner, (t, 3). start: first
    entry of every cell, and the end, (c + 1,). face: the faces of the cells, one cell after the other. shape:
    number of cells along the axes, (3,). grid: lower corner of the grid and side of a cell [m], shape (1, 4).
    """

    box: Float
    first: Int
    start: Int
    face: Int
    shape: Int
    grid: Float


CELLS = (F64_2, I32_2, I32_1, I32_1, I32_1, F64_2)
"""Types of the members of Cells."""


@helper
def _cell(value, axis, shape, grid):  # type: ignore[no-untyped-def]
    """Cell along an axis in which a coordinate lies, the nearest one outside the grid."""
    cell = (value - grid[0, axis]) / grid[0, 3]
    return int(min(max(cell, 0.0), shape[axis] - 1.0))


@kernel(types.void(F64_2, I32_2, OUT_F64_2))
def _write_boxes(p, faces, box):  # type: ignore[no-untyped-def]
    for f in range(faces.shape[0]):
        for x in range(3):
            a, b, c = p[faces[f, 0], x], p[faces[f, 1], x], p[faces[f, 2], x]
            box[f, x], box[f, x + 3] = min(a, b, c), max(a, b, c)


@kernel(types.void(F64_2, I32_1, F64_2, OUT_I32_2, OUT_I32_1))
def _count(box, shape, grid, first, start):  # type: ignore[no-untyped-def]
    """Write the first cell of every box, and into start[c + 2] how many boxes overlap cell c."""
    for f in range(box.shape[0]):
        for x in range(3):
            first[f, x] = _cell(box[f, x], x, shape, grid)
        for i in range(first[f, 0], _cell(box[f, 3], 0, shape, grid) + 1):
            for j in range(first[f, 1], _cell(box[f, 4], 1, shape, grid) + 1):
                for k in range(first[f, 2], _cell(box[f, 5], 2, shape, grid) + 1):
                    start[(i * shape[1] + j) * shape[2] + k + 2] += 1


@kernel(types.void(F64_2, I32_1, F64_2, I32_2, OUT_I32_1, OUT_I32_1))
def _fill(box, shape, grid, first, start, face):  # type: ignore[no-untyped-def]
    """Write the faces of every cell; start[c + 1] is the first entry of cell c before, and its end after."""
    for f in range(box.shape[0]):
        for i in range(first[f, 0], _cell(box[f, 3], 0, shape, grid) + 1):
            for j in range(first[f, 1], _cell(box[f, 4], 1, shape, grid) + 1):
                for k in range(first[f, 2], _cell(box[f, 5], 2, shape, grid) + 1):
                    cell = (i * shape[1] + j) * shape[2] + k + 1
                    face[start[cell]] = f
                    start[cell] += 1


def cells_of(positions: Float, faces: Int) -> Cells:
    """Sort faces (t, 3) of positions (n, 3) [m] into cells as long as their boxes are on average."""
    box = np.empty((len(faces), 6))
    _write_boxes(positions, faces, box)
    low, high = box[:, :3].min(axis=0), box[:, 3:].max(axis=0)
    size = high - low
    side = max(float((box[:, 3:] - box[:, :3]).mean()), float(size.max()) / (LONGEST - 1), 1e-300)
    while np.prod(np.floor(size / side) + 1.0) > CELLS_PER_FACE * len(faces):
        side *= 1.2
    shape = (np.floor(size / side) + 1.0).astype(np.int32)
    grid = np.array([[*low, side]])
    first = np.empty((len(faces), 3), np.int32)
    start = np.zeros(int(np.prod(shape)) + 2, np.int32)
    _count(box, shape, grid, first, start)
    np.cumsum(start, out=start)
    face = np.empty(int(start[-1]), np.int32)
    _fill(box, shape, grid, first, start, face)
    return Cells(box, first, start[:-1], face, shape, grid)


@helper
def overlapping(query, box, first, start, face, shape, grid, found):  # type: ignore[no-untyped-def]
    """Write the faces whose boxes overlap a box `query`, each once; return how many there are."""
    count = 0
    a, b, c = (
        _cell(query[0], 0, shape, grid), _cell(query[1], 1, shape, grid), _cell(query[2], 2, shape, grid)
    )  # fmt: skip
    for i in range(a, _cell(query[3], 0, shape, grid) + 1):
        for j in range(b, _cell(query[4], 1, shape, grid) + 1):
            for k in range(c, _cell(query[5], 2, shape, grid) + 1):
                cell = (i * shape[1] + j) * shape[2] + k
                for entry in range(start[cell], start[cell + 1]):
                    f = face[entry]
                    # In the first of the cells that both overlap.
                    if (
                        i == max(a, first[f, 0])
                        and j == max(b, first[f, 1])
                        and k == max(c, first[f, 2])
                        and query[0] <= box[f, 3]
                        and box[f, 0] <= query[3]
                        and query[1] <= box[f, 4]
                        and box[f, 1] <= query[4]
                        and query[2] <= box[f, 5]
                        and box[f, 2] <= query[5]
                    ):
                        found[count] = f
                        count += 1
    return count
