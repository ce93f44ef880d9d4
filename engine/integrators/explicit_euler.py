"""Explicit Euler: x1 = x0 + h v0, v1 = v0 + h a(x0, v0). Without damping it gains energy at any step size."""

from toile.engine.dynamics import Dynamics
from toile.engine.integrators.motion import Motion, StepDone


class ExplicitEuler:
    """First order."""

    def step(self, dynamics: Dynamics, motion: Motion, h: float) -> StepDone:
        """Return the motion after a step of h [s]."""
        x, v, seconds = motion[:3]
        acceleration = dynamics.acceleration(x, v, seconds)
        return StepDone(Motion(x + h * v, v + h * acceleration, seconds + h))
