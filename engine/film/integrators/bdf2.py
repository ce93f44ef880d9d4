"""BDF2: the second-order backward difference formula over the last two states, for steps of any sizes.

Its error per step is (1 + w)^2 / (6 w (1 + 2 w)) h^3 x''', w the ratio of the last two step sizes; x''' is
estimated from the last three velocities (Hairer, Norsett and Wanner 1993, III.5).
"""

from dataclasses import replace

from toile.engine.film.integrators.integrator import Ask, root_mean_square
from toile.engine.step.memory import Before
from toile.engine.step.options import StepOutcome
from toile.engine.step.stages import backward_euler_stage, bdf2_stage
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Float

LARGEST_GROWTH = 2.0
"""A step may be this many times the last one; from 1 + sqrt 2 on errors would grow (Grigorieff 1983)."""


def bdf2(stepper: ClothStepper, h: float, ask: Ask) -> StepOutcome:
    """Make one step of h [s]: second order, L-stable, one stage; nodes in contact take backward Euler steps.

    A step without a past, or of more than LARGEST_GROWTH times the last one's size, is backward Euler.
    """
    x, v = stepper.x.copy(), stepper.v.copy()
    before = None if stepper.memory is None else stepper.memory.before
    if before is not None and h > LARGEST_GROWTH * (1.0 + 1e-9) * before.h:
        before = None
    if before is None:
        stage = backward_euler_stage(x, v, h)
    else:
        stage = bdf2_stage(x, v, before.positions, before.velocities, h, before.h)
    outcome = stepper.step(ask(h, 1.0), stage)
    return outcome if before is None else replace(outcome, error=_error(before, v, stepper.v, h))


def _error(before: Before, v: Float, v_after: Float, h: float) -> float:
    """Estimate of the step's error [m], root mean square over the nodes."""
    ratio = h / before.h
    jerk = 2.0 * ((v_after - v) / h - (v - before.velocities) / before.h) / (h + before.h)
    constant = (1.0 + ratio) ** 2 / (6.0 * ratio * (1.0 + 2.0 * ratio))
    return constant * h**3 * root_mean_square(jerk)
