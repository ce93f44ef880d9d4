"""Cloth carried along by an avatar: where it blocks the avatar's motion it is given the same motion."""

import numpy as np
from numba import types

from toile.collide.pair_distance import length, pair_weights, weighted_sum
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import BOOL_1, F64_2, I32_2, OUT_F64_2, kernel, unsigned


@kernel(types.void(F64_2, F64_2, BOOL_1, I32_2, types.int64, types.int64, types.float64, OUT_F64_2))
def _carry(p, move, blocked, pairs, kind, cloth_nodes, reach, carried):  # type: ignore[no-untyped-def]
    """Give every cloth node the longest motion among avatar vertices that it blocks."""
    for row in range(pairs.shape[0]):
        i = unsigned(pairs[row, 0])
        j = unsigned(pairs[row, 1])
        k = unsigned(pairs[row, 2])
        m = unsigned(pairs[row, 3])
        if not (blocked[i] or blocked[j] or blocked[k] or blocked[m]):
            continue
        wi, wj, wk, wm = pair_weights(p, kind, i, j, k, m)
        x, y, z = weighted_sum(p, i, j, k, m, wi, wj, wk, wm)
        if length(x, y, z) > reach:
            continue
        best = -1
        longest = 0.0
        for q in range(4):
            v = pairs[row, q]
            size = length(move[v, 0], move[v, 1], move[v, 2])
            if v >= cloth_nodes and size > longest:
                best = v
                longest = size
        if best < 0:
            continue
        for q in range(4):
            v = pairs[row, q]
            if v < cloth_nodes and length(carried[v, 0], carried[v, 1], carried[v, 2]) < longest:
                for axis in range(3):
                    carried[v, axis] = move[best, axis]


def carried_along(
    p: Float, move: Float, blocked: Bool, vertex_face: Int, edge_edge: Int, cloth_nodes: int, reach: float
) -> Float:
    """Motion [m] of cloth nodes that lie closer than `reach` [m] to blocked avatar vertices, shape (n, 3).

    Parameters
    ----------
    p, move
        Positions of cloth nodes, then avatar vertices, and what the avatar wants to move [m], shape (v, 3).
    blocked
        Avatar vertices that cloth keeps from moving, shape (v,).
    vertex_face, edge_edge
        Candidate pairs between cloth and avatar.
    """
    carried = np.zeros((cloth_nodes, 3))
    _carry(p, move, blocked, vertex_face, 0, cloth_nodes, reach, carried)
    _carry(p, move, blocked, edge_edge, 1, cloth_nodes, reach, carried)
    return carried
