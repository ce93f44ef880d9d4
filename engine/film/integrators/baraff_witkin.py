"""The linearly implicit step of Baraff and Witkin (1998), equation 6: backward Euler, linearised once.

(M + h D + h^2 K) dv = h (f - h K v0), dx = h (v0 + dv), K being the positive semi-definite part of the
stiffness. Of first order; it calms cloth down, cloth that turns above all. Asked for more Newton iterations
than one it comes nearer to backward Euler.
"""

from toile.engine.film.integrators.integrator import Ask
from toile.engine.step.options import StepOutcome
from toile.engine.step.step import ClothStepper


def baraff_witkin(stepper: ClothStepper, h: float, ask: Ask) -> StepOutcome:
    """Make one step of h [s]."""
    return stepper.step(ask(h, 1.0))
