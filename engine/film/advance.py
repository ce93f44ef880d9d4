"""Advances a motion over a span of time: steps are made, judged, and kept or undone."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from toile.engine.film.integrators.integrator import Ask, Integrator
from toile.engine.film.step_sizes import StepSizes
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.options import StepOutcome
from toile.engine.step.step import ClothStepper

ROUNDING = 1e-9
"""Share of the time to go that is rounding."""


@dataclass
class StepCounts:
    """Work that a motion took.

    `steps` counts those that were kept, `retries` those that were undone and tried again shorter, `forced`
    steps of the shortest size that were kept although they should have been undone; iterations are those of
    all of them.
    """

    steps: int = 0
    retries: int = 0
    forced: int = 0
    newton_iterations: int = 0
    cg_iterations: int = 0
    simulated_seconds: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Way:
    """Settings by which a motion is advanced.

    Attributes
    ----------
    integrator
        How a time step is made.
    ask
        Returns the request of a stage of a length [s] that ends at a time [s].
    prepare
        Called before every step with the time at which it starts and its length [s].
    stretch
        Largest stretch of the cloth now.
    driven_speed
        Speed of what drives the cloth [m/s]: it may be faster than the cloth is yet.
    """

    integrator: Integrator
    ask: Callable[[float, float], StepRequest]
    prepare: Callable[[float, float], None] = lambda start, length: None
    stretch: Callable[[], float] = lambda: 0.0
    driven_speed: float = 0.0


def advance(
    stepper: ClothStepper, way: Way, sizes: StepSizes, span: tuple[float, float], counts: StepCounts
) -> Iterator[StepOutcome]:
    """Advance a stepper over `span`, its start and length [s]; yield the outcomes of steps that are kept."""
    since, seconds = span
    left = seconds
    while left > ROUNDING * seconds:
        speed = max(float(np.linalg.norm(stepper.v, axis=1).max()), way.driven_speed)
        h = sizes.next(left, speed)
        way.prepare(since + seconds - left, h)
        before, saved = way.stretch(), stepper.save()
        outcome = way.integrator(stepper, h, _asker(way, since + seconds - left, h))
        counts.newton_iterations += outcome.newton_iterations
        counts.cg_iterations += outcome.cg_iterations
        rise = way.stretch() - before
        if not sizes.keeps(h, outcome, rise):
            counts.retries += 1
            stepper.restore(saved)
            continue
        counts.forced += sizes.forced(outcome, rise)
        counts.steps += 1
        counts.simulated_seconds += h
        left -= h
        yield outcome


def _asker(way: Way, since: float, h: float) -> Ask:
    """Return what asks for stages of a step of h [s] from a time [s]."""
    return lambda length, share: way.ask(length, since + share * h)
