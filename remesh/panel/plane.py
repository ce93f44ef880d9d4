"""Scalar geometry in the plane, shared by the flat triangulation kernels."""

import math

from toile.geometry.kernel import helper


@helper
def after(k):  # type: ignore[no-untyped-def]
    """Next corner of a triangle, counter-clockwise."""
    return k + 1 if k < 2 else 0


@helper
def before(k):  # type: ignore[no-untyped-def]
    """Previous corner of a triangle."""
    return k - 1 if k > 0 else 2


@helper
def turn(ax, ay, bx, by, cx, cy):  # type: ignore[no-untyped-def]
    """Twice the signed area of a triangle; positive if counter-clockwise."""
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@helper
def squared_circumradius(ax, ay, bx, by, cx, cy):  # type: ignore[no-untyped-def]
    """Square of the circumradius; infinite for a degenerate triangle."""
    twice = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if twice == 0.0:
        return math.inf
    ab = (bx - ax) ** 2 + (by - ay) ** 2
    bc = (cx - bx) ** 2 + (cy - by) ** 2
    ca = (ax - cx) ** 2 + (ay - cy) ** 2
    return ab * bc * ca / (4.0 * twice * twice)


@helper
def quality(ax, ay, bx, by, cx, cy):  # type: ignore[no-untyped-def]
    """Area over sum of squared sides, 1 for an equilateral triangle; negative if inverted."""
    twice = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    sides = (
        (bx - ax) ** 2 + (by - ay) ** 2 + (cx - bx) ** 2 + (cy - by) ** 2 + (ax - cx) ** 2 + (ay - cy) ** 2
    )
    return 3.4641016151377544 * twice / max(sides, 1e-300)


@helper
def squared_distance_to_segment(px, py, ax, ay, bx, by):  # type: ignore[no-untyped-def]
    """Square of the distance from point p to segment ab."""
    dx, dy = bx - ax, by - ay
    along = ((px - ax) * dx + (py - ay) * dy) / max(dx * dx + dy * dy, 1e-300)
    along = min(1.0, max(0.0, along))
    return (px - ax - along * dx) ** 2 + (py - ay - along * dy) ** 2


@helper
def outside_circumcircle(ax, ay, bx, by, cx, cy, dx, dy):  # type: ignore[no-untyped-def]
    """Tell whether d is outside the circle abc, so that edge bc of triangles abc and dcb may stay.

    Also True where flipping bc to ad would make an inverted triangle.
    """
    cos_a = (bx - ax) * (cx - ax) + (by - ay) * (cy - ay)
    sin_a = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    cos_d = (cx - dx) * (bx - dx) + (cy - dy) * (by - dy)
    sin_d = (cx - dx) * (by - dy) - (cy - dy) * (bx - dx)
    scale = (abs(cos_a) + abs(sin_a)) * (abs(cos_d) + abs(sin_d))
    # The slack keeps cocircular points from flipping back and forth for ever.
    if sin_a * cos_d + cos_a * sin_d >= -1e-10 * scale:
        return True
    diagonal = (dx - ax) ** 2 + (dy - ay) ** 2
    abd = (bx - ax) * (dy - ay) - (by - ay) * (dx - ax)
    adc = (dx - ax) * (cy - ay) - (dy - ay) * (cx - ax)
    return abd <= 1e-12 * diagonal or adc <= 1e-12 * diagonal
