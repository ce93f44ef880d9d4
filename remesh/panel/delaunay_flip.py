"""Delaunay flips in a flat triangulation whose border edges stay (Lawson 1977).

Triangles are rows of `corners` (counter-clockwise); `across[t, k]` is the triangle on the other side of the
edge opposite to corner k, -1 at the border.
"""

import numpy as np
from numba import types

from toile.geometry.arrays import Int
from toile.geometry.kernel import F64_2, OUT_I32_1, OUT_I32_2, helper, kernel
from toile.remesh.panel.plane import after, before, outside_circumcircle


def neighbours_across(corners: Int) -> Int:
    """Triangle across the edge opposite to each corner, shape (t, 3), -1 at the border.

    Raises ValueError if an edge has more than two triangles.
    """
    start = corners[:, [1, 2, 0]].ravel().astype(np.int64)
    end = corners[:, [2, 0, 1]].ravel().astype(np.int64)
    size = int(corners.max()) + 1
    key = np.minimum(start, end) * size + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    same = key[order][1:] == key[order][:-1]
    if np.any(same[1:] & same[:-1]):
        raise ValueError("an edge has more than two triangles")
    across = np.full(len(key), -1, dtype=np.int32)
    first, second = order[:-1][same], order[1:][same]
    across[first], across[second] = second // 3, first // 3
    return across.reshape(-1, 3)


@helper
def flip(corners, across, t, k):  # type: ignore[no-untyped-def]
    """Replace edge bc opposite to corner k of triangle t = abc by ad; t becomes abd and its neighbour adc."""
    u = np.int64(across[t, k])
    j = 0
    while across[u, j] != t:
        j += 1
    a, b, c = corners[t, k], corners[t, after(k)], corners[t, before(k)]
    d = corners[u, j]
    beyond_ab, beyond_ca = across[t, before(k)], across[t, after(k)]
    beyond_bd, beyond_dc = across[u, after(j)], across[u, before(j)]
    corners[t, 0], corners[t, 1], corners[t, 2] = a, b, d
    corners[u, 0], corners[u, 1], corners[u, 2] = a, d, c
    across[t, 0], across[t, 1], across[t, 2] = beyond_bd, u, beyond_ab
    across[u, 0], across[u, 1], across[u, 2] = beyond_dc, beyond_ca, t
    replace_neighbour(across, beyond_bd, u, t)
    replace_neighbour(across, beyond_ca, t, u)
    return u


@helper
def replace_neighbour(across, t, old, new):  # type: ignore[no-untyped-def]
    """Let triangle t (may be -1) point to `new` where it pointed to `old`."""
    if t >= 0:
        for k in range(3):
            if across[t, k] == old:
                across[t, k] = new
                return


@helper
def edge_is_delaunay(points, corners, across, t, k):  # type: ignore[no-untyped-def]
    """Tell whether an edge should stay: it is a border edge, or locally Delaunay."""
    u = across[t, k]
    if u < 0:
        return True
    j = 0
    while across[u, j] != t:
        j += 1
    a, b, c = corners[t, k], corners[t, after(k)], corners[t, before(k)]
    d = corners[u, j]
    return outside_circumcircle(
        points[a, 0],
        points[a, 1],
        points[b, 0],
        points[b, 1],
        points[c, 0],
        points[c, 1],
        points[d, 0],
        points[d, 1],
    )


@kernel(types.int64(F64_2, OUT_I32_2, OUT_I32_2, OUT_I32_1))
def flip_to_delaunay(points, corners, across, stack):  # type: ignore[no-untyped-def]
    """Flip until every inner edge is constrained Delaunay; returns the number of flips.

    `stack` is work space of 3 t entries.
    """
    flips = 0
    limit = 200 * len(corners) + 1000
    changed = True
    while changed and flips < limit:
        changed = False
        for seed in range(len(corners)):
            stack[0] = seed
            depth = 1
            while depth > 0 and flips < limit:
                depth -= 1
                t = np.int64(stack[depth])
                for k in range(3):
                    if not edge_is_delaunay(points, corners, across, t, k):
                        u = flip(corners, across, t, k)
                        flips += 1
                        changed = True
                        if depth + 2 <= len(stack):
                            stack[depth] = t
                            stack[depth + 1] = u
                            depth += 2
                        break
    return flips
