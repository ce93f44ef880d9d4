"""Block Jacobi: the inverse of each node's 3x3 diagonal block."""

import numpy as np
from numba import types

from toile.engine.solve.linear_system import LinearSystem
from toile.geometry.arrays import Float
from toile.geometry.kernel import F64_2, F64_3, OUT_F64_2, OUT_F64_3, kernel


class BlockJacobi:
    """Inverse diagonal blocks. Costs next to nothing to set up."""

    def __init__(self) -> None:
        self._inverses: Float = np.zeros((0, 3, 3))

    def update(self, system: LinearSystem, positions: Float) -> None:
        """Invert the diagonal blocks of `system`; positions are not used."""
        self._inverses = system.diagonal_blocks()
        invert_blocks(self._inverses)

    def apply(self, residual: Float, out: Float) -> float:
        """Write M^-1 residual into `out` and return residual . out; shapes (node_count, 3)."""
        product: float = _multiply_diagonal(self._inverses, residual, out)
        return product

    def correct(self, residual: Float, correction: Float) -> bool:
        """Return False: no part is solved exactly."""
        return False


@kernel(types.void(OUT_F64_3))
def invert_blocks(blocks: Float) -> None:
    """Invert symmetric positive definite 3x3 blocks in place, shape (n, 3, 3)."""
    for i in range(blocks.shape[0]):
        a = blocks[i, 0, 0]
        b = blocks[i, 0, 1]
        c = blocks[i, 0, 2]
        d = blocks[i, 1, 1]
        e = blocks[i, 1, 2]
        f = blocks[i, 2, 2]
        # L D L^T instead of the adjugate: a block may mix 3000 N/m in the cloth's plane with 0.01 N/m
        # across it, and the determinant would then lose all digits of the soft direction.
        l10 = b / a
        l20 = c / a
        d1 = d - l10 * b
        m = e - l10 * c
        l21 = m / d1
        d2 = f - l20 * c - l21 * m
        u20 = l10 * l21 - l20
        blocks[i, 2, 2] = 1.0 / d2
        blocks[i, 1, 2] = blocks[i, 2, 1] = -l21 / d2
        blocks[i, 0, 2] = blocks[i, 2, 0] = u20 / d2
        blocks[i, 1, 1] = 1.0 / d1 + l21 * l21 / d2
        blocks[i, 0, 1] = blocks[i, 1, 0] = -l10 / d1 - l21 * u20 / d2
        blocks[i, 0, 0] = 1.0 / a + l10 * l10 / d1 + u20 * u20 / d2


@kernel(types.float64(F64_3, F64_2, OUT_F64_2))
def _multiply_diagonal(inverses: Float, residual: Float, out: Float) -> float:
    product = 0.0
    for i in range(residual.shape[0]):
        r0 = residual[i, 0]
        r1 = residual[i, 1]
        r2 = residual[i, 2]
        z0 = inverses[i, 0, 0] * r0 + inverses[i, 0, 1] * r1 + inverses[i, 0, 2] * r2
        z1 = inverses[i, 1, 0] * r0 + inverses[i, 1, 1] * r1 + inverses[i, 1, 2] * r2
        z2 = inverses[i, 2, 0] * r0 + inverses[i, 2, 1] * r1 + inverses[i, 2, 2] * r2
        out[i, 0] = z0
        out[i, 1] = z1
        out[i, 2] = z2
        product += r0 * z0 + r1 * z1 + r2 * z2
    return product
