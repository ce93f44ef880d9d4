"""Control of step sizes: by the rise of the largest stretch, or by the error per second."""

from dataclasses import dataclass
from math import ceil, inf

from toile.engine.step.options import StepOutcome

GROWTH = 1.2
"""Factor on the step size after a step that went well."""
CAUTION = 0.9
"""Share of the size that the estimate of the error allows."""
SHRINK, GROW = 0.3, 2.0
"""Limits of the change from one step to the next where the error decides."""
REPEATED = 2.0
"""A step of more than this many times the allowed error is undone."""
STUBBORN, TOO_MUCH = 0.7, 3.0
"""A step that is repeated at half the size and still raises the stretch by this share of what it did is kept,
up to so many times the rise that undoes others."""
ROUNDING = 1e-9
"""Share of a size that is rounding."""
HELD = 1.2
"""Sizes that follow the error grow only by more than this: a change makes BDF2 less exact."""


@dataclass(frozen=True, kw_only=True)
class StepLimits:
    """Limits of steps.

    Attributes
    ----------
    longest, shortest
        Step sizes [s]. Steps of no more than the shortest size are kept as they are.
    motion_max
        Longest motion of a node in one step at its present speed [m].
    stretch_rise
        A step that raises the largest stretch of the cloth by more than this is undone.
    error_rate
        Error of positions that steps may add per second, root mean square over the nodes [m/s], for
        integrators that estimate it.
    """

    longest: float
    shortest: float = 0.0
    motion_max: float = inf
    stretch_rise: float = inf
    error_rate: float = inf


class StepSizes:
    """The step size of a motion, adapted after every step.

    Attributes
    ----------
    h
        Size that the next step may have [s].
    """

    def __init__(self, limits: StepLimits, first: float) -> None:
        self.limits = limits
        self.h = first
        self._undone: tuple[float, float] | None = None

    def next(self, left: float, speed: float) -> float:
        """Return the size of a step [s] where `left` [s] are to go, in steps as equal as the size allows.

        `speed` is that of the fastest node [m/s].
        """
        wished = min(self.h, self.limits.motion_max / max(speed, 1e-300))
        return left / ceil(left / wished - ROUNDING)

    def keeps(self, h: float, outcome: StepOutcome, rise: float) -> bool:
        """Judge a step of h [s] that raised the largest stretch so far: whether it is kept.

        One that is not solved, or whose stretch or error is too large, is undone and tried again shorter.
        Where a shorter one stretches the cloth nearly as much, as when a new contact pushes a node to its
        radius, that one is kept, and the next has the size of before: shorter ones do not help.
        """
        limits, undone = self.limits, self._undone
        self._undone = None
        factor = inf
        if outcome.error is not None and limits.error_rate < inf:
            # The error of a step grows with its third power, what it may be with the first.
            factor = CAUTION * (limits.error_rate * h / max(outcome.error, 1e-300)) ** 0.5
        wrong = factor < CAUTION / REPEATED**0.5
        good = outcome.converged and rise <= limits.stretch_rise and not wrong
        if not good:
            if (
                outcome.converged and not wrong and undone is not None
                and STUBBORN * undone[1] <= rise <= TOO_MUCH * limits.stretch_rise
            ):  # fmt: skip
                self.h = undone[0]
                return True
            # A share of the time left may exceed the wished size by rounding.
            if h > limits.shortest * (1.0 + 10.0 * ROUNDING):
                self.h = h * min(0.5, max(SHRINK, factor))
                self._undone = (h, rise)
                return False
            return True
        if limits.error_rate < inf:
            if factor < 1.0 or factor > HELD:
                self.h = min(limits.longest, h * min(GROW, max(SHRINK, factor)))
            else:
                self.h = h
        elif rise <= 0.5 * limits.stretch_rise:
            self.h = min(GROWTH * self.h, limits.longest)
        return True

    def forced(self, outcome: StepOutcome, rise: float) -> bool:
        """Whether a step that was kept should not have been: it was as short as allowed."""
        return not outcome.converged or rise > self.limits.stretch_rise
