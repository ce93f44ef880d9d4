"""The floor: a plane that pushes cloth up and brakes what slides on it.

A penalty per area of cloth, k/2 (h - y)^2 below height h, with the stiffness of contact. Friction is that
of a spring to where the node was when the step began, as stiff as the pressure then allows: mu p / s, with s
a slip that holds the whole friction. The floor acts under gravity only: while a garment is sewn, its panels
may reach through it.
"""

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.force import NodalForce, StepState
from toile.engine.forces.step_request import MOTION_MAX
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float

STIFFNESS = 2e6
"""Pressure per depth [Pa/m]."""
FRICTION, SLIP = 0.4, 1e-3
"""Coulomb coefficient; slip at which all of it acts [m]."""


class Ground(NodalForce):
    """A floor at a height [m] under nodes of some rest area [m^2], shape (n,)."""

    def __init__(self, height: float, node_area: Float) -> None:
        self.height = height
        self._stiffness = STIFFNESS * node_area
        self._start = np.empty((0, 3))
        self._hold = np.empty(0)

    @classmethod
    def under(cls, height: float, cloth: Cloth) -> "Ground":
        """Return the floor at a height [m] under a cloth."""
        return cls(height, cloth.node_area)

    def begin(self, step: StepState, x: Float) -> bool:
        """Act where gravity does and cloth may reach the floor within the step; take what holds it there."""
        if step.request.gravity == 0.0 or x[:, 1].min() > self.height + MOTION_MAX:
            return False
        self._start = x.copy()
        self._hold = FRICTION / SLIP * self._stiffness * self._depth(x)
        return True

    def energy(self, x: Float) -> float:
        """Energy at positions x [m], shape (n, 3), friction included [J]."""
        slid = (x[:, [0, 2]] - self._start[:, [0, 2]]) ** 2
        return 0.5 * float(self._stiffness @ self._depth(x) ** 2 + self._hold @ slid.sum(axis=1))

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add minus the force [N] to an array of shape (n, 3)."""
        gradient[:, 1] -= self._stiffness * self._depth(x)
        gradient[:, [0, 2]] += self._hold[:, None] * (x - self._start)[:, [0, 2]]

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add the gradient, and the stiffness of floor and friction."""
        self.add_gradient(x, gradient)
        blocks = np.zeros((len(x), 3, 3))
        blocks[:, 0, 0] = blocks[:, 2, 2] = self._hold
        blocks[:, 1, 1] = np.where(self._depth(x) > 0.0, self._stiffness, 0.0)
        hessian.add_nodes(blocks)

    def _depth(self, x: Float) -> Float:
        """Depth of every node below the floor [m], shape (n,)."""
        return np.asarray(np.maximum(self.height - x[:, 1], 0.0))
