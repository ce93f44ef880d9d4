"""Whether two triangles meet, exactly: touching counts, in one plane as well.

The triangles are rows 0 to 2 and 3 to 5 of an array t, shape (6, 3). Two closed triangles have a point in
common if and only if an edge of one has a point in common with the other.
"""

from toile.collide.crossings.orientation import area_sign, volume_sign
from toile.geometry.kernel import helper

ROUNDING = 1e-14
"""Bound on what rounding does to a sum of three products, as a share of the sum of their sizes."""


@helper
def _seen_to_meet(t, p, q, a, b, x, y, parts):  # type: ignore[no-untyped-def]
    """Whether segments pq and ab meet as seen in axes x and y."""
    to_a, to_b = area_sign(t, p, q, a, x, y, parts), area_sign(t, p, q, b, x, y, parts)
    to_p, to_q = area_sign(t, a, b, p, x, y, parts), area_sign(t, a, b, q, x, y, parts)
    if to_a != 0 or to_b != 0 or to_p != 0 or to_q != 0:
        return to_a * to_b <= 0 and to_p * to_q <= 0
    for axis in (x, y):
        if max(t[p, axis], t[q, axis]) < min(t[a, axis], t[b, axis]):
            return False
        if max(t[a, axis], t[b, axis]) < min(t[p, axis], t[q, axis]):
            return False
    return True


@helper
def _segments_meet(t, p, q, a, b, parts):  # type: ignore[no-untyped-def]
    """Whether segments pq and ab meet: they lie in one plane and are seen to meet along every axis.

    Along at least one of the axes no two points of the plane fall together.
    """
    if volume_sign(t, p, q, a, b, parts) != 0:
        return False
    for x in range(3):
        if not _seen_to_meet(t, p, q, a, b, x, (x + 1) % 3, parts):
            return False
    return True


@helper
def _holds(t, first, p, parts):  # type: ignore[no-untyped-def]
    """Whether the triangle that starts at row `first` holds point p of its plane, seen along every axis."""
    a, b, c = first, first + 1, first + 2
    for x in range(3):
        y = (x + 1) % 3
        if not min(t[a, x], t[b, x], t[c, x]) <= t[p, x] <= max(t[a, x], t[b, x], t[c, x]):
            return False
        one, two = area_sign(t, a, b, p, x, y, parts), area_sign(t, b, c, p, x, y, parts)
        three = area_sign(t, c, a, p, x, y, parts)
        if min(one, two, three) < 0 < max(one, two, three):
            return False
    return True


@helper
def _edge_meets(t, p, q, side_p, side_q, first, parts):  # type: ignore[no-untyped-def]
    """Whether segment pq meets the triangle that starts at row `first`; on which sides of it p and q lie."""
    if side_p * side_q > 0:
        return False
    a, b, c = first, first + 1, first + 2
    if side_p != 0 or side_q != 0:
        one = volume_sign(t, p, q, a, b, parts)
        two = volume_sign(t, p, q, b, c, parts)
        if one * two < 0:
            return False
        three = volume_sign(t, p, q, c, a, parts)
        return one * three >= 0 and two * three >= 0
    if _holds(t, first, p, parts) or _holds(t, first, q, parts):
        return True
    return (
        _segments_meet(t, p, q, a, b, parts)
        or _segments_meet(t, p, q, b, c, parts)
        or _segments_meet(t, p, q, c, a, parts)
    )


@helper
def _is_flat(t, first, parts):  # type: ignore[no-untyped-def]
    """Whether the three corners of a triangle lie on one line."""
    for x in range(3):
        if area_sign(t, first, first + 1, first + 2, x, (x + 1) % 3, parts) != 0:
            return False
    return True


@helper
def _lie_apart(t):  # type: ignore[no-untyped-def]
    """Whether a plane across the way between the two centroids is seen to separate the triangles.

    Spares faces of one flat sheet the exact arithmetic that they would need otherwise.
    """
    low, high, size = -1e300, 1e300, 0.0
    nx = t[3, 0] + t[4, 0] + t[5, 0] - (t[0, 0] + t[1, 0] + t[2, 0])
    ny = t[3, 1] + t[4, 1] + t[5, 1] - (t[0, 1] + t[1, 1] + t[2, 1])
    nz = t[3, 2] + t[4, 2] + t[5, 2] - (t[0, 2] + t[1, 2] + t[2, 2])
    for row in range(6):
        height = nx * t[row, 0] + ny * t[row, 1] + nz * t[row, 2]
        size = max(size, abs(nx * t[row, 0]) + abs(ny * t[row, 1]) + abs(nz * t[row, 2]))
        if row < 3:
            low = max(low, height)
        else:
            high = min(high, height)
    return high - low > 2.0 * ROUNDING * size


@helper
def _lies_beside(t, first, other):  # type: ignore[no-untyped-def]
    """Whether one triangle is seen to lie on one side of the plane of another; spares most of the rest."""
    ux, uy, uz = t[first + 1, 0] - t[first, 0], t[first + 1, 1] - t[first, 1], t[first + 1, 2] - t[first, 2]
    vx, vy, vz = t[first + 2, 0] - t[first, 0], t[first + 2, 1] - t[first, 1], t[first + 2, 2] - t[first, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    low, high, size = 1e300, -1e300, 0.0
    for row in range(other, other + 3):
        dx, dy, dz = t[row, 0] - t[first, 0], t[row, 1] - t[first, 1], t[row, 2] - t[first, 2]
        height = nx * dx + ny * dy + nz * dz
        low, high = min(low, height), max(high, height)
        size = max(size, abs(dx), abs(dy), abs(dz))
    size *= max(abs(ux), abs(uy), abs(uz)) * max(abs(vx), abs(vy), abs(vz))
    return low > 6.0 * ROUNDING * size or high < -6.0 * ROUNDING * size


@helper
def triangles_meet(t, parts):  # type: ignore[no-untyped-def]
    """Whether two triangles without a common corner meet; parts is scratch of orientation.ROOM numbers."""
    if _lies_beside(t, 3, 0) or _lies_beside(t, 0, 3) or _lie_apart(t):
        return False
    s0, s1 = volume_sign(t, 3, 4, 5, 0, parts), volume_sign(t, 3, 4, 5, 1, parts)
    s2 = volume_sign(t, 3, 4, 5, 2, parts)
    if min(s0, s1, s2) > 0 or max(s0, s1, s2) < 0:
        return False
    s3, s4 = volume_sign(t, 0, 1, 2, 3, parts), volume_sign(t, 0, 1, 2, 4, parts)
    s5 = volume_sign(t, 0, 1, 2, 5, parts)
    if min(s3, s4, s5) > 0 or max(s3, s4, s5) < 0:
        return False
    return (
        _edge_meets(t, 0, 1, s0, s1, 3, parts)
        or _edge_meets(t, 1, 2, s1, s2, 3, parts)
        or _edge_meets(t, 2, 0, s2, s0, 3, parts)
        or _edge_meets(t, 3, 4, s3, s4, 0, parts)
        or _edge_meets(t, 4, 5, s4, s5, 0, parts)
        or _edge_meets(t, 5, 3, s5, s3, 0, parts)
    )


@helper
def _part_at_corner(t):  # type: ignore[no-untyped-def]
    """Whether a plane through the common corner is seen to separate the rest: that across both bisectors."""
    one = two = 0.0
    for x in range(3):
        one += (t[1, x] + t[2, x] - 2.0 * t[0, x]) ** 2
        two += (t[4, x] + t[5, x] - 2.0 * t[0, x]) ** 2
    one, two = max(one, 1e-300) ** 0.5, max(two, 1e-300) ** 0.5
    nx = (t[1, 0] + t[2, 0] - 2.0 * t[0, 0]) / one - (t[4, 0] + t[5, 0] - 2.0 * t[0, 0]) / two
    ny = (t[1, 1] + t[2, 1] - 2.0 * t[0, 1]) / one - (t[4, 1] + t[5, 1] - 2.0 * t[0, 1]) / two
    nz = (t[1, 2] + t[2, 2] - 2.0 * t[0, 2]) / one - (t[4, 2] + t[5, 2] - 2.0 * t[0, 2]) / two
    for row in (1, 2, 4, 5):
        dx, dy, dz = t[row, 0] - t[0, 0], t[row, 1] - t[0, 1], t[row, 2] - t[0, 2]
        height = nx * dx + ny * dy + nz * dz
        if row > 2:
            height = -height
        if height <= ROUNDING * (abs(nx * dx) + abs(ny * dy) + abs(nz * dz)):
            return False
    return True


@helper
def meet_beyond_corner(t, parts):  # type: ignore[no-untyped-def]
    """Whether two triangles with a common corner, rows 0 and 3, meet elsewhere too.

    What they have in common is then a cone at that corner, which ends at the opposite edge of one of them. A
    triangle without area may hold the corner in that edge: such a pair counts as not meeting.
    """
    if _part_at_corner(t):
        return False
    s1, s2 = volume_sign(t, 3, 4, 5, 1, parts), volume_sign(t, 3, 4, 5, 2, parts)
    s4, s5 = volume_sign(t, 0, 1, 2, 4, parts), volume_sign(t, 0, 1, 2, 5, parts)
    if _edge_meets(t, 1, 2, s1, s2, 3, parts) or _edge_meets(t, 4, 5, s4, s5, 0, parts):
        return not (_is_flat(t, 0, parts) or _is_flat(t, 3, parts))
    return False
