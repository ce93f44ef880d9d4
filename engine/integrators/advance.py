"""Steps of one size, or of the size that an error per second allows."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from toile.engine.dynamics import Dynamics
from toile.engine.integrators.motion import Integrator, Motion
from toile.engine.integrators.newton import NewtonOptions

CAUTION = 0.9
"""Share of the size that the estimate allows."""
SHRINK, GROW = 0.3, 2.0
"""Limits of the change from one step to the next."""
REPEATED = 2.0
"""A step of more than this many times the allowed error is undone."""
SOLVED = 10.0
"""Tolerance of the stages over the rate of errors: above it the estimate sees the solver and not the step."""
LOOSEST = 0.1
"""Largest tolerance [m/s]: with stages solved to 1 m/s a swinging sheet gained energy."""
HELD = 1.2
"""Sizes grow only by more than this: a change makes BDF2 less exact."""


class Advance(NamedTuple):
    """The motion after some time, and what that took.

    steps, repeated: steps kept, and steps undone. newton, cg: iterations of both. unsolved: steps that were
    kept although the solver did not reach its tolerance.
    """

    motion: Motion
    steps: int
    repeated: int
    newton: int
    cg: int
    unsolved: int


@dataclass(frozen=True, kw_only=True)
class ErrorControl:
    """How step sizes follow the error.

    Attributes
    ----------
    rate
        Error of positions that steps may add per second, root mean square over the nodes [m/s].
    first, shortest, longest
        Step sizes [s]. Steps of the shortest size are kept as they are.
    """

    rate: float
    first: float = 1e-3
    shortest: float = 1e-5
    longest: float = 1.0 / 24.0

    @property
    def newton(self) -> NewtonOptions:
        """How exactly stages must be solved for the estimate to hold."""
        return NewtonOptions(tolerance=min(SOLVED * self.rate, LOOSEST))


def advance(integrator: Integrator, dynamics: Dynamics, motion: Motion, seconds: float, h: float) -> Advance:
    """Advance by a time [s] in equal steps of about h [s].

    Raises FloatingPointError where the motion has exploded.
    """
    count = max(1, round(seconds / h))
    newton = cg = unsolved = 0
    for _ in range(count):
        done = integrator.step(dynamics, motion, seconds / count)
        motion = done.motion
        newton, cg, unsolved = newton + done.newton, cg + done.cg, unsolved + (not done.converged)
        if not np.isfinite(motion.positions[-1]).all():
            raise FloatingPointError(
                f"positions are not finite after {motion.seconds:g} s in steps of {h:g} s"
            )
    return Advance(motion, count, 0, newton, cg, unsolved)


def advance_within(
    integrator: Integrator, dynamics: Dynamics, motion: Motion, seconds: float, control: ErrorControl
) -> Advance:
    """Advance by a time [s] in steps as long as the error allows, for an integrator that estimates it.

    A step that is not solved, or whose error is far too large, is undone and tried again shorter. One without
    an estimate (the first) is kept.
    """
    end = motion.seconds + seconds
    h = control.first
    steps = repeated = newton = cg = unsolved = 0
    while end - motion.seconds > 1e-9 * seconds:
        left = end - motion.seconds
        # the last steps share what is left: a tiny one would spoil the sizes after it
        taken = left if left <= h else min(h, 0.5 * left) if left < 2.0 * h else h
        done = integrator.step(dynamics, motion, taken)
        newton, cg = newton + done.newton, cg + done.cg
        allowed = control.rate * taken
        factor = 1.0
        if done.error is not None:
            # the error of a step grows with its third power, what it may be with the first
            factor = CAUTION * (allowed / max(done.error, 1e-300)) ** 0.5
        bad = not done.converged or (done.error is not None and done.error > REPEATED * allowed)
        if bad and taken > control.shortest:
            repeated += 1
            h = max(control.shortest, taken * min(0.5, max(SHRINK, factor)))
            continue
        unsolved += not done.converged
        steps += 1
        motion = done.motion
        if factor < 1.0 or factor > HELD:
            h = min(control.longest, max(control.shortest, taken * min(GROW, max(SHRINK, factor))))
        else:
            h = taken
    return Advance(motion, steps, repeated, newton, cg, unsolved)
