"""Candidate pairs: every vertex-face and edge-edge pair closer than the reaches of its two sides."""

from itertools import product
from typing import NamedTuple

import numpy as np
from numba import types

from toile.collide import bvh
from toile.collide.fans import corners_from, fans_stay_apart, lowest
from toile.collide.pair_distance import length, pair_weights, separation, weighted_sum
from toile.collide.surface import Surface
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import BOOL_1, F64_1, F64_2, I32_1, I32_2, OUT_I32_2, helper, kernel, unsigned
from toile.geometry.threads.crew import in_parts, together
from toile.geometry.threads.crowd import Crowd


def _tests_of_owners() -> Int:
    """Return the tests of a face pair as bits, by what its faces own, shape (4096,).

    Tests 0 to 2: the vertices of the first against the second; 3 to 5: those of the second against the first;
    6 + 3 i + j: edge i of the first against edge j of the second.
    """
    tests = np.zeros(64 * 64, np.int32)
    for first in range(64):
        for second in range(64):
            edges = sum((second >> 3) << (6 + 3 * i) for i in range(3) if first >> (3 + i) & 1)
            tests[64 * first + second] = (first & 7) | (second & 7) << 3 | edges
    return tests


def _tests_barred() -> Int:
    """Return the tests of a face pair whose two sides share a vertex, by `_shared_corners`, shape (512,)."""
    barred = np.zeros(512, np.int32)
    for shared in range(512):
        for i, j in product(range(3), range(3)):
            if shared >> (3 * i + j) & 1:
                # Corner i is an end of edges i and i - 1.
                for ea, eb in product((i, (i + 2) % 3), (j, (j + 2) % 3)):
                    barred[shared] |= 1 << (6 + 3 * ea + eb)
                barred[shared] |= 1 << i | 1 << (3 + j)
    return barred


def _only_shared_corner() -> Int:
    """Return 3 i + j where corner i of the first and j of the second are all they share, or -1: (512,)."""
    only = np.full(512, -1, np.int32)
    only[1 << np.arange(9)] = np.arange(9)
    return only


TESTS_OF = _tests_of_owners()
BARRED = _tests_barred()
ONLY_SHARED = _only_shared_corner()


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
def _most(reaches, a, b, c):  # type: ignore[no-untyped-def]
    """Largest reach of three vertices."""
    return max(reaches[a], reaches[b], reaches[c])


@helper
def _faces_stay_apart(p, ends, a, b, c, d, e, f, reaches):  # type: ignore[no-untyped-def]
    """Whether the line between their middles keeps faces abc and def farther apart than their reaches.

    Half of the pairs whose boxes overlap do so: one test instead of up to fifteen.
    """
    x = p[a, 0] + p[b, 0] + p[c, 0] - p[d, 0] - p[e, 0] - p[f, 0]
    y = p[a, 1] + p[b, 1] + p[c, 1] - p[d, 1] - p[e, 1] - p[f, 1]
    z = p[a, 2] + p[b, 2] + p[c, 2] - p[d, 2] - p[e, 2] - p[f, 2]
    far = (_most(reaches, a, b, c) + _most(reaches, d, e, f)) * length(x, y, z)
    return lowest(p, a, b, c, x, y, z) + lowest(p, d, e, f, -x, -y, -z) > far and (
        lowest(ends, a, b, c, x, y, z) + lowest(ends, d, e, f, -x, -y, -z) > far
    )


@helper
def _is_candidate(p, ends, kind, i, j, k, m, reaches):  # type: ignore[no-untyped-def]
    """Whether a pair comes closer than its reaches together.

    Two primitives that are apart by `reach` along n at both ends of straight motions are so all the way.
    """
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


@helper
def _shared_corners(weld, a, b, c, d, e, f):  # type: ignore[no-untyped-def]
    """Which corners of faces abc and def are one sewn vertex: bit 3 i + j for corner i of the first, j."""
    a, b, c, d, e, f = weld[a], weld[b], weld[c], weld[d], weld[e], weld[f]
    return (
        (a == d) | (a == e) << 1 | (a == f) << 2
        | (b == d) << 3 | (b == e) << 4 | (b == f) << 5
        | (c == d) << 6 | (c == e) << 7 | (c == f) << 8
    )  # fmt: skip


@kernel(
    types.UniTuple(types.int64, 2)(
        F64_2, F64_2, I32_1, BOOL_1, I32_2, I32_2, I32_1, I32_2, I32_1, F64_1, I32_1, I32_1, I32_1,
        OUT_I32_2, OUT_I32_2,
    )
)  # fmt: skip
def _emit(  # type: ignore[no-untyped-def]
    p, ends, weld, ghost, pairs, faces_a, owned_a, faces_b, owned_b, reach, tests_of, barred, only_shared,
    vertex_face, edge_edge,
):  # fmt: skip
    """Write the candidates of face pairs, 6 and 9 of each at most; return how many of each kind there are.

    tests_of: the tests of what two faces own, at 64 times what the first owns plus what the second does.
    barred: the tests that shared corners rule out. Most pairs are neighbours in the mesh and have few tests:
    what is decided per test is the price of a search.
    """
    count_vf = 0
    count_ee = 0
    any_ghost = False
    for v in range(ghost.shape[0]):
        any_ghost = any_ghost or ghost[v]
    for row in range(pairs.shape[0]):
        ta = unsigned(pairs[row, 0])
        tb = unsigned(pairs[row, 1])
        tests = tests_of[unsigned(64 * owned_a[ta] + owned_b[tb])]
        if tests == 0:
            continue
        a0, a1, a2 = unsigned(faces_a[ta, 0]), unsigned(faces_a[ta, 1]), unsigned(faces_a[ta, 2])
        b0, b1, b2 = unsigned(faces_b[tb, 0]), unsigned(faces_b[tb, 1]), unsigned(faces_b[tb, 2])
        shared = _shared_corners(weld, a0, a1, a2, b0, b1, b2)
        if shared:
            tests &= ~barred[unsigned(shared)]
            only = only_shared[unsigned(shared)]
            if tests and only >= 0:
                i, j = unsigned(only // 3), unsigned(only % 3)
                a = corners_from(faces_a, ta, i)
                b = corners_from(faces_b, tb, j)
                if fans_stay_apart(p, ends, *a, *b, _most(reach, *a) + _most(reach, *b)):
                    continue
        elif _faces_stay_apart(p, ends, a0, a1, a2, b0, b1, b2, reach):
            continue
        test = -1
        while tests:
            # One call site below, because a second one would be inlined and compiled a second time.
            test += 1
            asked = tests & 1
            tests >>= 1
            if not asked:
                continue
            kind = 0
            if test < 3:
                i = unsigned(faces_a[ta, unsigned(test)])
                j, k, m = b0, b1, b2
            elif test < 6:
                i = unsigned(faces_b[tb, unsigned(test - 3)])
                j, k, m = a0, a1, a2
            else:
                kind = 1
                edge = unsigned(test - 6)
                ea = edge // unsigned(3)
                eb = edge % unsigned(3)
                i, j = unsigned(faces_a[ta, ea]), unsigned(faces_a[ta, (ea + unsigned(1)) % unsigned(3)])
                k, m = unsigned(faces_b[tb, eb]), unsigned(faces_b[tb, (eb + unsigned(1)) % unsigned(3)])
            if any_ghost and ghost[i] and ghost[j] and ghost[k] and ghost[m]:
                continue
            if not _is_candidate(p, ends, kind, i, j, k, m, reach):
                continue
            if kind == 0:
                vertex_face[count_vf, 0] = i
                vertex_face[count_vf, 1] = j
                vertex_face[count_vf, 2] = k
                vertex_face[count_vf, 3] = m
                count_vf += 1
            else:
                edge_edge[count_ee, 0] = i
                edge_edge[count_ee, 1] = j
                edge_edge[count_ee, 2] = k
                edge_edge[count_ee, 3] = m
                count_ee += 1
    return count_vf, count_ee


MOST_CANDIDATES = 16_000_000
"""Candidates of a kind at most: 256 MB."""
PAIRS_PER_PART = 2048
"""Pairs of faces that one thread tests at a time."""


class Vertices(NamedTuple):
    """All vertices that surfaces index.

    Attributes
    ----------
    positions
        Where they are [m], shape (n, 3).
    weld
        Vertices with the same number are one sewn vertex: pairs that share one are left out, shape (n,).
    ghost
        Vertices that pass through each other: pairs whose four vertices are all marked are left out,
        shape (n,).
    reach
        Half the contact radius plus the motion that the list must cover, per vertex [m], shape (n,).
    ends
        Where the vertices drift to, all at the same pace [m], shape (n, 3): reaches are then measured from
        places on the way. Where they stay, the positions themselves.
    """

    positions: Float
    weld: Int
    ghost: Bool
    reach: Float
    ends: Float


class Hierarchy(NamedTuple):
    """A surface, boxes of its faces grown by the reach of their vertices, and a hierarchy fitted to them.

    A surface that is searched once, against one with a hierarchy, needs none.
    """

    surface: Surface
    boxes: Float
    tree: bvh.Bvh | None


def find_candidates(vertices: Vertices, a: Hierarchy, b: Hierarchy | None) -> tuple[Int, Int]:
    """Vertex-face (n, 4) and edge-edge (m, 4) candidates closer than the reaches [m] of their two sides.

    `b` is None for pairs within `a`.
    """
    if b is None:
        assert a.tree is not None
        pairs = bvh.self_overlapping_pairs(a.tree, a.boxes)
        b = a
    elif a.tree is None:
        assert b.tree is not None
        pairs = np.ascontiguousarray(bvh.boxes_meeting(b.tree, b.boxes, a.boxes)[:, ::-1])
    elif b.tree is None:
        pairs = bvh.boxes_meeting(a.tree, a.boxes, b.boxes)
    else:
        pairs = bvh.overlapping_pairs(a.tree, a.boxes, b.tree, b.boxes)
    one, other = a.surface, b.surface
    crowd = Crowd(MOST_CANDIDATES)

    def emit(first: int, last: int) -> tuple[Int, Int]:
        """Return the candidates of some of the pairs of faces."""
        vertex_face = np.empty((6 * (last - first), 4), np.int32)
        edge_edge = np.empty((9 * (last - first), 4), np.int32)
        found = _emit(
            vertices.positions, vertices.ends, vertices.weld, vertices.ghost, pairs[first:last], one.faces,
            one.owned, other.faces, other.owned, vertices.reach, TESTS_OF, BARRED, ONLY_SHARED, vertex_face,
            edge_edge,
        )  # fmt: skip
        crowd.add(max(found))
        return vertex_face[: found[0]].copy(), edge_edge[: found[1]].copy()

    parts = in_parts(emit, len(pairs), PAIRS_PER_PART)
    vertex_face, edge_edge = (together([part[kind] for part in parts], 4) for kind in (0, 1))
    crowd.check(max(len(vertex_face), len(edge_edge)))
    return vertex_face, edge_edge
