"""Closest point between a vertex and a triangle."""

from toile.geometry.kernel import helper

SLIVER = 1e-6
"""Squared height over length below which the products of section 5.1.5 lose the weights to rounding."""
FLAT = 1e-16
"""The same ratio below which a triangle is its edges."""


@helper
def _on_edge(px, py, pz, ax, ay, az, bx, by, bz):  # type: ignore[no-untyped-def]
    """Parameter of the point of segment ab closest to p, and its squared distance."""
    ux, uy, uz = bx - ax, by - ay, bz - az
    wx, wy, wz = px - ax, py - ay, pz - az
    uu = ux * ux + uy * uy + uz * uz
    t = 0.0
    if uu > 0.0:
        t = min(max((ux * wx + uy * wy + uz * wz) / uu, 0.0), 1.0)
    wx -= t * ux
    wy -= t * uy
    wz -= t * uz
    return t, wx * wx + wy * wy + wz * wz


@helper
def _closest_on_sliver(px, py, pz, ax, ay, az, bx, by, bz, cx, cy, cz):  # type: ignore[no-untyped-def]
    """Barycentric coordinates of the closest point of a thin triangle: by its normal, else on its edges.

    Areas taken through the normal lose (height / length) of their digits, not its square.
    """
    ux, uy, uz = bx - ax, by - ay, bz - az
    vx, vy, vz = cx - ax, cy - ay, cz - az
    wx, wy, wz = px - ax, py - ay, pz - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    nn = nx * nx + ny * ny + nz * nz
    longest = max(ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz)
    if nn > FLAT * longest * longest:
        wc = (nx * (uy * wz - uz * wy) + ny * (uz * wx - ux * wz) + nz * (ux * wy - uy * wx)) / nn
        wb = (nx * (wy * vz - wz * vy) + ny * (wz * vx - wx * vz) + nz * (wx * vy - wy * vx)) / nn
        if wb >= 0.0 and wc >= 0.0 and wb + wc <= 1.0:
            return 1.0 - wb - wc, wb, wc
    t, ab = _on_edge(px, py, pz, ax, ay, az, bx, by, bz)
    s, bc = _on_edge(px, py, pz, bx, by, bz, cx, cy, cz)
    r, ca = _on_edge(px, py, pz, cx, cy, cz, ax, ay, az)
    if ab <= bc and ab <= ca:
        return 1.0 - t, t, 0.0
    if bc <= ca:
        return 0.0, 1.0 - s, s
    return r, 0.0, 1.0 - r


@helper
def closest_barycentric(px, py, pz, ax, ay, az, bx, by, bz, cx, cy, cz):  # type: ignore[no-untyped-def]
    """Barycentric coordinates (a, b, c) of the point of triangle abc closest to p.

    Ericson, Real-Time Collision Detection, section 5.1.5: which Voronoi region of the triangle holds p;
    inside a thin triangle that formula is all rounding noise, so it is left to `_closest_on_sliver`.
    """
    abx, aby, abz = bx - ax, by - ay, bz - az
    acx, acy, acz = cx - ax, cy - ay, cz - az
    apx, apy, apz = px - ax, py - ay, pz - az
    d1 = abx * apx + aby * apy + abz * apz
    d2 = acx * apx + acy * apy + acz * apz
    if d1 <= 0.0 and d2 <= 0.0:
        return 1.0, 0.0, 0.0
    bpx, bpy, bpz = px - bx, py - by, pz - bz
    d3 = abx * bpx + aby * bpy + abz * bpz
    d4 = acx * bpx + acy * bpy + acz * bpz
    if d3 >= 0.0 and d4 <= d3:
        return 0.0, 1.0, 0.0
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0 and d1 - d3 > 0.0:
        t = d1 / (d1 - d3)
        return 1.0 - t, t, 0.0
    cpx, cpy, cpz = px - cx, py - cy, pz - cz
    d5 = abx * cpx + aby * cpy + abz * cpz
    d6 = acx * cpx + acy * cpy + acz * cpz
    if d6 >= 0.0 and d5 <= d6:
        return 0.0, 0.0, 1.0
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0 and d2 - d6 > 0.0:
        t = d2 / (d2 - d6)
        return 1.0 - t, 0.0, t
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0 and (d4 - d3) + (d5 - d6) > 0.0:
        t = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return 0.0, 1.0 - t, t
    total = va + vb + vc
    longest = max(abx * abx + aby * aby + abz * abz, acx * acx + acy * acy + acz * acz)
    if total <= SLIVER * longest * longest:
        return _closest_on_sliver(px, py, pz, ax, ay, az, bx, by, bz, cx, cy, cz)
    return va / total, vb / total, vc / total
