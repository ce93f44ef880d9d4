"""The type of an integrator, and what integrators share."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from toile.engine.forces.step_request import StepRequest
from toile.engine.step.options import StepOutcome
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Float

Ask = Callable[[float, float], StepRequest]
"""Returns the request of a stage of a length [s] that ends at a share of the step."""
Integrator = Callable[[ClothStepper, float, Ask], StepOutcome]
"""Advances a stepper by a step of a size [s]. All that it remembers is in the stepper's memory."""


def both(first: StepOutcome, last: StepOutcome, moved: Float, error: float | None) -> StepOutcome:
    """Return the outcome of a step of two stages that moved nodes as far [m], shape (n,)."""
    return replace(
        last,
        moved=moved,
        converged=first.converged and last.converged,
        newton_iterations=first.newton_iterations + last.newton_iterations,
        cg_iterations=first.cg_iterations + last.cg_iterations,
        min_gap=min(first.min_gap, last.min_gap),
        error=error,
    )


def root_mean_square(vectors: Float) -> float:
    """Root of the mean squared length, shape (n, 3)."""
    return float(np.sqrt((vectors * vectors).sum(axis=1).mean()))


def without_contact(stepper: ClothStepper, name: str) -> None:
    """Raise ValueError if a stepper has contact, of which the explicit method of that name knows nothing."""
    if stepper.collisions is not None:
        raise ValueError(f"{name} has no contact: take an implicit integrator, or cloth that touches nothing")
