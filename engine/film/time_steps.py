"""How a film gets over a time step: in one stage of the stepper or several."""

from collections.abc import Callable

import numpy as np

from toile.engine.forces.step_request import StepRequest
from toile.engine.step.options import StepOutcome
from toile.engine.step.stages import GAMMA, tr_bdf2_stage, trapezoidal_stage
from toile.engine.step.step import ClothStepper

Ask = Callable[[float, float], StepRequest]
"""Returns the request of a stage of a length [s] that ends at a share of the step."""
FilmIntegrator = Callable[[ClothStepper, float, Ask], StepOutcome]
"""Advances the stepper by a step of a size [s]."""


def backward_euler(stepper: ClothStepper, h: float, ask: Ask) -> StepOutcome:
    """Make one step of h [s]: of first order, it calms cloth down; a swing of 1 Hz loses half in a second."""
    return stepper.step(ask(h, 1.0))


def tr_bdf2(stepper: ClothStepper, h: float, ask: Ask) -> StepOutcome:
    """Make one step of h [s] in two stages: of second order where cloth is free, first in contact."""
    x, v = stepper.x.copy(), stepper.v.copy()
    first_request = ask(GAMMA * h, GAMMA)
    past = stepper.past(first_request.seconds - GAMMA * h)
    first = stepper.step(first_request, trapezoidal_stage(x, v, past.acceleration, h))
    second_stage = tr_bdf2_stage(x, v, stepper.x.copy(), stepper.v.copy(), h)
    last = stepper.step(ask((1.0 - GAMMA) * h, 1.0), second_stage)
    return StepOutcome(
        moved=np.linalg.norm(stepper.x - x, axis=1),
        converged=first.converged and last.converged,
        newton_iterations=first.newton_iterations + last.newton_iterations,
        cg_iterations=first.cg_iterations + last.cg_iterations,
        contacts=last.contacts,
        limited=last.limited,
        min_gap=min(first.min_gap, last.min_gap),
    )
