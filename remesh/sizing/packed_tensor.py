"""Symmetric 3x3 tensors as six numbers: xx, yy, zz, yz, zx, xy."""

import numpy as np

from toile.geometry.arrays import Float


def packed(tensors: Float) -> Float:
    """Return symmetric (n, 3, 3) as (n, 6)."""
    return np.ascontiguousarray(tensors[:, [0, 1, 2, 1, 2, 0], [0, 1, 2, 2, 0, 1]])


def unpacked(six: Float) -> Float:
    """Return (n, 6) as symmetric (n, 3, 3)."""
    return np.ascontiguousarray(six[:, [0, 5, 4, 5, 1, 3, 4, 3, 2]].reshape(-1, 3, 3))


def lifted(frames: Float, plane: Float) -> Float:
    """Return plane tensors (n, 2, 2), given in directions `frames` (n, 3, 2), packed in space, (n, 6)."""
    warp, weft = frames.transpose(2, 0, 1)
    xx, yy, xy = plane[:, 0, 0], plane[:, 1, 1], plane[:, 0, 1]
    six = np.empty((len(plane), 6))
    for entry, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))):
        mixed = warp[:, i] * weft[:, j] + weft[:, i] * warp[:, j]
        six[:, entry] = xx * warp[:, i] * warp[:, j] + yy * weft[:, i] * weft[:, j] + xy * mixed
    return six


def in_plane(frames: Float, six: Float) -> Float:
    """Return packed tensors (n, 6) in directions `frames` (n, 3, 2), shape (n, 2, 2)."""
    warp, weft = frames.transpose(2, 0, 1)
    plane = np.empty((len(six), 2, 2))
    plane[:, 0, 0], plane[:, 1, 1] = inner_product(six, warp, warp), inner_product(six, weft, weft)
    plane[:, 0, 1] = plane[:, 1, 0] = inner_product(six, warp, weft)
    return plane


def inner_product(six: Float, a: Float, b: Float) -> Float:
    """Return a . M b of packed tensors (n, 6) and vectors (n, 3), shape (n,)."""
    (ax, ay, az), (bx, by, bz) = a.T, b.T
    xx, yy, zz, yz, zx, xy = six.T
    straight = xx * ax * bx + yy * ay * by + zz * az * bz
    mixed = yz * (ay * bz + az * by) + zx * (az * bx + ax * bz) + xy * (ax * by + ay * bx)
    return np.asarray(straight + mixed)
