"""Grid cells near a surface: what lies in none of them cannot cross it."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.ndimage import binary_dilation

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.face_boxes import face_boxes

SIDE = 0.04
"""Side of a cell [m]."""
MOST, LONGEST = 4_000_000, 500
"""Cells at most, all and along an axis: larger scenes have larger ones."""
SMALL = 4
"""Faces whose boxes overlap so many cells along an axis at most are looked at together, others one by one."""


class Cells(NamedTuple):
    """Marked cells of a grid.

    marked: shape (a, b, c). first: number of the first cell along each axis, shape (3,). side: of a cell [m].
    """

    marked: Bool
    first: Int
    side: float

    @staticmethod
    def around(positions: Float, faces: Int) -> "Cells":
        """Mark the cells that the boxes of faces (t, 3) of positions (n, 3) [m] overlap."""
        low, high = np.split(face_boxes(positions, faces), 2, axis=1)
        size = high.max(axis=0) - low.min(axis=0)
        side = max(SIDE, float(np.prod(size) / MOST) ** (1.0 / 3.0), float(size.max()) / LONGEST)
        start, end = np.floor(low / side).astype(np.int64), np.floor(high / side).astype(np.int64)
        first = start.min(axis=0)
        start, end = start - first, end - first
        marked = np.zeros(end.max(axis=0) + 1, bool)
        small = (end - start < SMALL).all(axis=1)
        for _, cells in _overlapped(start[small], end[small]):
            marked[tuple(cells.T)] = True
        for block in _blocks(start[~small], end[~small]):
            marked[block] = True
        return Cells(marked, first, side)

    def grown(self, rings: int) -> "Cells":
        """Return them with so many rings of cells around marked ones marked, too."""
        wider = binary_dilation(np.pad(self.marked, rings), np.ones((3, 3, 3), bool), iterations=rings)
        return Cells(wider, self.first - rings, self.side)

    def include(self, other: "Cells") -> bool:
        """Whether all marked cells of another grid of this kind are marked here."""
        if self.side != other.side:
            return False
        cells = np.argwhere(other.marked) + (other.first - self.first)
        inside = ((cells >= 0) & (cells < self.marked.shape)).all(axis=1)
        return bool(inside.all() and self.marked[tuple(cells.T)].all())

    def faces_within(self, vertices: Float, faces: Int) -> Int:
        """Return the faces (t, 3) of vertices (v, 3) [m] whose boxes overlap a marked cell, shape (k,)."""
        low, high = np.split(face_boxes(vertices, faces), 2, axis=1)
        shape = np.array(self.marked.shape)
        lowest, highest = self.side * self.first, self.side * (self.first + shape)
        near = np.flatnonzero(((high >= lowest) & (low <= highest)).all(axis=1))
        start = np.floor(low[near] / self.side).astype(np.int64) - self.first
        end = np.floor(high[near] / self.side).astype(np.int64) - self.first
        start, end = np.clip(start, 0, shape - 1), np.clip(end, 0, shape - 1)
        within = np.zeros(len(near), bool)
        small = (end - start < SMALL).all(axis=1)
        of_small, of_large = np.flatnonzero(small), np.flatnonzero(~small)
        for rows, cells in _overlapped(start[small], end[small]):
            within[of_small[rows]] |= self.marked[tuple(cells.T)]
        for row, block in zip(of_large, _blocks(start[~small], end[~small]), strict=True):
            within[row] = self.marked[block].any()
        return near[within].astype(np.int32)


def _overlapped(start: Int, end: Int) -> Iterator[tuple[Int, Int]]:
    """Yield cells from `start` to `end`, shapes (t, 3), a few at a time: of which boxes, and the cells."""
    count = end - start + 1
    for offset in np.ndindex(*(int(most) for most in count.max(axis=0, initial=0))):
        rows = np.flatnonzero((count > offset).all(axis=1))
        if len(rows):
            yield rows.astype(np.int32), start[rows] + offset


def _blocks(start: Int, end: Int) -> Iterator[tuple[slice, slice, slice]]:
    """Yield the cells from `start` to `end`, shapes (t, 3), of one box after the other."""
    for (a, b, c), (d, e, f) in zip(start.tolist(), end.tolist(), strict=True):
        yield slice(a, d + 1), slice(b, e + 1), slice(c, f + 1)
