"""Selection of edges to flip: those not Delaunay in the metric whose flip improves the mesh."""

import math

import numpy as np
from numba import types

from toile.geometry.kernel import (
    BOOL_1,
    F64_2,
    F64_3,
    I8_1,
    I32_1,
    I32_2,
    OUT_F64_1,
    OUT_I32_2,
    helper,
    kernel,
)
from toile.remesh.mesh.mesh_edges import INNER
from toile.remesh.sizing.metric import aspect, product, squared_length, twice_area


@helper
def mapped(rest, frames, t, p, q, r, start, end):  # type: ignore[no-untyped-def]
    """Where the edge from `start` to `end` lies in the plane in which wanted edges have length 1."""
    x, y = 0.0, 0.0
    for axis in range(3):
        along = rest[end, axis] - rest[start, axis]
        x += along * frames[t, axis, 0]
        y += along * frames[t, axis, 1]
    return p * x + q * y, r * y


@helper
def delaunay_excess(rest, tensors, frames, t, a, b, c, d):  # type: ignore[no-untyped-def]
    """Minus the sine of the sum of the angles at a and d, in the mean metric of the four corners.

    Positive if bc is not Delaunay (Bossen and Heckbert 1996).
    """
    xx, yy, zz, yz, zx, xy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for v in (a, b, c, d):
        xx += 0.25 * tensors[v, 0]
        yy += 0.25 * tensors[v, 1]
        zz += 0.25 * tensors[v, 2]
        yz += 0.25 * tensors[v, 3]
        zx += 0.25 * tensors[v, 4]
        xy += 0.25 * tensors[v, 5]
    wx, wy, wz = frames[t, 0, 0], frames[t, 1, 0], frames[t, 2, 0]
    fx, fy, fz = frames[t, 0, 1], frames[t, 1, 1], frames[t, 2, 1]
    uu = product(xx, yy, zz, yz, zx, xy, wx, wy, wz, wx, wy, wz)
    uv = product(xx, yy, zz, yz, zx, xy, wx, wy, wz, fx, fy, fz)
    vv = product(xx, yy, zz, yz, zx, xy, fx, fy, fz, fx, fy, fz)
    # Cholesky factor of the metric
    p = math.sqrt(max(uu, 1e-300))
    q = uv / p
    r = math.sqrt(max(vv - q * q, 0.0))
    abx, aby = mapped(rest, frames, t, p, q, r, a, b)
    acx, acy = mapped(rest, frames, t, p, q, r, a, c)
    dbx, dby = mapped(rest, frames, t, p, q, r, d, b)
    dcx, dcy = mapped(rest, frames, t, p, q, r, d, c)
    cos_a, sin_a = abx * acx + aby * acy, abx * acy - aby * acx
    cos_d, sin_d = dcx * dbx + dcy * dby, dcx * dby - dcy * dbx
    lengths = math.sqrt((cos_a * cos_a + sin_a * sin_a) * (cos_d * cos_d + sin_d * sin_d))
    return -(sin_a * cos_d + cos_a * sin_d) / max(lengths, 1e-300)


@kernel(
    types.void(
        I32_1, I8_1, BOOL_1, BOOL_1, I32_2, I32_2, I32_2, F64_2, F64_2, F64_3, F64_2, types.float64,
        types.float64, types.float64, OUT_I32_2, OUT_F64_1,
    )
)  # fmt: skip
def judge_flips(  # type: ignore[no-untyped-def]
    active, kind, creased, frozen, at_faces, sides, faces, rest, tensors, frames, normals, margin, longest,
    well_shaped, quads, excess,
):  # fmt: skip
    """Write by how much edges bc should flip; minus infinity where they should not, or must not.

    `active` are the edges that are looked at, shape (k,); the corners a, b, c, d of their faces abc and dcb
    are written to `quads` (k, 4). A flip is worth it where the sine exceeds `margin`; it must make neither an
    edge longer than `longest` in the metric, unless bc is longer, nor a triangle worse than `well_shaped`,
    unless one was worse before, nor one upside down. Borders, seams, creases and frozen edges do not flip.
    """
    for i in range(len(active)):
        edge = active[i]
        excess[i] = -np.inf
        if kind[edge] != INNER or creased[edge] or frozen[edge]:
            continue
        t, u = at_faces[edge, 0], at_faces[edge, 1]
        k, j = sides[edge, 0], sides[edge, 1]
        a, b, c, d = faces[t, k], faces[t, (k + 1) % 3], faces[t, (k + 2) % 3], faces[u, j]
        quads[i, 0], quads[i, 1], quads[i, 2], quads[i, 3] = a, b, c, d
        value = delaunay_excess(rest, tensors, frames, t, a, b, c, d)
        if not value > margin:
            continue
        limit = max(longest * longest, squared_length(rest, tensors, b, c))
        if squared_length(rest, tensors, a, d) > limit:
            continue
        if not (twice_area(rest, normals, t, a, b, d) > 0.0 and twice_area(rest, normals, t, a, d, c) > 0.0):
            continue
        new = min(aspect(rest, tensors, a, b, d), aspect(rest, tensors, a, d, c))
        old = min(
            aspect(rest, tensors, faces[t, 0], faces[t, 1], faces[t, 2]),
            aspect(rest, tensors, faces[u, 0], faces[u, 1], faces[u, 2]),
        )
        if new > 0.0 and new >= min(well_shaped, old):
            excess[i] = value
