"""Greedy choice of changes that do not share a face."""

import numpy as np
from numba import types

from toile.geometry.arrays import Bool, Int
from toile.geometry.kernel import I32_2, OUT_BOOL_1, kernel


def first_disjoint(face_pairs: Int, face_count: int) -> Bool:
    """Take pairs of faces (p, 2) in order, leaving out any that shares a face with one taken; shape (p,).

    -1 stands for no face.
    """
    taken = np.zeros(len(face_pairs), bool)
    _take_disjoint(np.ascontiguousarray(face_pairs), np.zeros(face_count, bool), taken)
    return taken


@kernel(types.void(I32_2, OUT_BOOL_1, OUT_BOOL_1))
def _take_disjoint(face_pairs, used, taken):  # type: ignore[no-untyped-def]
    """Mark `taken`; `used` is work space per face, all False."""
    for p in range(len(face_pairs)):
        t, u = face_pairs[p, 0], face_pairs[p, 1]
        if (t >= 0 and used[t]) or (u >= 0 and used[u]):
            continue
        taken[p] = True
        if t >= 0:
            used[t] = True
        if u >= 0:
            used[u] = True
