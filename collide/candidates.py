"""Candidate pairs: every vertex-face and edge-edge pair closer than the reaches of its two sides."""

import numpy as np
from numba import types

from toile.collide import bvh
from toile.collide.pair_distance import length, pair_weights, separation, weighted_sum
from toile.collide.surface import Surface
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import BOOL_1, BOOL_2, F64_1, F64_2, I32_1, I32_2, OUT_I32_2, helper, kernel


@helper
def _boxes_stay_apart(p, ends, kind, i, j, k, m, reach):  # type: ignore[no-untyped-def]
    """Whether an axis keeps the two primitives farther apart than reach while they move from p to ends."""
    q = i if kind == 0 else j
    r = j if kind == 0 else k
    for axis in range(3):
        low_a = min(p[i, axis], p[q, axis])
        high_a = max(p[i, axis], p[q, axis])
        low_b = min(p[r, axis], p[k, axis], p[m, axis])
        high_b = max(p[r, axis], p[k, axis], p[m, axis])
        if low_a - high_b > reach:
            low_a = min(ends[i, axis], ends[q, axis])
            high_b = max(ends[r, axis], ends[k, axis], ends[m, axis])
            if low_a - high_b > reach:
                return True
        elif low_b - high_a > reach:
            high_a = max(ends[i, axis], ends[q, axis])
            low_b = min(ends[r, axis], ends[k, axis], ends[m, axis])
            if low_b - high_a > reach:
                return True
    return False


@helper
def _is_candidate(p, ends, weld, ghost, kind, i, j, k, m, reaches):  # type: ignore[no-untyped-def]
    """Whether the pair shares no sewn vertex, is not all ghost, and comes closer than its reaches together.

    Two primitives that are apart by `reach` along n at both ends of straight motions are so all the way.
    """
    if ghost[i] and ghost[j] and ghost[k] and ghost[m]:
        return False
    a = weld[i]
    b = weld[j]
    c = weld[k]
    d = weld[m]
    if kind == 0:
        if a == b or a == c or a == d:
            return False
    elif a == c or a == d or b == c or b == d:
        return False
    if kind == 0:
        reach = reaches[i] + max(reaches[j], reaches[k], reaches[m])
    else:
        reach = max(reaches[i], reaches[j]) + max(reaches[k], reaches[m])
    if _boxes_stay_apart(p, ends, kind, i, j, k, m, reach):
        return False
    wi, wj, wk, wm = pair_weights(p, kind, i, j, k, m)
    x, y, z = weighted_sum(p, i, j, k, m, wi, wj, wk, wm)
    d = length(x, y, z)
    if d < reach:
        return True
    return separation(ends, kind, i, j, k, m, x / d, y / d, z / d) < reach


@kernel(
    types.UniTuple(types.int64, 2)(
        F64_2,
        F64_2,
        I32_1,
        BOOL_1,
        I32_2,
        I32_2,
        BOOL_2,
        BOOL_2,
        I32_2,
        BOOL_2,
        BOOL_2,
        F64_1,
        OUT_I32_2,
        OUT_I32_2,
    )
)
def _emit(  # type: ignore[no-untyped-def]
    p, ends, weld, ghost, pairs, faces_a, vertex_a, edge_a, faces_b, vertex_b, edge_b, reach, vertex_face,
    edge_edge,
):  # fmt: skip
    """Write the candidates of face pairs while they fit; return how many of each kind there are."""
    count_vf = 0
    count_ee = 0
    for row in range(pairs.shape[0]):
        ta = pairs[row, 0]
        tb = pairs[row, 1]
        # Three vertices of a against b, three of b against a, nine edge pairs: one call site, because a
        # second one would be inlined and compiled a second time.
        for test in range(15):
            kind = 0
            if test < 3:
                if not vertex_a[ta, test]:
                    continue
                i = faces_a[ta, test]
                j, k, m = faces_b[tb, 0], faces_b[tb, 1], faces_b[tb, 2]
            elif test < 6:
                if not vertex_b[tb, test - 3]:
                    continue
                i = faces_b[tb, test - 3]
                j, k, m = faces_a[ta, 0], faces_a[ta, 1], faces_a[ta, 2]
            else:
                kind = 1
                ea = (test - 6) // 3
                eb = (test - 6) % 3
                if not edge_a[ta, ea] or not edge_b[tb, eb]:
                    continue
                i, j = faces_a[ta, ea], faces_a[ta, (ea + 1) % 3]
                k, m = faces_b[tb, eb], faces_b[tb, (eb + 1) % 3]
            if not _is_candidate(p, ends, weld, ghost, kind, i, j, k, m, reach):
                continue
            if kind == 0:
                if count_vf < vertex_face.shape[0]:
                    vertex_face[count_vf, 0] = i
                    vertex_face[count_vf, 1] = j
                    vertex_face[count_vf, 2] = k
                    vertex_face[count_vf, 3] = m
                count_vf += 1
            else:
                if count_ee < edge_edge.shape[0]:
                    edge_edge[count_ee, 0] = i
                    edge_edge[count_ee, 1] = j
                    edge_edge[count_ee, 2] = k
                    edge_edge[count_ee, 3] = m
                count_ee += 1
    return count_vf, count_ee


def find_candidates(
    p: Float, weld: Int, ghost: Bool, a: Surface, boxes_a: Float, tree_a: bvh.Bvh,
    b: Surface | None, boxes_b: Float, tree_b: bvh.Bvh, reach: Float, ends: Float | None = None,
) -> tuple[Int, Int]:  # fmt: skip
    """Vertex-face (n, 4) and edge-edge (m, 4) candidates closer than the reaches [m] of their two sides.

    Parameters
    ----------
    p
        Positions that the faces index [m], shape (n, 3).
    weld
        Vertices with the same number are one sewn vertex: pairs that share one are left out, shape (n,).
    ghost
        Vertices that pass through each other: pairs whose four vertices are all marked are left out,
        shape (n,).
    a, b
        The two surfaces; b is None for pairs within a.
    boxes_a, tree_a, boxes_b, tree_b
        Face boxes, grown by the reach of their vertices, and hierarchies that were refitted to them.
    reach
        Half the contact radius plus the motion that the list must cover, per vertex [m], shape (n,).
    ends
        Where the vertices drift to, all at the same pace [m], shape (n, 3): reaches are then measured from
        places on the way. By default they stay where they are.
    """
    if ends is None:
        ends = p
    if b is None:
        pairs = bvh.self_overlapping_pairs(tree_a, boxes_a)
        b = a
    else:
        pairs = bvh.overlapping_pairs(tree_a, boxes_a, tree_b, boxes_b)
    capacity = 4 * len(pairs) + 64
    while True:
        vertex_face = np.empty((capacity, 4), np.int32)
        edge_edge = np.empty((capacity, 4), np.int32)
        found = _emit(
            p, ends, weld, ghost, pairs, a.faces, a.owns_vertex, a.owns_edge, b.faces, b.owns_vertex,
            b.owns_edge, reach, vertex_face, edge_edge,
        )  # fmt: skip
        if max(found) <= capacity:
            return vertex_face[: found[0]].copy(), edge_edge[: found[1]].copy()
        capacity = max(found)
