"""Safe moves: displacements are shortened, vertex by vertex, until no pair can meet on the way.

For a pair at distance d > 0 with normal n (from one primitive's closest point to the other's), the convex
primitives keep apart along n for the whole straight motion if they are apart along n at its end: each
side's extreme is a minimum (maximum) of linear functions of time. So a pair is safe if its separation
along n at the end is at least a kept share of d; any other plane between the two serves as well. Motion
together is not limited at all, and motion along a surface hardly. Where a pair is not safe, only the
vertices that approach are shortened; factors only ever decrease, and each cut is checked again until all
pairs are safe.

Related: displacement bounds of offset geometric contact (Chen et al. 2025), which limit every direction.
"""

import numpy as np
from numba import types

from toile.collide.pair_distance import length, pair_weights, separation, spanned_normal, weighted_sum
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import (
    F64_1,
    F64_2,
    I32_1,
    I32_2,
    OUT_F64_1,
    OUT_F64_2,
    OUT_I32_1,
    helper,
    kernel,
    unsigned,
)
from toile.geometry.threads.crew import in_parts

KEPT_SHARE = 0.2
"""Share of its distance that a pair keeps in one move."""
FLOOR = 2e-5
"""Distance [m] below which a pair comes no closer."""
MAX_SWEEPS = 60
PAIRS_PER_PART = 8192
"""Pairs for which one thread finds planes at a time."""
UNKNOWN = np.empty(0)


@helper
def _set_plane(p, move, kind, i, j, k, m, nx, ny, nz, distance, plane, row):  # type: ignore[no-untyped-def]
    """Write the plane with normal n into a row if it separates the pair better at the end than the one there.

    Every plane that separates the pair at the start is valid: which one is kept decides only how much motion
    it allows.
    """
    hi = nx * p[i, 0] + ny * p[i, 1] + nz * p[i, 2]
    hj = nx * p[j, 0] + ny * p[j, 1] + nz * p[j, 2]
    hk = nx * p[k, 0] + ny * p[k, 1] + nz * p[k, 2]
    hm = nx * p[m, 0] + ny * p[m, 1] + nz * p[m, 2]
    mi = nx * move[i, 0] + ny * move[i, 1] + nz * move[i, 2]
    mj = nx * move[j, 0] + ny * move[j, 1] + nz * move[j, 2]
    mk = nx * move[k, 0] + ny * move[k, 1] + nz * move[k, 2]
    mm = nx * move[m, 0] + ny * move[m, 1] + nz * move[m, 2]
    if kind == 0:
        low = hi
        top = max(hj, hk, hm)
        end = hi + mi - max(hj + mj, hk + mk, hm + mm)
    else:
        low = min(hi, hj)
        top = max(hk, hm)
        end = min(hi + mi, hj + mj) - max(hk + mk, hm + mm)
    # Along the closest points' normal the separation is their distance, less a rounding error.
    apart = min(distance, low - top)
    keep = max(KEPT_SHARE * distance, min(distance, FLOOR))
    margin = end - keep
    if plane[row, 8] >= margin:
        return
    plane[row, 0] = nx
    plane[row, 1] = ny
    plane[row, 2] = nz
    plane[row, 3] = apart
    plane[row, 4] = hi - low
    plane[row, 5] = top - hj if kind == 0 else hj - low
    plane[row, 6] = top - hk
    plane[row, 7] = top - hm
    plane[row, 8] = margin
    plane[row, 9] = keep


@kernel(types.int64(F64_2, F64_2, F64_1, I32_2, types.int64, F64_1, OUT_I32_1, OUT_F64_2))
def _planes(p, move, reach, pairs, kind, known, active, plane):  # type: ignore[no-untyped-def]
    """Collect the pairs that the motion could bring together, each with a separating plane.

    known: distances of the pairs, or of none.

    plane rows: n (3), separation, each vertex's distance behind its own support plane (4), margin at the
    end of the full motion, separation to keep. Returns the count of pairs.
    """
    count = np.int64(0)  # typed: a literal would be a second specialisation of _set_plane
    for row in range(pairs.shape[0]):
        i = unsigned(pairs[row, 0])
        j = unsigned(pairs[row, 1])
        k = unsigned(pairs[row, 2])
        m = unsigned(pairs[row, 3])
        if kind == 0:
            motion = reach[i] + max(reach[j], reach[k], reach[m])
        else:
            motion = max(reach[i], reach[j]) + max(reach[k], reach[m])
        if known.shape[0] > 0:
            d = known[row]
            if d > 0.0 and d - motion >= max(KEPT_SHARE * d, min(d, FLOOR)):
                continue
        wi, wj, wk, wm = pair_weights(p, kind, i, j, k, m)
        x, y, z = weighted_sum(p, i, j, k, m, wi, wj, wk, wm)
        d = length(x, y, z)
        if d > 0.0 and d - motion >= max(KEPT_SHARE * d, min(d, FLOOR)):
            continue
        active[count] = row
        inverse = 1.0 / max(d, 1e-300)
        plane[count, 8] = -np.inf
        _set_plane(p, move, kind, i, j, k, m, x * inverse, y * inverse, z * inverse, d, plane, count)
        if plane[count, 8] < 0.0:
            # Sliding past an edge or a face ahead, the closest points' normal points sideways: the
            # normal of the face, or of the two edges, often separates the pair as well and lets it pass.
            nx, ny, nz = spanned_normal(p, kind, i, j, k, m, x, y, z)
            if separation(p, kind, i, j, k, m, nx, ny, nz) > 2.0 * KEPT_SHARE * d:
                _set_plane(p, move, kind, i, j, k, m, nx, ny, nz, d, plane, count)
        count += 1
    return count


@helper
def _along(nx, ny, nz, move, v):  # type: ignore[no-untyped-def]
    return nx * move[v, 0] + ny * move[v, 1] + nz * move[v, 2]


@helper
def _cut(factor, v, speed, offset, allowed):  # type: ignore[no-untyped-def]
    """Shorten vertex v so that its approach (speed * factor - offset) is at most `allowed`."""
    if speed * factor[v] - offset > allowed:
        factor[v] = max((allowed + offset) / speed, 0.0)


@kernel(
    types.int64(
        F64_2, I32_2, types.int64, I32_1, F64_2, types.int64, types.int64, types.boolean, OUT_I32_1, OUT_F64_1
    )
)
def _sweep(  # type: ignore[no-untyped-def]
    move, pairs, kind, active, plane, count, sweep, final, last_cut, factor
):
    """Shorten the approaching vertices of every unsafe pair; return how many pairs were unsafe.

    last_cut: sweep in which a vertex was last in an unsafe pair. Pairs all of whose vertices are as they
    were when the pair was last found safe are not looked at, but in the last sweep of all.
    """
    unsafe = 0
    split = 1 if kind == 0 else 2
    v = np.empty(4, np.int64)
    toward = np.empty(4, np.float64)
    for c in range(count):
        row = active[c]
        latest = max(
            last_cut[pairs[row, 0]], last_cut[pairs[row, 1]], last_cut[pairs[row, 2]], last_cut[pairs[row, 3]]
        )
        if latest < sweep - 1 and not final:
            continue
        nx = plane[c, 0]
        ny = plane[c, 1]
        nz = plane[c, 2]
        d = plane[c, 3]
        approach_a = -np.inf
        approach_b = -np.inf
        for q in range(4):
            v[q] = pairs[row, q]
            along = _along(nx, ny, nz, move, v[q])
            toward[q] = -along if q < split else along
            reached = toward[q] * factor[v[q]] - plane[c, 4 + q]
            if q < split:
                approach_a = max(approach_a, reached)
            else:
                approach_b = max(approach_b, reached)
        slack = max(d - plane[c, 9], 0.0)
        if final:
            # Fixed middle plane: stays true whatever other cuts do.
            allowed_a = 0.5 * slack
            allowed_b = 0.5 * slack
            if approach_a <= allowed_a and approach_b <= allowed_b:
                continue
        else:
            if approach_a + approach_b <= slack * (1.0 + 1e-9) + 1e-15:
                continue
            if approach_a <= 0.0:
                allowed_a = approach_a
                allowed_b = slack - approach_a
            elif approach_b <= 0.0:
                allowed_b = approach_b
                allowed_a = slack - approach_b
            else:
                share = slack / (approach_a + approach_b)
                allowed_a = approach_a * share
                allowed_b = approach_b * share
        unsafe += 1
        for q in range(4):
            last_cut[v[q]] = sweep
            _cut(factor, v[q], toward[q], plane[c, 4 + q], allowed_a if q < split else allowed_b)
    return unsafe


def safe_factors(
    p: Float, move: Float, vertex_face: Int, edge_edge: Int, known: tuple[Float, Float] = (UNKNOWN, UNKNOWN)
) -> Float:
    """Factor in [0, 1] per vertex so that p + factor * move, moved straight, lets no pair meet.

    Parameters
    ----------
    p, move
        Positions and wanted displacements [m], shape (n, 3).
    vertex_face, edge_edge
        All pairs that can meet: those whose distance is less than the motion of their vertices.
    known
        Their distances at p [m], shapes (n,), as measured before: most pairs then need no second look.
    """
    factor = np.ones(len(p))
    reach = np.sqrt(np.einsum("ij,ij->i", move, move))
    sets = []
    for kind, pairs, distances in ((0, vertex_face, known[0]), (1, edge_edge, known[1])):
        if len(pairs) == 0:
            continue
        active, plane = _watched(p, move, reach, pairs, kind, distances)
        if len(active):
            sets.append((pairs, kind, active, plane, len(active)))
    last_cut = np.full(len(p), -1, np.int32)
    for sweep in range(MAX_SWEEPS + 1):
        final = sweep == MAX_SWEEPS
        unsafe = 0
        for pairs, kind, active, plane, count in sets:
            unsafe += _sweep(move, pairs, kind, active, plane, count, sweep, final, last_cut, factor)
        if unsafe == 0:
            break
    return factor


def _watched(p: Float, move: Float, reach: Float, pairs: Int, kind: int, known: Float) -> tuple[Int, Float]:
    """Return rows of pairs that the motion could bring together, shape (c,), and their planes, (c, 10)."""

    def watch(first: int, last: int) -> tuple[Int, Float]:
        active, plane = np.empty(last - first, np.int32), np.empty((last - first, 10))
        count = _planes(p, move, reach, pairs[first:last], kind, known[first:last], active, plane)
        return active[:count] + np.int32(first), plane[:count]

    parts = in_parts(watch, len(pairs), PAIRS_PER_PART)
    if len(parts) == 1:
        return parts[0]
    return np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])
