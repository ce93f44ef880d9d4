"""How a film gets over a time step: in one stage of the stepper or several."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from toile.engine.step.request import StepOutcome, StepRequest
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
    stage = trapezoidal_stage(x, v, stepper.memory.acceleration, h)
    first = stepper.step(replace(ask(GAMMA * h, GAMMA), stage=stage))
    stage = tr_bdf2_stage(x, v, stepper.x.copy(), stepper.v.copy(), h)
    last = stepper.step(replace(ask((1.0 - GAMMA) * h, 1.0), stage=stage))
    return StepOutcome(
        moved=np.linalg.norm(stepper.x - x, axis=1),
        converged=first.converged and last.converged,
        newton_iterations=first.newton_iterations + last.newton_iterations,
        cg_iterations=first.cg_iterations + last.cg_iterations,
        contacts=last.contacts,
        limited=last.limited,
        min_gap=min(first.min_gap, last.min_gap),
    )
