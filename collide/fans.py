"""Pairs of faces that share a vertex and fan out from it, as most such pairs of smooth cloth do.

Only the side of one face opposite the vertex, and the other face, can come close.
"""

from toile.collide.pair_distance import length
from toile.geometry.kernel import helper, unsigned


@helper
def corners_from(faces, t, corner):  # type: ignore[no-untyped-def]
    """Vertices of a face in its order, from one of its corners on."""
    after, last = (corner + unsigned(1)) % unsigned(3), (corner + unsigned(2)) % unsigned(3)
    return unsigned(faces[t, corner]), unsigned(faces[t, after]), unsigned(faces[t, last])


@helper
def fans_stay_apart(p, ends, a, b, c, d, e, f, reach):  # type: ignore[no-untyped-def]
    """Whether faces abc and def, of which a and d are one vertex, fan out from it at a distance.

    Then edge bc keeps farther from def, and ef from abc, than reach while they move from p to ends: that is
    all that may be asked of them. So do 99 of 100 such pairs in cloth that is not creased.
    """
    # From the shared vertex to the middles of the sides across, twice.
    ux, uy, uz = _towards_side(p, a, b, c)
    vx, vy, vz = _towards_side(p, d, e, f)
    x, y, z = ux - 0.5 * vx, uy - 0.5 * vy, uz - 0.5 * vz
    far = reach * length(x, y, z)
    if not (_side_ahead(p, b, c, d, e, f, x, y, z) > far and _side_ahead(ends, b, c, d, e, f, x, y, z) > far):
        return False
    x, y, z = vx - 0.5 * ux, vy - 0.5 * uy, vz - 0.5 * uz
    far = reach * length(x, y, z)
    return _side_ahead(p, e, f, a, b, c, x, y, z) > far and _side_ahead(ends, e, f, a, b, c, x, y, z) > far


@helper
def _towards_side(p, a, b, c):  # type: ignore[no-untyped-def]
    """Twice the way from a to the middle of bc."""
    return (
        p[b, 0] + p[c, 0] - 2.0 * p[a, 0],
        p[b, 1] + p[c, 1] - 2.0 * p[a, 1],
        p[b, 2] + p[c, 2] - 2.0 * p[a, 2],
    )


@helper
def _side_ahead(p, b, c, d, e, f, x, y, z):  # type: ignore[no-untyped-def]
    """How far side bc lies ahead of face def along a direction."""
    least = min(x * p[b, 0] + y * p[b, 1] + z * p[b, 2], x * p[c, 0] + y * p[c, 1] + z * p[c, 2])
    return least + lowest(p, d, e, f, -x, -y, -z)


@helper
def lowest(p, a, b, c, x, y, z):  # type: ignore[no-untyped-def]
    """Least of three vertices along a direction."""
    return min(
        x * p[a, 0] + y * p[a, 1] + z * p[a, 2],
        x * p[b, 0] + y * p[b, 1] + z * p[b, 2],
        x * p[c, 0] + y * p[c, 1] + z * p[c, 2],
    )
