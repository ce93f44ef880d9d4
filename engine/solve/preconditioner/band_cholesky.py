"""Cholesky factor of a symmetric positive definite band matrix made of 6x6 blocks.

Own loops instead of LAPACK's dpbtrf: as fast at these sizes (bandwidth 50 to 250), and neither the time nor
the last bits depend on how many threads a BLAS library decides to use. The lower triangle is stored by
columns: entry (row, column) is band[column, row - column]; the band is a whole number of blocks wide.
"""

import math

from numba import types

from toile.geometry.arrays import Float
from toile.geometry.kernel import F64_2, OUT_F64_1, OUT_F64_2, kernel, packed_kernel, unsigned


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
        done0 = band[first]
        done1 = band[first + 1]
        done2 = band[first + 2]
        done3 = band[first + 3]
        done4 = band[first + 4]
        done5 = band[first + 5]
        for q in range(first + 6, end):
            # Where row q stands in the six columns.
            at0 = unsigned(q - first)
            at1 = unsigned(q - first - 1)
            at2 = unsigned(q - first - 2)
            at3 = unsigned(q - first - 3)
            at4 = unsigned(q - first - 4)
            at5 = unsigned(q - first - 5)
            f0 = done0[at0]
            f1 = done1[at1]
            f2 = done2[at2]
            f3 = done3[at3]
            f4 = done4[at4]
            f5 = done5[at5]
            column = band[q]
            for k in range(unsigned(end - q)):
                column[k] -= (
                    f0 * done0[at0 + k]
                    + f1 * done1[at1 + k]
                    + f2 * done2[at2 + k]
                    + f3 * done3[at3 + k]
                    + f4 * done4[at4 + k]
                    + f5 * done5[at5 + k]
                )
    return -1


@packed_kernel(types.void(F64_2, OUT_F64_1))
def substitute(band: Float, vector: Float) -> None:
    """Overwrite the right-hand side b, shape (6 n,), with the solution of L L^T x = b."""
    size = band.shape[0]
    width = band.shape[1] - 6
    for j in range(size):
        column = band[j]
        rest = vector[j:]
        value = rest[0] / column[0]
        rest[0] = value
        end = min(size, j - j % 6 + 6 + width)
        for k in range(unsigned(1), unsigned(end - j)):
            rest[k] -= value * column[k]
    for j in range(size - 1, -1, -1):
        column = band[j]
        rest = vector[j:]
        count = min(size, j - j % 6 + 6 + width) - j
        # four sums: one would wait for its own previous addition
        sum0 = 0.0
        sum1 = 0.0
        sum2 = 0.0
        sum3 = 0.0
        fours = unsigned((count - 1) // 4)
        for four in range(fours):
            at = unsigned(4) * four
            sum0 += column[at + unsigned(1)] * rest[at + unsigned(1)]
            sum1 += column[at + unsigned(2)] * rest[at + unsigned(2)]
            sum2 += column[at + unsigned(3)] * rest[at + unsigned(3)]
            sum3 += column[at + unsigned(4)] * rest[at + unsigned(4)]
        for k in range(unsigned(4) * fours + unsigned(1), unsigned(count)):
            sum0 += column[k] * rest[k]
        rest[0] = (rest[0] - ((sum0 + sum1) + (sum2 + sum3))) / column[0]
