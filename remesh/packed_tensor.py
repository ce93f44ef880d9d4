"""Symmetric 3x3 tensors as six numbers: xx, yy, zz, yz, zx, xy."""

import numpy as np

from toile.geometry.arrays import Float


def packed(tensors: Float) -> Float:
    """Return symmetric (n, 3, 3) as (n, 6)."""
    return np.ascontiguousarray(tensors[:, [0, 1, 2, 1, 2, 0], [0, 1, 2, 2, 0, 1]])


def unpacked(six: Float) -> Float:
    """Return (n, 6) as symmetric (n, 3, 3)."""
    return np.ascontiguousarray(six[:, [0, 5, 4, 5, 1, 3, 4, 3, 2]].reshape(-1, 3, 3))


def inner_product(six: Float, a: Float, b: Float) -> Float:
    """Return a . M b of packed tensors (n, 6) and vectors (n, 3), shape (n,)."""
    (ax, ay, az), (bx, by, bz) = a.T, b.T
    xx, yy, zz, yz, zx, xy = six.T
    straight = xx * ax * bx + yy * ay * by + zz * az * bz
    mixed = yz * (ay * bz + az * by) + zx * (az * bx + ax * bz) + xy * (ax * by + ay * bx)
    return np.asarray(straight + mixed)
