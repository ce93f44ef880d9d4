"""Symmetric block Gauss-Seidel: M = (D + L) D^-1 (D + L^T), one forward and one backward sweep.

D is A's block diagonal, L its strictly lower part inside the element pattern and of contacts, in reverse
Cuthill-McKee order of the pattern. M is positive definite whenever D is, which an incomplete Cholesky
factor is not: on stiff cloth IC(0) met indefinite pivots in 1 row of 40.
"""

import numpy as np
from numba import types
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from toile.engine.assembly import BlockPattern
from toile.engine.linear_system import LinearSystem
from toile.engine.preconditioner.block_jacobi import invert_blocks
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import (
    F64_2,
    F64_3,
    I32_1,
    OUT_F64_2,
    OUT_F64_3,
    kernel,
    unsigned,
)


class SymmetricGaussSeidel:
    """One symmetric sweep, for one topology.

    Attributes
    ----------
    order
        Nodes in the order of the forward sweep, shape (node_count,).
    """

    def __init__(self, pattern: BlockPattern) -> None:
        count = pattern.node_count
        graph = csr_array(
            (np.ones(pattern.slot_count), pattern.indices, pattern.indptr), shape=(count, count)
        )
        self.order: Int = np.ascontiguousarray(
            reverse_cuthill_mckee(graph, symmetric_mode=True), dtype=np.int32
        )
        rank = np.empty(count, np.int32)
        rank[self.order] = np.arange(count, dtype=np.int32)
        self._rank: Int = rank
        rows = rank[np.repeat(np.arange(count), np.diff(pattern.indptr))]
        columns = rank[pattern.indices]
        lower = np.flatnonzero(columns < rows)
        lower = lower[np.lexsort((columns[lower], rows[lower]))]
        self._slots: Int = lower.astype(np.int32)
        self._indices: Int = columns[lower]
        self._indptr: Int = np.searchsorted(rows[lower], np.arange(count + 1)).astype(np.int32)
        self._lower: Float = np.zeros((len(lower), 3, 3))
        self._inverses: Float = np.zeros((count, 3, 3))
        self._work: Float = np.zeros((count, 3))
        self._sums: Float = np.zeros((count, 3))
        self._far_indptr: Int = np.zeros(count + 1, np.int32)
        self._far_indices: Int = np.zeros(0, np.int32)
        self._far_blocks: Float = np.zeros((0, 3, 3))

    def update(self, system: LinearSystem, positions: Float) -> None:
        """Copy the lower triangle in sweep order and invert the diagonal; positions are not used."""
        self._inverses = system.diagonal_blocks()[self.order]
        invert_blocks(self._inverses)
        _gather_blocks(self._slots, system.blocks, self._lower)
        self._couple(system)

    def _couple(self, system: LinearSystem) -> None:
        """List what contacts outside the pattern add to L, by row."""
        nodes, weights, stiffness = system.contacts
        first, second = np.tril_indices(4, -1)
        weight = weights[:, first] * weights[:, second]
        used = (nodes[:, first] >= 0) & (nodes[:, second] >= 0) & (weight != 0.0)
        ranks = self._rank[nodes[:, [first, second]]]
        rows = ranks.max(axis=1)[used]
        # Stable: what a row adds up does not depend on the machine.
        by_row = np.argsort(rows, kind="stable")
        self._far_indptr = np.searchsorted(rows[by_row], np.arange(len(self.order) + 1)).astype(np.int32)
        self._far_indices = ranks.min(axis=1)[used][by_row]
        contact = np.nonzero(used)[0][by_row]
        self._far_blocks = weight[used][by_row][:, None, None] * stiffness[contact]

    def apply(self, residual: Float, out: Float) -> float:
        """Write M^-1 residual into `out` and return residual . out; shapes (node_count, 3)."""
        product: float = _sweep(
            self.order,
            self._indptr,
            self._indices,
            self._lower,
            self._far_indptr,
            self._far_indices,
            self._far_blocks,
            self._inverses,
            residual,
            self._work,
            self._sums,
            out,
        )
        return product

    def correct(self, residual: Float, correction: Float) -> bool:
        """Return False: no part is solved exactly."""
        return False


@kernel(types.void(I32_1, F64_3, OUT_F64_3))
def _gather_blocks(slots: Int, source: Float, target: Float) -> None:
    for k in range(slots.shape[0]):
        s = slots[k]
        for r in range(3):
            for c in range(3):
                target[k, r, c] = source[s, r, c]


@kernel(
    types.float64(
        I32_1, I32_1, I32_1, F64_3, I32_1, I32_1, F64_3, F64_3, F64_2, OUT_F64_2, OUT_F64_2, OUT_F64_2
    )
)
def _sweep(
    order: Int,
    indptr: Int,
    indices: Int,
    lower: Float,
    far_indptr: Int,
    far_indices: Int,
    far_blocks: Float,
    inverses: Float,
    residual: Float,
    work: Float,
    sums: Float,
    out: Float,
) -> float:
    for o in range(order.shape[0]):
        i = unsigned(order[o])
        r0 = residual[i, 0]
        r1 = residual[i, 1]
        r2 = residual[i, 2]
        for k in range(unsigned(indptr[o]), unsigned(indptr[o + 1])):
            j = unsigned(indices[k])
            x0 = work[j, 0]
            x1 = work[j, 1]
            x2 = work[j, 2]
            r0 -= lower[k, 0, 0] * x0 + lower[k, 0, 1] * x1 + lower[k, 0, 2] * x2
            r1 -= lower[k, 1, 0] * x0 + lower[k, 1, 1] * x1 + lower[k, 1, 2] * x2
            r2 -= lower[k, 2, 0] * x0 + lower[k, 2, 1] * x1 + lower[k, 2, 2] * x2
        for k in range(unsigned(far_indptr[o]), unsigned(far_indptr[o + 1])):
            j = unsigned(far_indices[k])
            x0 = work[j, 0]
            x1 = work[j, 1]
            x2 = work[j, 2]
            r0 -= far_blocks[k, 0, 0] * x0 + far_blocks[k, 0, 1] * x1 + far_blocks[k, 0, 2] * x2
            r1 -= far_blocks[k, 1, 0] * x0 + far_blocks[k, 1, 1] * x1 + far_blocks[k, 1, 2] * x2
            r2 -= far_blocks[k, 2, 0] * x0 + far_blocks[k, 2, 1] * x1 + far_blocks[k, 2, 2] * x2
        work[o, 0] = inverses[o, 0, 0] * r0 + inverses[o, 0, 1] * r1 + inverses[o, 0, 2] * r2
        work[o, 1] = inverses[o, 1, 0] * r0 + inverses[o, 1, 1] * r1 + inverses[o, 1, 2] * r2
        work[o, 2] = inverses[o, 2, 0] * r0 + inverses[o, 2, 1] * r1 + inverses[o, 2, 2] * r2
        sums[o, 0] = 0.0
        sums[o, 1] = 0.0
        sums[o, 2] = 0.0
    product = 0.0
    for o in range(order.shape[0] - 1, -1, -1):
        s0 = sums[o, 0]
        s1 = sums[o, 1]
        s2 = sums[o, 2]
        z0 = work[o, 0] - (inverses[o, 0, 0] * s0 + inverses[o, 0, 1] * s1 + inverses[o, 0, 2] * s2)
        z1 = work[o, 1] - (inverses[o, 1, 0] * s0 + inverses[o, 1, 1] * s1 + inverses[o, 1, 2] * s2)
        z2 = work[o, 2] - (inverses[o, 2, 0] * s0 + inverses[o, 2, 1] * s1 + inverses[o, 2, 2] * s2)
        for k in range(unsigned(indptr[o]), unsigned(indptr[o + 1])):
            j = unsigned(indices[k])
            sums[j, 0] += lower[k, 0, 0] * z0 + lower[k, 1, 0] * z1 + lower[k, 2, 0] * z2
            sums[j, 1] += lower[k, 0, 1] * z0 + lower[k, 1, 1] * z1 + lower[k, 2, 1] * z2
            sums[j, 2] += lower[k, 0, 2] * z0 + lower[k, 1, 2] * z1 + lower[k, 2, 2] * z2
        for k in range(unsigned(far_indptr[o]), unsigned(far_indptr[o + 1])):
            j = unsigned(far_indices[k])
            sums[j, 0] += far_blocks[k, 0, 0] * z0 + far_blocks[k, 1, 0] * z1 + far_blocks[k, 2, 0] * z2
            sums[j, 1] += far_blocks[k, 0, 1] * z0 + far_blocks[k, 1, 1] * z1 + far_blocks[k, 2, 1] * z2
            sums[j, 2] += far_blocks[k, 0, 2] * z0 + far_blocks[k, 1, 2] * z1 + far_blocks[k, 2, 2] * z2
        i = unsigned(order[o])
        out[i, 0] = z0
        out[i, 1] = z1
        out[i, 2] = z2
        product += residual[i, 0] * z0 + residual[i, 1] * z1 + residual[i, 2] * z2
    return product
