"""Candidates of some vertices, found anew, in place of those that were known."""

import numpy as np

from toile.geometry.arrays import Bool, Int


def with_pairs_of(marked: Bool, known: tuple[Int, Int], found: tuple[Int, Int]) -> tuple[Int, Int]:
    """Return known pairs without a marked vertex and found ones that have one, (n, 4) and (m, 4).

    Parameters
    ----------
    marked
        The vertices, shape (v,).
    known, found
        (vertex-face, edge-edge) candidates. Where surfaces were searched that share features, those were
        found from either side: every pair is kept once.
    """
    vertex_face, edge_edge = (rows[marked[rows].any(axis=1)] for rows in found)
    merged = []
    for old, new in zip(known, (_once(vertex_face), _once(_in_order(edge_edge))), strict=True):
        merged.append(np.concatenate([old[~marked[old].any(axis=1)], new]))
    return merged[0], merged[1]


def _once(rows: Int) -> Int:
    return np.unique(rows, axis=0) if len(rows) else rows


def _in_order(edges: Int) -> Int:
    """Edge pairs with the lower end of each edge, and the lower edge, first."""
    ends = np.sort(edges.reshape(-1, 2, 2), axis=2)
    swapped = (ends[:, 0, 0] > ends[:, 1, 0]) | (
        (ends[:, 0, 0] == ends[:, 1, 0]) & (ends[:, 0, 1] > ends[:, 1, 1])
    )
    ends[swapped] = ends[swapped][:, ::-1]
    return np.ascontiguousarray(ends.reshape(-1, 4))
