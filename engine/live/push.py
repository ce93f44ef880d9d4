"""Forces that somebody pushes nodes with: the same for the whole of a step."""

import numpy as np

from toile.engine.forces.force import NodalForce, StepState
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float


class Push(NodalForce):
    """Forces on nodes [N], shape (n, 3); without any it does not act."""

    def __init__(self, count: int) -> None:
        self.force = np.zeros((count, 3))

    def begin(self, step: StepState, x: Float) -> bool:
        """Whether there is any force."""
        return bool(self.force.any())

    def energy(self, x: Float) -> float:
        """Energy [J]: the force is its negative slope."""
        return -float((self.force * x).sum())

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add minus the force [N] to shape (n, 3)."""
        gradient -= self.force

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add the gradient; a constant force has no Hessian."""
        self.add_gradient(x, gradient)
