"""TR-BDF2: the trapezoidal rule over a share of the step, then BDF2 over both parts (Bank et al. 1985).

Its error per step is 2 k h (v0/g - v_m/(g (1 - g)) + v1/(1 - g)) with g = GAMMA, v_m the velocity between the
stages and k = (-3 g^2 + 4 g - 2)/(12 (2 - g)) (Bank et al. 1985, section 3).
"""

import numpy as np

from toile.engine.film.integrators.integrator import Ask, both, root_mean_square
from toile.engine.step.options import StepOutcome
from toile.engine.step.stages import GAMMA, tr_bdf2_stage, trapezoidal_stage
from toile.engine.step.step import ClothStepper

ERROR = 2.0 * (-3.0 * GAMMA**2 + 4.0 * GAMMA - 2.0) / (12.0 * (2.0 - GAMMA))


def tr_bdf2(stepper: ClothStepper, h: float, ask: Ask) -> StepOutcome:
    """Make one step of h [s] in two stages: of second order where cloth is free, first in contact.

    Any step size may follow any other.
    """
    x, v = stepper.x.copy(), stepper.v.copy()
    request = ask(GAMMA * h, GAMMA)
    past = stepper.past(request.seconds - GAMMA * h)
    first = stepper.step(request, trapezoidal_stage(x, v, past.acceleration, h))
    v_middle = stepper.v.copy()
    stage = tr_bdf2_stage(x, v, stepper.x.copy(), v_middle, h)
    last = stepper.step(ask((1.0 - GAMMA) * h, 1.0), stage)
    differences = v / GAMMA - v_middle / (GAMMA * (1.0 - GAMMA)) + stepper.v / (1.0 - GAMMA)
    error = abs(ERROR) * h * root_mean_square(differences)
    return both(first, last, np.linalg.norm(stepper.x - x, axis=1), error)
