"""Pairs of faces that meet: those whose boxes overlap are tested exactly."""

from collections.abc import Callable

import numpy as np
from numba import types

from toile.collide.crossings.cells import CELLS, Cells, overlapping
from toile.collide.crossings.meeting import meet_beyond_corner, triangles_meet
from toile.collide.crossings.orientation import ROOM
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_2, I32_1, I32_2, OUT_I32_2, helper, kernel
from toile.geometry.threads.crew import in_parts, together

PAIRS = 4096
"""Pairs for which there is room at first."""
FACES_PER_PART = 1024
"""Faces that one thread compares with others at a time."""


@helper
def _put(t, row, p, faces, face, first):  # type: ignore[no-untyped-def]
    """Write a face into three rows of t, its corner `first` in front."""
    for corner in range(3):
        v = faces[face, (first + corner) % 3]
        for x in range(3):
            t[row + corner, x] = p[v, x]


@helper
def _meet_within(p, faces, weld, i, j, t, parts):  # type: ignore[no-untyped-def]
    """Whether two faces of a surface meet other than at an edge of both or across an open seam."""
    common = 0
    first = second = 0
    for a in range(3):
        for b in range(3):
            if faces[i, a] == faces[j, b]:
                common += 1
                first, second = a, b
            elif weld[faces[i, a]] == weld[faces[j, b]]:
                return False
    if common > 1:
        return False
    _put(t, 0, p, faces, i, first)
    _put(t, 3, p, faces, j, second)
    return meet_beyond_corner(t, parts) if common == 1 else triangles_meet(t, parts)


@kernel(types.int64(F64_2, I32_2, I32_1, *CELLS, types.int64, types.int64, OUT_I32_2))
def _within(  # type: ignore[no-untyped-def]
    p, faces, weld, box, first, start, face, shape, grid, begin, end, pairs
):
    """Write pairs of faces of a surface that meet, while they fit; return how many there are.

    The first face of a pair is one from `begin` to `end`.
    """
    t, parts, rows = np.empty((6, 3)), np.empty(ROOM), np.empty(box.shape[0], np.int32)
    found = 0
    for i in range(begin, end):
        count = overlapping(box[i], box, first, start, face, shape, grid, rows)
        for k in range(count):
            j = rows[k]
            if i < j and _meet_within(p, faces, weld, i, j, t, parts):
                if found < pairs.shape[0]:
                    pairs[found, 0], pairs[found, 1] = i, j
                found += 1
    return found


@kernel(types.int64(F64_2, I32_2, *CELLS, F64_2, I32_2, types.int64, types.int64, OUT_I32_2))
def _between(  # type: ignore[no-untyped-def]
    p, faces, box, first, start, face, shape, grid, q, others, begin, end, pairs
):
    """Write pairs (face, other face) that meet, while they fit; return how many there are.

    The other faces are those from `begin` to `end`.
    """
    t, parts, rows = np.empty((6, 3)), np.empty(ROOM), np.empty(box.shape[0], np.int32)
    query, all_low, all_high = np.empty(6), np.empty(3), np.empty(3)
    for x in range(3):
        all_low[x], all_high[x] = box[:, x].min(), box[:, x + 3].max()
    found = 0
    for other in range(begin, end):
        a, b, c = others[other, 0], others[other, 1], others[other, 2]
        is_near = True
        for x in range(3):
            query[x], query[x + 3] = min(q[a, x], q[b, x], q[c, x]), max(q[a, x], q[b, x], q[c, x])
            is_near = is_near and query[x] <= all_high[x] and query[x + 3] >= all_low[x]
        if not is_near:
            continue
        count = overlapping(query, box, first, start, face, shape, grid, rows)
        if count > 0:
            _put(t, 3, q, others, other, 0)
        for k in range(count):
            _put(t, 0, p, faces, rows[k], 0)
            if triangles_meet(t, parts):
                if found < pairs.shape[0]:
                    pairs[found, 0], pairs[found, 1] = rows[k], other
                found += 1
    return found


def _all_of(write: Callable[[int, int, Int], int], faces: int) -> Int:
    """Return all pairs that a kernel writes of so many faces while they fit, in order, shape (k, 2)."""

    def find(first: int, last: int) -> Int:
        pairs = np.empty((PAIRS, 2), np.int32)
        found = write(first, last, pairs)
        if found > PAIRS:
            pairs = np.empty((found, 2), np.int32)
            write(first, last, pairs)
        return pairs[:found]

    pairs = together(in_parts(find, faces, FACES_PER_PART), 2)
    return np.ascontiguousarray(pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))])


def pairs_within(positions: Float, faces: Int, weld: Int, cells: Cells) -> Int:
    """Pairs of faces of a surface that meet, each once, the smaller first, shape (k, 2).

    Parameters
    ----------
    positions, faces
        The surface [m], shapes (n, 3) and (t, 3).
    weld
        Vertices with the same number are being sewn together, shape (n,): pairs that have such a number but
        not the vertex itself in common lie on the two sides of an open seam and do not count.
    cells
        Its faces in cells.

    Faces with one corner in common count if they meet beyond it, faces with an edge in common never.
    """
    return _all_of(
        lambda first, last, pairs: _within(positions, faces, weld, *cells, first, last, pairs), len(faces)
    )


def pairs_between(positions: Float, faces: Int, cells: Cells, others: Float, other_faces: Int) -> Int:
    """Pairs of a face of one surface and a face of another that meet, each once, shape (k, 2).

    Parameters
    ----------
    positions, faces, cells
        One surface [m], shapes (n, 3) and (t, 3), and its faces in cells.
    others, other_faces
        The other surface [m], shapes (m, 3) and (s, 3).
    """
    return _all_of(
        lambda first, last, pairs: _between(
            positions, faces, *cells, others, other_faces, first, last, pairs
        ),
        len(other_faces),
    )
