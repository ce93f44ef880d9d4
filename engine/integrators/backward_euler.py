"""Backward Euler, iterated until it is solved: x1 = x0 + h v1, v1 = v0 + h a(x1, v1)."""

from dataclasses import dataclass, field

from toile.engine.dynamics import Dynamics
from toile.engine.integrators.motion import Motion, StepDone, step_done
from toile.engine.integrators.newton import NewtonOptions, minimise
from toile.engine.step.stages import backward_euler_stage


@dataclass(frozen=True, kw_only=True)
class BackwardEuler:
    """First order, L-stable: what is faster than the step is damped away, and what is slower, too."""

    newton: NewtonOptions = field(default_factory=NewtonOptions)

    def step(self, dynamics: Dynamics, motion: Motion, h: float) -> StepDone:
        """Return the motion after a step of h [s]."""
        stage = backward_euler_stage(motion.positions, motion.velocities, h)
        guess = dynamics.drifted(motion.positions, motion.velocities, h)
        dynamics.lag(guess, motion.seconds + h)
        solved = minimise(dynamics, stage, guess, self.newton)
        return step_done(motion.after(stage, solved.positions, h), solved)
