"""Explicit Euler: x1 = x0 + h v0, v1 = v0 + h a(x0, v0). Without damping it gains energy at any step size."""

import numpy as np

from toile.engine.film.integrators.integrator import Ask, without_contact
from toile.engine.step.options import StepOutcome
from toile.engine.step.step import ClothStepper


def explicit_euler(stepper: ClothStepper, h: float, ask: Ask) -> StepOutcome:
    """Make one step of h [s], of first order. Raises ValueError where there is contact."""
    without_contact(stepper, "explicit Euler")
    x, v = stepper.x, stepper.v
    acceleration = stepper.acceleration(ask(h, 0.0).seconds)
    stepper.put(x + h * v, v + h * acceleration)
    return StepOutcome(moved=np.linalg.norm(h * v, axis=1))
