"""Backward Euler, iterated from x0 + h v0: x1 = x0 + h v1, v1 = v0 + h a(x1, v1).

Of first order, L-stable: what is faster than the step is damped away, and what is slower, too; a swing of
1 Hz loses half of its energy in a second.
"""

from toile.engine.film.integrators.integrator import Ask
from toile.engine.step.options import StepOutcome
from toile.engine.step.stages import backward_euler_stage
from toile.engine.step.step import ClothStepper


def backward_euler(stepper: ClothStepper, h: float, ask: Ask) -> StepOutcome:
    """Make one step of h [s]."""
    return stepper.step(ask(h, 1.0), backward_euler_stage(stepper.x.copy(), stepper.v.copy(), h))
