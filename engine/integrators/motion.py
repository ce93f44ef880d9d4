"""What integrators have in common: the state they advance, and what one step of them answers."""

from typing import NamedTuple, Protocol

from toile.engine.dynamics import Dynamics
from toile.engine.integrators.newton import NewtonResult
from toile.engine.step.stages import Stage
from toile.geometry.arrays import Float


class Before(NamedTuple):
    """Positions [m] and velocities [m/s], shapes (n, 3), before the last step, and its size [s]."""

    positions: Float
    velocities: Float
    h: float


class Motion(NamedTuple):
    """Node positions [m] and velocities [m/s], shapes (n, 3), at a time [s], and what steps remember.

    `acceleration` [m/s^2], shape (n, 3), is the one that the last implicit stage has solved for. Both
    memories are None at the start and after anything that makes velocities jump, such as an impact.
    """

    positions: Float
    velocities: Float
    seconds: float = 0.0
    acceleration: Float | None = None
    before: Before | None = None

    def after(self, stage: Stage, x: Float, h: float) -> "Motion":
        """Return the motion after a step of h [s] whose last stage ended at positions x [m], shape (n, 3)."""
        before = Before(self.positions, self.velocities, h)
        return Motion(x, stage.velocity_at(x), self.seconds + h, stage.acceleration_at(x), before)


class StepDone(NamedTuple):
    """The motion after a step, and what it took.

    newton, cg: iterations. converged: whether the solver reached its tolerance. error: estimated error of the
    positions that this step adds, root mean square over the nodes [m]; None where it is not known.
    """

    motion: Motion
    newton: int = 0
    cg: int = 0
    converged: bool = True
    error: float | None = None


def step_done(motion: Motion, *solved: NewtonResult, error: float | None = None) -> StepDone:
    """Return a step from the results of its stages."""
    return StepDone(
        motion,
        sum(stage.iterations for stage in solved),
        sum(stage.cg for stage in solved),
        all(stage.converged for stage in solved),
        error,
    )


class Integrator(Protocol):
    """Advances the motion of one cloth; all that it remembers is in the motion."""

    def step(self, dynamics: Dynamics, motion: Motion, h: float) -> StepDone:
        """Return the motion after a step of h [s]."""
