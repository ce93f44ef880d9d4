"""Cholesky factor of a symmetric positive definite band matrix made of 6x6 blocks.

Own loops instead of LAPACK's dpbtrf: as fast at these sizes (bandwidth 50 to 250), and neither the time nor
the last bits depend on how many threads a BLAS library decides to use. The lower triangle is stored by
columns: entry (row, column) is band[column, row - column]; the band is a whole number of blocks wide.
"""

import math

from numba import types

from toile.geometry.arrays import Float
from toile.geometry.kernel import F64_2, OUT_F64_1, OUT_F64_2, kernel


@kernel(types.int64(OUT_F64_2))
def factorise(band: Float) -> int:
    """Overwrite A with its factor L, shape (6 n, 6 width + 6). Return -1, or the column that failed.

    Right-looking, six columns at a time, so that each later column is read and written once per block.
    """
    size = band.shape[0]
    width = band.shape[1] - 6
    for first in range(0, size, 6):
        end = min(size, first + 6 + width)
        for b in range(6):
            j = first + b
            pivot = band[j, 0]
            if not pivot > 0.0:
                return j
            root = math.sqrt(pivot)
            inverse = 1.0 / root
            band[j, 0] = root
            for k in range(1, end - j):
                band[j, k] *= inverse
            for q in range(j + 1, first + 6):
                factor = band[j, q - j]
                for k in range(end - q):
                    band[q, k] -= factor * band[j, q - j + k]
        for q in range(first + 6, end):
            s = q - first
            f0 = band[first, s]
            f1 = band[first + 1, s - 1]
            f2 = band[first + 2, s - 2]
            f3 = band[first + 3, s - 3]
            f4 = band[first + 4, s - 4]
            f5 = band[first + 5, s - 5]
            for k in range(end - q):
                band[q, k] -= (
                    f0 * band[first, s + k]
                    + f1 * band[first + 1, s - 1 + k]
                    + f2 * band[first + 2, s - 2 + k]
                    + f3 * band[first + 3, s - 3 + k]
                    + f4 * band[first + 4, s - 4 + k]
                    + f5 * band[first + 5, s - 5 + k]
                )
    return -1


@kernel(types.void(F64_2, OUT_F64_1))
def substitute(band: Float, vector: Float) -> None:
    """Overwrite the right-hand side b, shape (6 n,), with the solution of L L^T x = b."""
    size = band.shape[0]
    width = band.shape[1] - 6
    for j in range(size):
        value = vector[j] / band[j, 0]
        vector[j] = value
        end = min(size, j - j % 6 + 6 + width)
        for k in range(1, end - j):
            vector[j + k] -= value * band[j, k]
    for j in range(size - 1, -1, -1):
        end = min(size, j - j % 6 + 6 + width)
        # four sums: one would wait for its own previous addition
        sum0 = 0.0
        sum1 = 0.0
        sum2 = 0.0
        sum3 = 0.0
        k = 1
        while k + 3 < end - j:
            sum0 += band[j, k] * vector[j + k]
            sum1 += band[j, k + 1] * vector[j + k + 1]
            sum2 += band[j, k + 2] * vector[j + k + 2]
            sum3 += band[j, k + 3] * vector[j + k + 3]
            k += 4
        while k < end - j:
            sum0 += band[j, k] * vector[j + k]
            k += 1
        vector[j] = (vector[j] - ((sum0 + sum1) + (sum2 + sum3))) / band[j, 0]
