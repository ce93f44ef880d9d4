"""Distance of a candidate pair of either kind, vertex-face or edge-edge."""

from math import sqrt

from toile.collide.edge_edge import closest_parameters
from toile.collide.vertex_face import closest_barycentric
from toile.geometry.kernel import helper


@helper
def vertex_face_weights(p, v, a, b, c):  # type: ignore[no-untyped-def]
    """Weights (1, -a, -b, -c) whose sum over the four rows of p is the vector from face to vertex."""
    wa, wb, wc = closest_barycentric(
        p[v, 0], p[v, 1], p[v, 2], p[a, 0], p[a, 1], p[a, 2],
        p[b, 0], p[b, 1], p[b, 2], p[c, 0], p[c, 1], p[c, 2],
    )  # fmt: skip
    return 1.0, -wa, -wb, -wc


@helper
def edge_edge_weights(p, a, b, c, d):  # type: ignore[no-untyped-def]
    """Weights whose sum over the four rows of p is the vector from edge cd to edge ab."""
    s, t = closest_parameters(
        p[a, 0], p[a, 1], p[a, 2], p[b, 0], p[b, 1], p[b, 2],
        p[c, 0], p[c, 1], p[c, 2], p[d, 0], p[d, 1], p[d, 2],
    )  # fmt: skip
    return 1.0 - s, s, t - 1.0, -t


@helper
def weighted_sum(p, i, j, k, m, wi, wj, wk, wm):  # type: ignore[no-untyped-def]
    """Weighted sum of four rows of p, as three scalars."""
    return (
        wi * p[i, 0] + wj * p[j, 0] + wk * p[k, 0] + wm * p[m, 0],
        wi * p[i, 1] + wj * p[j, 1] + wk * p[k, 1] + wm * p[m, 1],
        wi * p[i, 2] + wj * p[j, 2] + wk * p[k, 2] + wm * p[m, 2],
    )


@helper
def pair_weights(p, kind, i, j, k, m):  # type: ignore[no-untyped-def]
    """Weights of the closest points of a pair: kind 0 is vertex-face (i, jkm), kind 1 edge-edge (ij, km)."""
    if kind == 0:
        return vertex_face_weights(p, i, j, k, m)
    return edge_edge_weights(p, i, j, k, m)


@helper
def length(x, y, z):  # type: ignore[no-untyped-def]
    """Euclidean length."""
    return sqrt(x * x + y * y + z * z)


@helper
def separation(p, kind, i, j, k, m, nx, ny, nz):  # type: ignore[no-untyped-def]
    """Separation of a pair along n: positive if a plane with normal n lies between its two sides."""
    hi = nx * p[i, 0] + ny * p[i, 1] + nz * p[i, 2]
    hj = nx * p[j, 0] + ny * p[j, 1] + nz * p[j, 2]
    hk = nx * p[k, 0] + ny * p[k, 1] + nz * p[k, 2]
    hm = nx * p[m, 0] + ny * p[m, 1] + nz * p[m, 2]
    if kind == 0:
        return hi - max(hj, hk, hm)
    return min(hi, hj) - max(hk, hm)


@helper
def spanned_normal(p, kind, i, j, k, m, x, y, z):  # type: ignore[no-untyped-def]
    """Return the unit normal of face, or across both edges, on the side of (x, y, z); else zero."""
    if kind == 0:
        ax, ay, az = p[k, 0] - p[j, 0], p[k, 1] - p[j, 1], p[k, 2] - p[j, 2]
        bx, by, bz = p[m, 0] - p[j, 0], p[m, 1] - p[j, 1], p[m, 2] - p[j, 2]
    else:
        ax, ay, az = p[j, 0] - p[i, 0], p[j, 1] - p[i, 1], p[j, 2] - p[i, 2]
        bx, by, bz = p[m, 0] - p[k, 0], p[m, 1] - p[k, 1], p[m, 2] - p[k, 2]
    nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    size = length(nx, ny, nz)
    if size <= 0.0:
        return 0.0, 0.0, 0.0
    size = size if nx * x + ny * y + nz * z >= 0.0 else -size
    return nx / size, ny / size, nz / size
