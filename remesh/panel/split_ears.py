"""Removal of ears: corners of a flat triangulation that are filled by one triangle.

Such a triangle ("ear") has two border edges and three border points: nothing in it can move once its border
is sewn. Flipping its inner edge gives the corner two triangles that share an inner point.
"""

from numba import types

from toile.geometry.kernel import F64_2, OUT_I32_2, helper, kernel
from toile.remesh.panel.delaunay_flip import flip
from toile.remesh.panel.plane import after, before, turn


@helper
def ear_corner(across, t):  # type: ignore[no-untyped-def]
    """Corner between the two border edges of triangle t; -1 if t is not an ear."""
    inner, count = -1, 0
    for k in range(3):
        if across[t, k] >= 0:
            inner = k
            count += 1
    return inner if count == 1 else -1


@kernel(types.int64(F64_2, OUT_I32_2, OUT_I32_2, types.int64, types.float64))
def split_ears(points, corners, across, border_count, sharpest):  # type: ignore[no-untyped-def]
    """Split ears whose corner angle has a cosine below `sharpest`; returns the number of flips.

    An ear stays whose neighbour has no inner point to share, or where the flip would invert a triangle.
    """
    flips = 0
    for t in range(len(corners)):
        k = ear_corner(across, t)
        if k < 0:
            continue
        a, b, c = corners[t, k], corners[t, after(k)], corners[t, before(k)]
        u = across[t, k]
        j = 0
        while across[u, j] != t:
            j += 1
        d = corners[u, j]
        if d < border_count:
            continue
        ax, ay = points[a, 0], points[a, 1]
        bx, by = points[b, 0], points[b, 1]
        cx, cy = points[c, 0], points[c, 1]
        dx, dy = points[d, 0], points[d, 1]
        dot = (bx - ax) * (cx - ax) + (by - ay) * (cy - ay)
        lengths = (((bx - ax) ** 2 + (by - ay) ** 2) * ((cx - ax) ** 2 + (cy - ay) ** 2)) ** 0.5
        diagonal = (dx - ax) ** 2 + (dy - ay) ** 2
        abd, adc = turn(ax, ay, bx, by, dx, dy), turn(ax, ay, dx, dy, cx, cy)
        if dot < sharpest * lengths and min(abd, adc) > 0.05 * diagonal:
            flip(corners, across, t, k)
            flips += 1
    return flips
