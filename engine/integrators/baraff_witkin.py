"""Backward Euler linearised once: the step of Baraff and Witkin (1998), their equation 6.

(M + h D + h^2 K) dv = h (f - h K v0), dx = h (v0 + dv): the first Newton iteration of backward Euler from x0,
taken in full, with damping in the directions of x0. K is the positive semi-definite part of the stiffness.
"""

from dataclasses import dataclass

from toile.engine.dynamics import Dynamics
from toile.engine.integrators.motion import Motion, StepDone
from toile.engine.step.stages import backward_euler_stage


@dataclass(frozen=True, kw_only=True)
class BaraffWitkin:
    """First order, one linear system per step, solved to a relative residual."""

    cg_tolerance: float = 1e-2

    def step(self, dynamics: Dynamics, motion: Motion, h: float) -> StepDone:
        """Return the motion after a step of h [s]."""
        x = motion.positions
        stage = backward_euler_stage(x, motion.velocities, h)
        dynamics.lag(x, motion.seconds + h)
        gradient = dynamics.linearise(stage, dynamics.place(stage, x))
        solved = dynamics.newton_move(gradient, x, self.cg_tolerance)
        after = motion.after(stage, x + solved.solution, h)
        return StepDone(after, 1, solved.iterations, solved.converged)
