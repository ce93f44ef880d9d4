"""Exact signs of areas and volumes of points in floating point.

A determinant is rounded first; if it may have the wrong sign, it is summed once more without any rounding, as
floating-point numbers that do not overlap (Shewchuk 1997, Adaptive precision floating-point arithmetic and
fast robust geometric predicates). Signs are exact unless a product of three differences falls below the
smallest number (1e-308 m^3).
"""

from toile.geometry.kernel import helper

SPLITTER = 134217729.0
"""2^27 + 1: splits a number of 53 bits into halves whose products are exact."""
FLAT_BOUND = 3.3306690738754716e-16
SOLID_BOUND = 7.771561172376103e-16
"""Largest rounding error of the two determinants, as a share of the sum of the sizes of their terms."""
ROOM = 256
"""Numbers that a sum may need: it never has more parts than terms, of which there are 192 at most."""


@helper
def _two_sum(a, b):  # type: ignore[no-untyped-def]
    """Return a + b, rounded, and what rounding lost (Knuth)."""
    total = a + b
    rest = total - a
    return total, (a - (total - rest)) + (b - rest)


@helper
def _two_product(a, b):  # type: ignore[no-untyped-def]
    """Return a b, rounded, and what rounding lost (Dekker)."""
    product = a * b
    large = SPLITTER * a
    high_a = large - (large - a)
    low_a = a - high_a
    large = SPLITTER * b
    high_b = large - (large - b)
    low_b = b - high_b
    return product, low_a * low_b - (((product - high_a * high_b) - low_a * high_b) - high_a * low_b)


@helper
def _add(parts, count, value):  # type: ignore[no-untyped-def]
    """Add a number to a sum of `count` parts that do not overlap, smallest first; return their new number."""
    kept = 0
    for k in range(count):
        value, rest = _two_sum(value, parts[k])
        if rest != 0.0:
            parts[kept] = rest
            kept += 1
    if value != 0.0:
        parts[kept] = value
        kept += 1
    return kept


@helper
def _sign_of(parts, count):  # type: ignore[no-untyped-def]
    """Sign of a sum: that of its largest part."""
    if count == 0:
        return 0
    return 1 if parts[count - 1] > 0.0 else -1


@helper
def _add_product(parts, count, sign, a, b):  # type: ignore[no-untyped-def]
    """Add sign a b."""
    product, rest = _two_product(a, b)
    return _add(parts, _add(parts, count, sign * rest), sign * product)


@helper
def _exact_area_sign(t, a, b, c, x, y, parts):  # type: ignore[no-untyped-def]
    """Sign of (a - c) x (b - c), whose differences are kept as two numbers each."""
    count = 0
    u, v = _two_sum(t[a, x], -t[c, x]), _two_sum(t[b, y], -t[c, y])
    r, s = _two_sum(t[a, y], -t[c, y]), _two_sum(t[b, x], -t[c, x])
    for i in range(2):
        for j in range(2):
            count = _add_product(parts, count, 1.0, u[i], v[j])
            count = _add_product(parts, count, -1.0, r[i], s[j])
    return _sign_of(parts, count)


@helper
def area_sign(t, a, b, c, x, y, parts):  # type: ignore[no-untyped-def]
    """Exact sign of the area of rows abc of t, seen in axes x and y: 1 where they run counter-clockwise.

    parts is scratch of ROOM numbers.
    """
    left = (t[a, x] - t[c, x]) * (t[b, y] - t[c, y])
    right = (t[a, y] - t[c, y]) * (t[b, x] - t[c, x])
    bound = FLAT_BOUND * (abs(left) + abs(right))
    if left - right > bound:
        return 1
    if left - right < -bound:
        return -1
    if bound == 0.0:
        return 0
    return _exact_area_sign(t, a, b, c, x, y, parts)


@helper
def _add_triple(parts, count, sign, u, v, w):  # type: ignore[no-untyped-def]
    """Add sign u v w of numbers in two parts each."""
    for i in range(2):
        for j in range(2):
            product, rest = _two_product(u[i], v[j])
            for k in range(2):
                count = _add_product(parts, count, sign, product, w[k])
                count = _add_product(parts, count, sign, rest, w[k])
    return count


@helper
def _exact_volume_sign(t, a, b, c, d, parts):  # type: ignore[no-untyped-def]
    """Sign of det(a - d, b - d, c - d), whose differences are kept as two numbers each."""
    count = 0
    for x in range(3):
        y, z = (x + 1) % 3, (x + 2) % 3
        u = _two_sum(t[a, x], -t[d, x])
        count = _add_triple(parts, count, 1.0, u, _two_sum(t[b, y], -t[d, y]), _two_sum(t[c, z], -t[d, z]))
        count = _add_triple(parts, count, -1.0, u, _two_sum(t[b, z], -t[d, z]), _two_sum(t[c, y], -t[d, y]))
    return _sign_of(parts, count)


@helper
def volume_sign(t, a, b, c, d, parts):  # type: ignore[no-untyped-def]
    """Exact sign of det(a - d, b - d, c - d) of rows of t; parts is scratch of ROOM numbers."""
    dx, dy, dz = t[d, 0], t[d, 1], t[d, 2]
    adx, ady, adz = t[a, 0] - dx, t[a, 1] - dy, t[a, 2] - dz
    bdx, bdy, bdz = t[b, 0] - dx, t[b, 1] - dy, t[b, 2] - dz
    cdx, cdy, cdz = t[c, 0] - dx, t[c, 1] - dy, t[c, 2] - dz
    bc, cb = bdx * cdy, cdx * bdy
    ca, ac = cdx * ady, adx * cdy
    ab, ba = adx * bdy, bdx * ady
    volume = adz * (bc - cb) + bdz * (ca - ac) + cdz * (ab - ba)
    size = abs(adz) * (abs(bc) + abs(cb)) + abs(bdz) * (abs(ca) + abs(ac)) + abs(cdz) * (abs(ab) + abs(ba))
    bound = SOLID_BOUND * size
    if volume > bound:
        return 1
    if volume < -bound:
        return -1
    if size == 0.0:
        return 0
    return _exact_volume_sign(t, a, b, c, d, parts)
