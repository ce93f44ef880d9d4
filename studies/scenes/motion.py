"""Motions without contact that studies measure, with control over solver accuracy and step sizes."""

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.film.advance import StepCounts, Way, advance
from toile.engine.film.integrators.integrator import Integrator
from toile.engine.film.step_sizes import StepLimits, StepSizes
from toile.engine.forces.air_flow import AirFlow
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.cloth_forces import cloth_stepper
from toile.engine.step.options import StepOptions
from toile.engine.step.step import ClothStepper
from toile.geometry.stage_clock import StageClock
from toile.studies.scenes.scenes import film_plan

LOOSEST = 0.1
"""Largest tolerance of steps whose size follows the error [m/s]: with 1 m/s a sheet gained energy."""
SOLVED_FOR_ERROR = 10.0
"""Tolerance of the stages over the rate of errors: above it the estimate sees the solver, not the step."""
LONGEST, SHORTEST, FIRST = 1.0 / 24.0, 1e-5, 1e-3
"""Sizes of steps that follow the error [s]."""


@dataclass(frozen=True, kw_only=True)
class Solving:
    """Tolerances with which stages are solved.

    Attributes
    ----------
    tolerance
        Largest displacement of the last Newton iteration over half the length of the stage [m/s].
    iterations
        Limit of the iterations; 1 is the linearly implicit step.
    cg_tolerance
        Relative residual of the linear systems.
    """

    tolerance: float = 1e-3
    iterations: int = 30
    cg_tolerance: float = 1e-2

    def request(self, length: float, until: float) -> StepRequest:
        """Return the request of a stage of a length [s] that ends at a time [s]."""
        return StepRequest(
            h=length, at_rest=False, newton=self.iterations, newton_tolerance=0.5 * self.tolerance * length,
            cg_tolerance=self.cg_tolerance, cg_iterations=1000, motion_max=inf, seconds=until,
        )  # fmt: skip


EXACT = Solving(tolerance=1e-11, cg_tolerance=1e-12)
"""Stages solved so far that errors are those of the steps."""
LINEARISED = Solving(iterations=1)


def free_options(gravity: float = 9.81, air: AirFlow | None = None) -> StepOptions:
    """Return the options of cloth that touches nothing."""
    return replace(film_plan(air).step, gravity=gravity, self_contact=False)


def free_stepper(cloth: Cloth, *, gravity: float = 9.81, air: AirFlow | None = None) -> ClothStepper:
    """Return the stepper of a cloth that touches nothing."""
    return cloth_stepper(cloth, None, free_options(gravity, air), StageClock())


def carried_on(
    stepper: ClothStepper, integrator: Integrator, solving: Solving, seconds: float, h: float,
    since: float = 0.0,
) -> StepCounts:  # fmt: skip
    """Advance by a time [s] in equal steps of about h [s], from a time on.

    Raises FloatingPointError where the motion has exploded.
    """
    counts = StepCounts()
    size = seconds / max(1, round(seconds / h))
    sizes = StepSizes(StepLimits(longest=size, shortest=inf), size)
    way = Way(integrator=integrator, ask=solving.request)
    for outcome in advance(stepper, way, sizes, (since, seconds), counts):
        counts.forced += not outcome.converged
        if not np.isfinite(stepper.x[-1]).all():
            raise FloatingPointError(f"positions are not finite in steps of {h:g} s")
    return counts


def carried_within(
    stepper: ClothStepper, integrator: Integrator, seconds: float, rate: float, exactly: Solving | None = None
) -> StepCounts:
    """Advance by a time [s] in steps as long as an error per second [m/s] allows."""
    counts = StepCounts()
    solving = exactly or Solving(tolerance=min(SOLVED_FOR_ERROR * rate, LOOSEST))
    limits = StepLimits(longest=LONGEST, shortest=SHORTEST, error_rate=rate)
    way = Way(integrator=integrator, ask=solving.request)
    for _ in advance(stepper, way, StepSizes(limits, FIRST), (0.0, seconds), counts):
        pass
    return counts


def total_energy(stepper: ClothStepper) -> float:
    """Kinetic, elastic and gravitational energy now [J]."""
    kinetic = 0.5 * float(stepper.mass @ (stepper.v * stepper.v).sum(axis=1))
    height = float(stepper.mass @ stepper.x[:, 1])
    return kinetic + stepper.elastic_energy() + stepper.options.gravity * height
