"""Updating a list of candidates for some vertices only."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import types

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import (
    BOOL_1,
    F64_1,
    I32_2,
    OUT_BOOL_1,
    OUT_F64_1,
    OUT_I32_2,
    kernel,
    unsigned,
)

BITS = 15
"""Of a vertex number, four of which go into one of 64 bits, its sign left alone."""


class Measured(NamedTuple):
    """(vertex-face, edge-edge) candidates, (n, 4) and (m, 4), and distances [m], nan where not known."""

    pairs: tuple[Int, Int]
    distances: tuple[Float, Float]


def unmeasured(pairs: tuple[Int, Int]) -> Measured:
    """Return pairs whose distances are not known."""
    return Measured(pairs, (np.full(len(pairs[0]), np.nan), np.full(len(pairs[1]), np.nan)))


def with_pairs_of(marked: Bool, known: Measured, found: tuple[Int, Int]) -> Measured:
    """Return known pairs without a marked vertex and found ones that have one.

    Parameters
    ----------
    marked
        The vertices, shape (v,).
    known, found
        Candidates. Where surfaces were searched that share features, those were found from either side: every
        pair is kept once.
    """
    vertex_face, edge_edge = (rows[with_marked(marked, rows)] for rows in found)
    return _merged(marked, known, [_once(vertex_face), _once(_in_order(edge_edge))])


def replaced(marked: Bool, known: Measured, found: tuple[Int, Int]) -> Measured:
    """Return known pairs without a marked vertex and found ones that have one, of which none comes twice."""
    return _merged(marked, known, [rows[with_marked(marked, rows)] for rows in found])


def _merged(marked: Bool, known: Measured, found: Sequence[Int]) -> Measured:
    """Return known pairs without a marked vertex, and found ones, with what distances are known."""
    (vertex_face, of_faces), (edge_edge, of_edges) = (
        _with_new(marked, *old, new) for old, new in zip(zip(*known, strict=True), found, strict=True)
    )
    return Measured((vertex_face, edge_edge), (of_faces, of_edges))


def _with_new(marked: Bool, known: Int, distances: Float, new: Int) -> tuple[Int, Float]:
    """Return known pairs of one kind without a marked vertex, then new ones; and their distances."""
    most = len(known) + len(new)
    pairs, apart = np.empty((most, 4), np.int32), np.empty(most)
    count = _without_marked(marked, known, distances, pairs, apart)
    pairs[count : count + len(new)] = new
    apart[count : count + len(new)] = np.nan
    return pairs[: count + len(new)], apart[: count + len(new)]


@kernel(types.int64(BOOL_1, I32_2, F64_1, OUT_I32_2, OUT_F64_1))
def _without_marked(marked: Bool, known: Int, distances: Float, pairs: Int, apart: Float) -> int:
    """Write pairs without a marked vertex, and their distances; return how many there are."""
    count = 0
    for row in range(known.shape[0]):
        i, j, k, m = known[row, 0], known[row, 1], known[row, 2], known[row, 3]
        if marked[unsigned(i)] | marked[unsigned(j)] | marked[unsigned(k)] | marked[unsigned(m)]:
            continue
        pairs[count, 0], pairs[count, 1], pairs[count, 2], pairs[count, 3] = i, j, k, m
        apart[count] = distances[row]
        count += 1
    return count


def with_marked(marked: Bool, rows: Int) -> Bool:
    """Tell which rows of vertices, shape (n, k), have a marked one."""
    having = np.empty(len(rows), bool)
    _with_marked(marked, rows, having)
    return having


@kernel(types.void(BOOL_1, I32_2, OUT_BOOL_1))
def _with_marked(marked: Bool, rows: Int, having: Bool) -> None:
    for row in range(rows.shape[0]):
        having[row] = False
        for k in range(rows.shape[1]):
            having[row] |= marked[unsigned(rows[row, k])]


def _once(rows: Int) -> Int:
    """Rows in order, each once."""
    if not len(rows):
        return rows
    if rows.max() >= 1 << BITS:
        return np.unique(rows, axis=0)
    # As one number each they are sorted in a tenth of the time.
    shifts = BITS * np.arange(3, -1, -1)
    keys = np.unique((rows.astype(np.int64) << shifts).sum(axis=1))
    return ((keys[:, None] >> shifts) & ((1 << BITS) - 1)).astype(np.int32)


def _in_order(edges: Int) -> Int:
    """Edge pairs with the lower end of each edge, and the lower edge, first."""
    ends = np.sort(edges.reshape(-1, 2, 2), axis=2)
    swapped = (ends[:, 0, 0] > ends[:, 1, 0]) | (
        (ends[:, 0, 0] == ends[:, 1, 0]) & (ends[:, 0, 1] > ends[:, 1, 1])
    )
    ends[swapped] = ends[swapped][:, ::-1]
    return np.ascontiguousarray(ends.reshape(-1, 4))
