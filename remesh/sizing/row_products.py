"""Products of vectors that are rows of arrays.

Column by column: about three times faster than `np.cross` or a sum along rows of three.
"""

import numpy as np

from toile.geometry.arrays import Float


def row_dot(a: Float, b: Float) -> Float:
    """Return a . b of vectors (n, 3), shape (n,)."""
    return np.asarray(a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2])


def row_cross(a: Float, b: Float) -> Float:
    """Return a x b of vectors (n, 3), shape (n, 3)."""
    (ax, ay, az), (bx, by, bz) = a.T, b.T
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)
