"""BDF2: the second-order backward difference formula over the last two states, for steps of any sizes.

Its error per step is (1 + w)^2 / (6 w (1 + 2 w)) h^3 x''', w the ratio of the last two step sizes; x''' is
estimated from the last three velocities (Hairer, Norsett and Wanner 1993, III.5).
"""

from dataclasses import dataclass, field

import numpy as np

from toile.engine.dynamics import Dynamics
from toile.engine.integrators.motion import Before, Motion, StepDone, step_done
from toile.engine.integrators.newton import NewtonOptions, minimise
from toile.engine.step.stages import backward_euler_stage, bdf2_stage
from toile.geometry.arrays import Float

LARGEST_GROWTH = 2.0
"""A step may be this many times the last one; from 1 + sqrt 2 on errors would grow (Grigorieff 1983)."""


@dataclass(frozen=True, kw_only=True)
class Bdf2:
    """Second order, L-stable, one stage per step.

    A step without a past, or of more than LARGEST_GROWTH times the last one's size, is backward Euler.
    """

    newton: NewtonOptions = field(default_factory=NewtonOptions)

    def step(self, dynamics: Dynamics, motion: Motion, h: float) -> StepDone:
        """Return the motion after a step of h [s]."""
        x, v, before = motion.positions, motion.velocities, motion.before
        if before is not None and h > LARGEST_GROWTH * (1.0 + 1e-9) * before.h:
            before = None
        if before is None:
            stage = backward_euler_stage(x, v, h)
        else:
            stage = bdf2_stage(x, v, before.positions, before.velocities, h, before.h)
        guess = dynamics.drifted(x, v, h)
        dynamics.lag(guess, motion.seconds + h)
        solved = minimise(dynamics, stage, guess, self.newton)
        after = motion.after(stage, solved.positions, h)
        error = None if before is None else _error(before, v, after.velocities, h)
        return step_done(after, solved, error=error)


def _error(before: Before, v: Float, v_after: Float, h: float) -> float:
    """Estimate of the step's error [m], root mean square over the nodes."""
    ratio = h / before.h
    jerk = 2.0 * ((v_after - v) / h - (v - before.velocities) / before.h) / (h + before.h)
    constant = (1.0 + ratio) ** 2 / (6.0 * ratio * (1.0 + 2.0 * ratio))
    return constant * h**3 * float(np.sqrt((jerk * jerk).sum(axis=1).mean()))
