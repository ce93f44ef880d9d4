"""Symmetric block Gauss-Seidel: M = (D + L) D^-1 (D + L^T), one forward and one backward sweep.

D is A's block diagonal, L its strictly lower part inside the element pattern and of contacts, in the order
of the pattern. M is positive definite whenever D is, which an incomplete Cholesky
factor is not: on stiff cloth IC(0) met indefinite pivots in 1 row of 40.
"""

import numpy as np
from numba import types

from toile.engine.solve.block_pattern import BlockPattern
from toile.engine.solve.block_rows import block_rows, plus_columns
from toile.engine.solve.linear_system import LinearSystem
from toile.engine.solve.preconditioner.block_jacobi import invert_blocks
from toile.geometry.arrays import Float, Int
from toile.geometry.fours import four_at, four_times, put_four, three_of
from toile.geometry.kernel import F64_1, F64_2, F64_3, I32_1, OUT_F64_1, OUT_F64_2, helper, kernel, unsigned

ONE, TWO, THREE, FOUR, FIVE, SIX, SEVEN, EIGHT, NINE = (unsigned(number) for number in range(1, 10))


class SymmetricGaussSeidel:
    """One symmetric sweep, for one topology, in the order of the pattern's ranks."""

    def __init__(self, pattern: BlockPattern) -> None:
        count = pattern.node_count
        self._pattern = pattern
        self._lower: Float = np.zeros((0, 3, 3))
        self._inverses: Float = np.zeros((count, 3, 3))
        self._sums: Float = np.zeros((count, 4))
        self._far_indptr: Int = np.zeros(count + 1, np.int32)
        self._far_indices: Int = np.zeros(0, np.int32)
        self._far_blocks: Float = np.zeros((0, 3, 3))

    def update(self, system: LinearSystem, positions: Float) -> None:
        """Borrow the lower triangle and invert the diagonal; positions are not used."""
        self._lower = self._pattern.lower(system.lend_blocks())
        self._inverses = system.diagonal_blocks()
        invert_blocks(self._inverses)
        self._couple(system)

    def _couple(self, system: LinearSystem) -> None:
        """List what contacts outside the pattern add to L, by row."""
        nodes, weights, stiffness = system.contacts
        first, second = np.tril_indices(4, -1)
        weight = weights[:, first] * weights[:, second]
        used = (nodes[:, first] >= 0) & (nodes[:, second] >= 0) & (weight != 0.0)
        ranks = nodes[:, [first, second]]
        rows = ranks.max(axis=1)[used]
        # Stable: what a row adds up does not depend on the machine.
        by_row = np.argsort(rows, kind="stable")
        self._far_indptr = np.searchsorted(rows[by_row], np.arange(len(self._inverses) + 1)).astype(np.int32)
        self._far_indices = ranks.min(axis=1)[used][by_row]
        contact = np.nonzero(used)[0][by_row]
        self._far_blocks = weight[used][by_row][:, None, None] * stiffness[contact]

    def apply(self, residual: Float, out: Float) -> float:
        """Write M^-1 residual into `out` and return residual . out; shapes (node_count, 3)."""
        product: float = _sweep(
            self._pattern.lower_indptr,
            self._pattern.lower_ranks,
            self._lower.reshape(-1),
            self._far_indptr,
            self._far_indices,
            self._far_blocks.reshape(-1),
            self._inverses,
            residual,
            self._sums.reshape(-1),
            out,
        )
        return product

    def correct(self, residual: Float, correction: Float) -> bool:
        """Return False: no part is solved exactly."""
        return False


@helper
def _row_times(blocks, k, x, j):  # type: ignore[no-untyped-def]
    """Product of a block and the numbers of row j of x, (n, 3)."""
    at = NINE * k
    x0, x1, x2 = x[j, 0], x[j, 1], x[j, 2]
    return (
        blocks[at] * x0 + blocks[at + ONE] * x1 + blocks[at + TWO] * x2,
        blocks[at + THREE] * x0 + blocks[at + FOUR] * x1 + blocks[at + FIVE] * x2,
        blocks[at + SIX] * x0 + blocks[at + SEVEN] * x1 + blocks[at + EIGHT] * x2,
    )


@helper
def _add_to_column(sums, j, blocks, k, numbers):  # type: ignore[no-untyped-def]
    """Add the transpose of a block, times three numbers that come as four each, to the sums of column j."""
    put_four(sums, FOUR * j, plus_columns(four_at(sums, FOUR * j), block_rows(blocks, k), numbers))


@kernel(types.float64(I32_1, I32_1, F64_1, I32_1, I32_1, F64_1, F64_3, F64_2, OUT_F64_1, OUT_F64_2))
def _sweep(
    indptr: Int,
    indices: Int,
    lower: Float,
    far_indptr: Int,
    far_indices: Int,
    far_blocks: Float,
    inverses: Float,
    residual: Float,
    sums: Float,
    out: Float,
) -> float:
    count, has_far = residual.shape[0], far_indices.shape[0] > 0
    for row in range(count):
        o = unsigned(row)
        r0 = residual[o, 0]
        r1 = residual[o, 1]
        r2 = residual[o, 2]
        for k in range(unsigned(indptr[o]), unsigned(indptr[o + ONE])):
            x, y, z = _row_times(lower, k, out, unsigned(indices[k]))
            r0 -= x
            r1 -= y
            r2 -= z
        if has_far:
            for k in range(unsigned(far_indptr[o]), unsigned(far_indptr[o + ONE])):
                x, y, z = _row_times(far_blocks, k, out, unsigned(far_indices[k]))
                r0 -= x
                r1 -= y
                r2 -= z
        out[o, 0] = inverses[o, 0, 0] * r0 + inverses[o, 0, 1] * r1 + inverses[o, 0, 2] * r2
        out[o, 1] = inverses[o, 1, 0] * r0 + inverses[o, 1, 1] * r1 + inverses[o, 1, 2] * r2
        out[o, 2] = inverses[o, 2, 0] * r0 + inverses[o, 2, 1] * r1 + inverses[o, 2, 2] * r2
        put_four(sums, FOUR * o, four_times(0.0))
    product = 0.0
    for row in range(count - 1, -1, -1):
        o = unsigned(row)
        s0, s1, s2 = three_of(four_at(sums, FOUR * o))
        z0 = out[o, 0] - (inverses[o, 0, 0] * s0 + inverses[o, 0, 1] * s1 + inverses[o, 0, 2] * s2)
        z1 = out[o, 1] - (inverses[o, 1, 0] * s0 + inverses[o, 1, 1] * s1 + inverses[o, 1, 2] * s2)
        z2 = out[o, 2] - (inverses[o, 2, 0] * s0 + inverses[o, 2, 1] * s1 + inverses[o, 2, 2] * s2)
        numbers = four_times(z0), four_times(z1), four_times(z2)
        for k in range(unsigned(indptr[o]), unsigned(indptr[o + ONE])):
            _add_to_column(sums, unsigned(indices[k]), lower, k, numbers)
        if has_far:
            for k in range(unsigned(far_indptr[o]), unsigned(far_indptr[o + ONE])):
                _add_to_column(sums, unsigned(far_indices[k]), far_blocks, k, numbers)
        out[o, 0] = z0
        out[o, 1] = z1
        out[o, 2] = z2
        product += residual[o, 0] * z0 + residual[o, 1] * z1 + residual[o, 2] * z2
    return product
