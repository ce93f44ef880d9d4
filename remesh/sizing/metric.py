"""Lengths and shapes in a metric, for kernels: tensors are packed as xx, yy, zz, yz, zx, xy."""

import math

from toile.geometry.kernel import helper


@helper
def squared_length(rest, tensors, p, q):  # type: ignore[no-untyped-def]
    """Squared length of the edge from material vertex p to q in the mean metric of both."""
    x, y, z = rest[q, 0] - rest[p, 0], rest[q, 1] - rest[p, 1], rest[q, 2] - rest[p, 2]
    xx, yy, zz = tensors[p, 0] + tensors[q, 0], tensors[p, 1] + tensors[q, 1], tensors[p, 2] + tensors[q, 2]
    yz, zx, xy = tensors[p, 3] + tensors[q, 3], tensors[p, 4] + tensors[q, 4], tensors[p, 5] + tensors[q, 5]
    return 0.5 * (xx * x * x + yy * y * y + zz * z * z) + yz * y * z + zx * z * x + xy * x * y


@helper
def twice_area(rest, normals, t, a, b, c):  # type: ignore[no-untyped-def]
    """Twice the area of triangle abc in rest space about the normal of face t, negative upside down."""
    ux, uy, uz = rest[b, 0] - rest[a, 0], rest[b, 1] - rest[a, 1], rest[b, 2] - rest[a, 2]
    vx, vy, vz = rest[c, 0] - rest[a, 0], rest[c, 1] - rest[a, 1], rest[c, 2] - rest[a, 2]
    return (
        normals[t, 0] * (uy * vz - uz * vy)
        + normals[t, 1] * (uz * vx - ux * vz)
        + normals[t, 2] * (ux * vy - uy * vx)
    )


@helper
def product(xx, yy, zz, yz, zx, xy, ax, ay, az, bx, by, bz):  # type: ignore[no-untyped-def]
    """Inner product of two vectors in a metric."""
    straight = xx * ax * bx + yy * ay * by + zz * az * bz
    return straight + yz * (ay * bz + az * by) + zx * (az * bx + ax * bz) + xy * (ax * by + ay * bx)


@helper
def aspect(rest, tensors, a, b, c):  # type: ignore[no-untyped-def]
    """Shape of a triangle in the mean metric of its corners: 1 if equilateral, 0 if flat."""
    third = 1.0 / 3.0
    xx = (tensors[a, 0] + tensors[b, 0] + tensors[c, 0]) * third
    yy = (tensors[a, 1] + tensors[b, 1] + tensors[c, 1]) * third
    zz = (tensors[a, 2] + tensors[b, 2] + tensors[c, 2]) * third
    yz = (tensors[a, 3] + tensors[b, 3] + tensors[c, 3]) * third
    zx = (tensors[a, 4] + tensors[b, 4] + tensors[c, 4]) * third
    xy = (tensors[a, 5] + tensors[b, 5] + tensors[c, 5]) * third
    ux, uy, uz = rest[b, 0] - rest[a, 0], rest[b, 1] - rest[a, 1], rest[b, 2] - rest[a, 2]
    vx, vy, vz = rest[c, 0] - rest[a, 0], rest[c, 1] - rest[a, 1], rest[c, 2] - rest[a, 2]
    uu = product(xx, yy, zz, yz, zx, xy, ux, uy, uz, ux, uy, uz)
    vv = product(xx, yy, zz, yz, zx, xy, vx, vy, vz, vx, vy, vz)
    uv = product(xx, yy, zz, yz, zx, xy, ux, uy, uz, vx, vy, vz)
    area = 0.5 * math.sqrt(max(uu * vv - uv * uv, 0.0))
    perimeter = math.sqrt(uu) + math.sqrt(vv) + math.sqrt(max(uu + vv - 2.0 * uv, 0.0))
    return 20.784609690826528 * area / max(perimeter * perimeter, 1e-300)
