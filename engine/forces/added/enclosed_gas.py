"""Gas in a closed garment: an energy of the enclosed volume.

V = sum over faces of x1 . (x2 x x3)/6, and its gradient at a node is a third of the area vectors around it.
With overpressure p the energy E(V) has E' = -p: the force p dV/dx, the Hessian -p' dV/dx (dV/dx)^T - p V''.
The first part has rank one and is positive semi-definite; it holds the volume of gas and is kept. The second
has both signs and is left out: tension of cloth is larger for all shapes but the smoothest, which Newton's
method reaches without it.
"""

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fields.gas import Gas
from toile.engine.forces.force import NodalForce, StepState
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float, Int
from toile.geometry.normals import area_normals

LEAST_VOLUME = 1e-9
"""Volume [m^3] below which a garment counts as turned inside out."""


class EnclosedGas(NodalForce):
    """Gas in the closed surface that faces (t, 3) of nodes make, their right sides outside."""

    def __init__(self, gas: Gas, faces: Int, now: float = 0.0) -> None:
        self._gas = gas
        self._faces = faces
        self._seconds = now

    @classmethod
    def all_of(cls, cloth: Cloth) -> "list[EnclosedGas]":
        """Return the gas of every garment that has some, once all seams are closed."""
        if len(cloth.stitches):
            return []
        return [cls(gas, cloth.face_nodes[cloth.garment == gas.garment], cloth.now) for gas in cloth.gas]

    def begin(self, step: StepState, x: Float) -> bool:
        """Take the time at the end of the step."""
        self._seconds = step.request.seconds
        return True

    def volume(self, x: Float) -> float:
        """Enclosed volume [m^3] at node positions x [m], shape (n, 3)."""
        # From a point within, small differences of large volumes do not arise.
        corners = x[self._faces] - x[self._faces].mean(axis=(0, 1))
        volume = np.einsum("ti,ti->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
        return max(float(volume), LEAST_VOLUME)

    def overpressure(self, x: Float) -> float:
        """Pressure above that outside [Pa] at node positions x [m], shape (n, 3)."""
        return self._gas.overpressure(self.volume(x), self._seconds)

    def energy(self, x: Float) -> float:
        """Energy [J] at node positions x [m], shape (n, 3)."""
        return self._gas.energy(self.volume(x), self._seconds)

    def _slope(self, x: Float) -> Float:
        """Return the derivative of the volume by the positions [m^2], shape (n, 3)."""
        share = area_normals(x[self._faces]) / 6.0
        nodes = self._faces.ravel()
        return np.stack([np.bincount(nodes, np.repeat(share[:, k], 3), len(x)) for k in range(3)], axis=1)

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add minus the force [N] to an array of shape (n, 3)."""
        gradient -= self.overpressure(x) * self._slope(x)

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add the gradient, and what holds the volume."""
        slope = self._slope(x)
        gradient -= self.overpressure(x) * slope
        stiffness = self._gas.stiffness(self.volume(x), self._seconds)
        if stiffness > 0.0:
            hessian.add_square(np.sqrt(stiffness) * slope)
