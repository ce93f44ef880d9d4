"""Which candidates are near enough to be contacts, and how far apart all of them are."""

import numpy as np
from numba import types

from toile.collide.pair_distance import length, pair_weights, weighted_sum
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_1, F64_2, I32_2, OUT_F64_1, OUT_I32_1, helper, kernel, unsigned
from toile.geometry.threads.crew import in_parts, together

PAIRS_PER_PART = 4096
"""Pairs that one thread measures at a time."""


@helper
def radius_of(radius, kind, i, j, k, m, radius_share, halves):  # type: ignore[no-untyped-def]
    """Contact radius of a pair."""
    r = radius[i]
    other = min(radius[k], radius[m])
    if kind == 0:
        other = min(other, radius[j])
    else:
        r = min(r, radius[j])
    return radius_share * (0.5 * (r + other) if halves else min(r, other))


@kernel(
    types.int64(F64_2, I32_2, types.int64, F64_1, types.float64, F64_2, types.boolean, OUT_F64_1, OUT_I32_1)
)
def _measure(p, pairs, kind, radius, radius_share, ahead, halves, distance, close):  # type: ignore[no-untyped-def]
    """Write distances of pairs, and rows of those closer than the radius now or after the motion ahead.

    Returns how many these are.
    """
    count = 0
    for row in range(pairs.shape[0]):
        i = unsigned(pairs[row, 0])
        j = unsigned(pairs[row, 1])
        k = unsigned(pairs[row, 2])
        m = unsigned(pairs[row, 3])
        wi, wj, wk, wm = pair_weights(p, kind, i, j, k, m)
        x, y, z = weighted_sum(p, i, j, k, m, wi, wj, wk, wm)
        d = length(x, y, z)
        distance[row] = d
        if d <= 0.0:
            continue
        r = radius_of(radius, kind, i, j, k, m, radius_share, halves)
        if d >= r:
            if ahead.shape[0] == 0:
                continue
            nx, ny, nz = x / d, y / d, z / d
            meeting = d
            meeting += wi * (nx * ahead[i, 0] + ny * ahead[i, 1] + nz * ahead[i, 2])
            meeting += wj * (nx * ahead[j, 0] + ny * ahead[j, 1] + nz * ahead[j, 2])
            meeting += wk * (nx * ahead[k, 0] + ny * ahead[k, 1] + nz * ahead[k, 2])
            meeting += wm * (nx * ahead[m, 0] + ny * ahead[m, 1] + nz * ahead[m, 2])
            if meeting >= r:
                continue
        close[count] = row
        count += 1
    return count


def near_pairs(
    p: Float, pairs: Int, kind: int, radius: Float, share: float, ahead: Float, halves: bool, distance: Float
) -> Int:
    """Write the distances of candidates [m]; return the rows of those that may be contacts, in order.

    Parameters
    ----------
    p
        Positions [m], shape (n, 3).
    pairs, kind
        Candidates, shape (k, 4): vertex-face (0) or edge-edge (1).
    radius, share
        Contact radius of every vertex [m], shape (n,), and the share of it that counts.
    ahead
        Motion to come [m], shape (n, 3), or no rows.
    halves
        Whether each side gives half of its smallest radius.
    distance
        Written, shape (k,).
    """

    def measure(first: int, last: int) -> Int:
        near = np.empty(last - first, np.int32)
        count = _measure(p, pairs[first:last], kind, radius, share, ahead, halves, distance[first:last], near)
        return near[:count] + np.int32(first)

    return together(in_parts(measure, len(pairs), PAIRS_PER_PART))
