"""Two levels: Gauss-Seidel for short wavelengths, rigid motions of groups of nodes for long ones.

    M^-1 = S^-1 + Q (I - A S^-1),   Q = Z (Z^T A Z)^-1 Z^T

One smoothing step followed by the coarse correction of what it leaves (A-DEF2 in Tang, Nabben, Vuik and
Erlangga 2009). When the residuals satisfy Z^T r = 0, which `correct` establishes and conjugate gradients
keep, this is the symmetric (I - Q A) S^-1 (I - A Q) at two thirds of the cost.
"""

import numpy as np

from toile.engine.solve.linear_system import NO_CONTACTS, LinearSystem
from toile.engine.solve.preconditioner.gauss_seidel import SymmetricGaussSeidel
from toile.engine.solve.preconditioner.rigid_coarse import RigidCoarseSpace
from toile.geometry.arrays import Float, Int


class TwoLevel:
    """Symmetric Gauss-Seidel, corrected by rigid motions of groups of about `group_size` nodes."""

    def __init__(self, system: LinearSystem, *, group_size: int = 60) -> None:
        self._smoother = SymmetricGaussSeidel(system.pattern)
        self._coarse = RigidCoarseSpace(system, group_size)
        self._system = system
        self._forces: Float = np.zeros((system.pattern.node_count, 3))
        self._distant = NO_CONTACTS
        self._touched: Int = np.zeros(0, np.int32)
        self._squares: _Squares | None = None

    def update(self, system: LinearSystem, positions: Float) -> None:
        """Follow new numbers; positions: node positions [m], by node, shape (node_count, 3)."""
        self._system = system
        self._smoother.update(system, positions)
        self._coarse.update(system, positions)
        self._squares = _Squares(system.squares, self._coarse) if system.squares else None

    def apply(self, residual: Float, out: Float) -> float:
        """Write M^-1 residual into `out` and return residual . out; shapes (node_count, 3)."""
        coarse = self._coarse
        self._smoother.apply(residual, out)
        loads = coarse.restrict(residual)
        coarse.subtract_restricted_product(out, loads)
        if self._system.has_distant_contacts:
            contacts = self._system.contacts
            if contacts is not self._distant:
                self._distant = contacts
                self._touched = np.unique(contacts.nodes[contacts.nodes >= 0])
            self._system.add_distant_contacts(out, self._forces)
            loads -= coarse.take_restricted(self._touched, self._forces)
        if self._squares is not None:
            self._squares.subtract_product(out, loads)
        self._solve(loads)
        return coarse.add_prolonged(loads, residual, out)

    def correct(self, residual: Float, correction: Float) -> bool:
        """Write Q residual into `correction`; afterwards Z^T (residual - A correction) = 0."""
        loads = self._coarse.restrict(residual)
        self._solve(loads)
        correction[:] = 0.0
        self._coarse.add_prolonged(loads, residual, correction)
        return True

    def _solve(self, loads: Float) -> None:
        """Overwrite loads with the motions (Z^T A Z)^-1 loads."""
        self._coarse.solve(loads)
        if self._squares is not None:
            self._squares.correct(loads)


class _Squares:
    """What squares g g^T over all nodes add to the coarse matrix, inverted by Woodbury's formula."""

    def __init__(self, vectors: list[Float], coarse: RigidCoarseSpace) -> None:
        self._vectors = vectors
        self._restricted = np.stack([coarse.restrict(g) for g in vectors], axis=1)
        solved = []
        for column in self._restricted.T:
            motions = column.copy()
            coarse.solve(motions)
            solved.append(motions)
        self._solved = np.stack(solved, axis=1)
        self._inner = np.linalg.inv(np.eye(len(vectors)) + self._restricted.T @ self._solved)

    def subtract_product(self, displacements: Float, loads: Float) -> None:
        """Subtract Z^T g (g . displacements) from `loads`."""
        along = np.array([float(np.vdot(g, displacements)) for g in self._vectors])
        loads -= self._restricted @ along

    def correct(self, motions: Float) -> None:
        """Correct motions that are solved without squares."""
        motions -= self._solved @ (self._inner @ (self._restricted.T @ motions))
