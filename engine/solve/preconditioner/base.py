"""The protocol of a preconditioner."""

from typing import Protocol

from toile.engine.solve.linear_system import LinearSystem
from toile.geometry.arrays import Float


class Preconditioner(Protocol):
    """A symmetric positive definite approximation of the inverse of A.

    It may ask for residuals free of what `correct` removes, and need be symmetric on those only. Its vectors
    are by rank, as those of the system.
    """

    def update(self, system: LinearSystem, positions: Float) -> None:
        """Follow new numbers in `system`; positions: node positions [m], by node, shape (node_count, 3)."""

    def apply(self, residual: Float, out: Float) -> float:
        """Write M^-1 residual into `out` and return residual . out; shapes (node_count, 3)."""

    def correct(self, residual: Float, correction: Float) -> bool:
        """Write into `correction` what removes from the residual all that this one solves exactly.

        Return False, and write nothing, if there is no such part. Once removed, it stays removed.
        """
