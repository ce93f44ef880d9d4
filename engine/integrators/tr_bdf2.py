"""TR-BDF2: the trapezoidal rule over a share of the step, then BDF2 over both parts (Bank et al. 1985).

Its error per step is 2 k h (v0/g - v_m/(g (1 - g)) + v1/(1 - g)) with g = GAMMA, v_m the velocity between the
stages and k = (-3 g^2 + 4 g - 2)/(12 (2 - g)) (Bank et al. 1985, section 3).
"""

from dataclasses import dataclass, field

import numpy as np

from toile.engine.dynamics import Dynamics
from toile.engine.integrators.motion import Motion, StepDone, step_done
from toile.engine.integrators.newton import NewtonOptions, minimise
from toile.engine.step.stages import GAMMA, tr_bdf2_stage, trapezoidal_stage

ERROR = 2.0 * (-3.0 * GAMMA**2 + 4.0 * GAMMA - 2.0) / (12.0 * (2.0 - GAMMA))


@dataclass(frozen=True, kw_only=True)
class TrBdf2:
    """Second order, L-stable, two stages of one matrix per step; any step size may follow any other.

    A step without a past evaluates the forces at its start.
    """

    newton: NewtonOptions = field(default_factory=NewtonOptions)

    def step(self, dynamics: Dynamics, motion: Motion, h: float) -> StepDone:
        """Return the motion after a step of h [s]."""
        x, v, acceleration = motion.positions, motion.velocities, motion.acceleration
        if acceleration is None:
            acceleration = dynamics.acceleration(x, v, motion.seconds)
        first = trapezoidal_stage(x, v, acceleration, h)
        guess = dynamics.drifted(x, v, GAMMA * h)
        dynamics.lag(guess, motion.seconds + GAMMA * h)
        middle = minimise(dynamics, first, guess, self.newton)
        v_middle = first.velocity_at(middle.positions)

        second = tr_bdf2_stage(x, v, middle.positions, v_middle, h)
        guess = dynamics.drifted(middle.positions, v_middle, (1.0 - GAMMA) * h)
        dynamics.lag(guess, motion.seconds + h)
        end = minimise(dynamics, second, guess, self.newton)
        after = motion.after(second, end.positions, h)
        differences = v / GAMMA - v_middle / (GAMMA * (1.0 - GAMMA)) + after.velocities / (1.0 - GAMMA)
        error = abs(ERROR) * h * float(np.sqrt((differences * differences).sum(axis=1).mean()))
        return step_done(after, middle, end, error=error)
