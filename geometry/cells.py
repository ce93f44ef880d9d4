"""Grid cells near a surface: what lies in none of them cannot cross it."""

from typing import NamedTuple

import numpy as np
from numba import types
from scipy.ndimage import binary_dilation

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import BOOL_3, F64_2, I64_1, OUT_BOOL_1, OUT_BOOL_3, helper, kernel

SIDE = 0.04
"""Side of a cell [m]."""
MOST, LONGEST = 4_000_000, 500
"""Cells at most, all and along an axis: larger scenes have larger ones."""


@helper
def _cell(place, side):  # type: ignore[no-untyped-def]
    """Return the number of the cell along an axis in which a place lies."""
    return np.int64(np.floor(place / side))


class Cells(NamedTuple):
    """Marked cells of a grid.

    marked: shape (a, b, c). first: number of the first cell along each axis, shape (3,). side: of a cell [m].
    """

    marked: Bool
    first: Int
    side: float

    @staticmethod
    def of(boxes: Float) -> "Cells":
        """Mark the cells that boxes overlap: lower corner, upper corner [m], shape (t, 6)."""
        low, high = np.split(boxes, 2, axis=1)
        size = high.max(axis=0) - low.min(axis=0)
        side = max(SIDE, float(np.prod(size) / MOST) ** (1.0 / 3.0), float(size.max()) / LONGEST)
        first = np.floor(low.min(axis=0) / side).astype(np.int64)
        marked = np.zeros(np.floor(high.max(axis=0) / side).astype(np.int64) - first + 1, bool)
        _mark(boxes, first, side, marked)
        return Cells(marked, first, side)

    def grown(self, rings: int) -> "Cells":
        """Return them with so many rings of cells around marked ones marked, too."""
        wider = binary_dilation(np.pad(self.marked, rings), np.ones((3, 3, 3), bool), iterations=rings)
        return Cells(wider, self.first - rings, self.side)

    def boxes_within(self, boxes: Float) -> Int:
        """Return which boxes, as `of` takes them, overlap a marked cell, shape (k,)."""
        within = np.zeros(len(boxes), bool)
        _within(boxes, self.marked, self.first, self.side, within)
        return np.flatnonzero(within).astype(np.int32)


@kernel(types.void(F64_2, I64_1, types.float64, OUT_BOOL_3))
def _mark(boxes, first, side, marked):  # type: ignore[no-untyped-def]
    """Mark the cells that boxes overlap."""
    for t in range(boxes.shape[0]):
        for i in range(_cell(boxes[t, 0], side) - first[0], _cell(boxes[t, 3], side) - first[0] + 1):
            for j in range(_cell(boxes[t, 1], side) - first[1], _cell(boxes[t, 4], side) - first[1] + 1):
                for k in range(_cell(boxes[t, 2], side) - first[2], _cell(boxes[t, 5], side) - first[2] + 1):
                    marked[i, j, k] = True


@kernel(types.void(F64_2, BOOL_3, I64_1, types.float64, OUT_BOOL_1))
def _within(boxes, marked, first, side, within):  # type: ignore[no-untyped-def]
    """Write whether boxes overlap marked cells."""
    low, high = np.empty(3, np.int64), np.empty(3, np.int64)
    for t in range(boxes.shape[0]):
        for axis in range(3):
            low[axis] = max(_cell(boxes[t, axis], side) - first[axis], 0)
            high[axis] = min(_cell(boxes[t, axis + 3], side) - first[axis], marked.shape[axis] - 1)
        found = False
        for i in range(low[0], high[0] + 1):
            for j in range(low[1], high[1] + 1):
                for k in range(low[2], high[2] + 1):
                    found |= marked[i, j, k]
                if found:
                    break
            if found:
                break
        within[t] = found
