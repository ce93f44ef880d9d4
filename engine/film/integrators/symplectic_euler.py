"""Symplectic Euler: v1 = v0 + h a(x0, v0), x1 = x0 + h v1. Energy does not drift while h omega < 2."""

import numpy as np

from toile.engine.film.integrators.integrator import Ask, without_contact
from toile.engine.step.options import StepOutcome
from toile.engine.step.step import ClothStepper


def symplectic_euler(stepper: ClothStepper, h: float, ask: Ask) -> StepOutcome:
    """Make one step of h [s], of first order: it keeps linear and angular momentum to rounding.

    Raises ValueError where there is contact.
    """
    without_contact(stepper, "symplectic Euler")
    v = stepper.v + h * stepper.acceleration(ask(h, 0.0).seconds)
    stepper.put(stepper.x + h * v, v)
    return StepOutcome(moved=np.linalg.norm(h * v, axis=1))
