"""Kernels that check whether a list of candidates is complete for given positions."""

from typing import NamedTuple

import numpy as np
from numba import types

from toile.geometry.arrays import Float
from toile.geometry.kernel import F64_1, F64_2, OUT_F64_1, kernel

STILL = np.zeros((0, 3))
FAST = 0.25
"""Nodes whose drift squared is at least this share of the largest tell how far all have drifted."""


class Cover(NamedTuple):
    """For which places candidates are complete.

    Nodes may be `allowed` [m], shape (n,), away from `origin` [m], shape (n, 3), or from places that `drift`
    [m] away from there, all at the same pace. Those from number `leaders` on tell how far they have drifted.
    """

    origin: Float
    allowed: Float
    drift: Float | None
    leaders: int = 0

    def allowance(self, x: Float) -> Float:
        """How far nodes may still move from x [m], shape (n,)."""
        left = np.empty(len(x))
        _allowance(
            x, self.origin, STILL if self.drift is None else self.drift, self.allowed, self.leaders, left
        )
        return left


@kernel(types.void(F64_2, F64_2, F64_2, F64_1, types.int64, OUT_F64_1))
def _allowance(x, origin, drift, allowed, leaders, left):  # type: ignore[no-untyped-def]
    """Write how far nodes may still move from x.

    Any common share of the drift is valid: the one that brings fast nodes nearest to where they are leaves
    the least to their allowance.
    """
    largest = 0.0
    for i in range(leaders, drift.shape[0]):
        largest = max(largest, drift[i, 0] ** 2 + drift[i, 1] ** 2 + drift[i, 2] ** 2)
    done, whole = 0.0, 0.0
    if largest > 0.0:
        for i in range(leaders, drift.shape[0]):
            square = drift[i, 0] ** 2 + drift[i, 1] ** 2 + drift[i, 2] ** 2
            if square >= FAST * largest:
                whole += square
                for axis in range(3):
                    done += (x[i, axis] - origin[i, axis]) * drift[i, axis]
        done = min(max(done / whole, 0.0), 1.0)
    for i in range(x.shape[0]):
        square = 0.0
        for axis in range(3):
            away = x[i, axis] - origin[i, axis]
            if largest > 0.0:
                away -= done * drift[i, axis]
            square += away * away
        left[i] = allowed[i] - np.sqrt(square)
