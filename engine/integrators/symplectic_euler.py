"""Symplectic Euler: v1 = v0 + h a(x0, v0), x1 = x0 + h v1. Energy does not drift while h omega < 2."""

from toile.engine.dynamics import Dynamics
from toile.engine.integrators.motion import Motion, StepDone


class SymplecticEuler:
    """First order; keeps linear and angular momentum to rounding."""

    def step(self, dynamics: Dynamics, motion: Motion, h: float) -> StepDone:
        """Return the motion after a step of h [s]."""
        x, v, seconds = motion[:3]
        v = v + h * dynamics.acceleration(x, v, seconds)
        return StepDone(Motion(x + h * v, v, seconds + h))
