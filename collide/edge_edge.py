"""Closest points between two segments."""

from toile.geometry.kernel import helper


@helper
def _clamp01(t):  # type: ignore[no-untyped-def]
    return min(max(t, 0.0), 1.0)


@helper
def closest_parameters(  # type: ignore[no-untyped-def]
    ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz
):
    """Parameters (s, t) of the closest points a + s (b - a) and c + t (d - c), both in [0, 1].

    Ericson, Real-Time Collision Detection, section 5.1.9, with the parallel case solved at an end
    point: there the interior formula divides by rounding noise. Just above that limit s is noisy, yet
    the edges are so parallel that the distance is off by 1e-8 edge lengths at most.
    """
    ux, uy, uz = bx - ax, by - ay, bz - az
    vx, vy, vz = dx - cx, dy - cy, dz - cz
    wx, wy, wz = ax - cx, ay - cy, az - cz
    uu = ux * ux + uy * uy + uz * uz
    vv = vx * vx + vy * vy + vz * vz
    uv = ux * vx + uy * vy + uz * vz
    uw = ux * wx + uy * wy + uz * wz
    vw = vx * wx + vy * wy + vz * wz
    if uu <= 0.0 and vv <= 0.0:
        return 0.0, 0.0
    if uu <= 0.0:
        return 0.0, _clamp01(vw / vv)
    if vv <= 0.0:
        return _clamp01(-uw / uu), 0.0
    det = uu * vv - uv * uv
    s = 0.0
    if det > 1e-15 * uu * vv:
        s = _clamp01((uv * vw - uw * vv) / det)
    t = (uv * s + vw) / vv
    if t < 0.0:
        t = 0.0
        s = _clamp01(-uw / uu)
    elif t > 1.0:
        t = 1.0
        s = _clamp01((uv - uw) / uu)
    return s, t
