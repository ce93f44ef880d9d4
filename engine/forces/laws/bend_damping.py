"""Damping of bending: a fabric's rigidity times a time, against the rate at which curvature changes.

With v the velocity at the end of the step, omega the turning of a face in it and B the second derivatives,
the rate is r = B v - omega x (B x), zero in every rigid motion, and the dissipation potential of a step of h

    is h/2 seconds sum over faces  A sum_ab D_ab r_a . r_b,     a, b in (uu, vv, uv),

with B x and the directions of omega where the step starts. A mode of frequency f loses the share
pi seconds (2 pi f) of its amplitude per cycle, whatever mesh and step (stiffness-proportional or Kelvin-Voigt
damping; Rayleigh 1877).
"""

import numpy as np
from scipy.sparse import csr_array

from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.bend import Bending
from toile.engine.forces.force import StepState
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float, Int


class BendDamping:
    """Damping of `Bending`, after which it stands in a list of forces. It acts on cloth in motion only.

    Its Hessian is the rigidity matrix times seconds/h: what turning adds is left out. Where fabrics have
    different times the longest counts there, which changes how fast iterations converge, not to what.
    """

    nodes: Int | None = None
    elastic = False
    constant_matrix: csr_array | None = None

    def __init__(self, bending: Bending, seconds: Float) -> None:
        """Build for damping of `seconds` times the rigidity, per face (t,)."""
        self._bending = bending
        self._rigidity = seconds[:, None, None] * bending.rigidity
        self._longest = float(seconds.max())
        self._step: StepState | None = None
        self._share = 0.0

    @classmethod
    def for_cloth(cls, cloth: Cloth, bending: Bending | None) -> "BendDamping | None":
        """Return the damping of a cloth's bending, or None where no fabric has any."""
        if bending is None or not any(fabric.bending_damping > 0.0 for fabric in cloth.fabrics):
            return None
        return cls(bending, np.array([fabric.bending_damping for fabric in cloth.fabrics])[cloth.fabric])

    def begin(self, step: StepState, x: Float) -> bool:
        """Take the shape at x; steps at rest have no velocity to damp."""
        if step.request.at_rest:
            return False
        self._step = step
        self._curved = self._bending.second_derivatives_at(x)
        self._turning = self._bending.turning(x)
        self._h = np.asarray(step.h[self._bending.faces].min(axis=1))
        self._share = self._longest / float(self._h.min())
        return True

    def energy(self, x: Float) -> float:
        """Dissipation potential of the step [J]."""
        rate = self._rate(x)
        power = np.einsum("tai,tab,tbi->t", rate, self._rigidity, rate)
        return 0.5 * float(self._h @ power)

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add minus the damping force [N] to an array of shape (n, 3)."""
        moments = np.einsum("tab,tbi->tai", self._rigidity, self._rate(x))
        gradient += self._bending.second_derivatives.T @ moments.reshape(-1, 3)
        self._turning.add_torques(-np.cross(self._curved, moments).sum(axis=1), gradient)

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add the force, and its share of the constant matrix."""
        self.add_gradient(x, gradient)
        hessian.scale_constant(hessian.constant_scale + self._share)

    def _rate(self, x: Float) -> Float:
        """Change of the second derivatives beyond turning [1/(m s)], shape (t, 3, 3)."""
        assert self._step is not None
        v = self._step.velocity_at(x)
        omega = self._turning.of(v)
        return self._bending.second_derivatives_at(v) - np.cross(omega[:, None], self._curved)
