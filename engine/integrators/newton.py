"""Projected Newton with backtracking on what a stage minimises."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from toile.engine.dynamics import Dynamics
from toile.engine.step.stages import Stage
from toile.geometry.arrays import Float

SUFFICIENT = 1e-4
"""Share of the decrease that the slope promises with which a displacement is accepted (Armijo 1966)."""
ROUNDING = 1e-13
"""Changes of the minimised sum below this share of its terms say nothing."""
HALVINGS = 30


@dataclass(frozen=True, kw_only=True)
class NewtonOptions:
    """How exactly stages are solved.

    Attributes
    ----------
    tolerance
        Largest displacement of the last iteration over the stage's step size [m/s].
    iterations
        Limit of the iterations.
    cg_tolerance
        Relative residual of the linear systems, in the preconditioner's norm.
    """

    tolerance: float = 1e-3
    iterations: int = 30
    cg_tolerance: float = 1e-2


class NewtonResult(NamedTuple):
    """Positions [m], (n, 3); iterations of Newton and of the linear solver; whether that sufficed."""

    positions: Float
    iterations: int
    cg: int
    converged: bool


def minimise(dynamics: Dynamics, stage: Stage, start: Float, options: NewtonOptions) -> NewtonResult:
    """Return the minimum of the stage's potential from `start` [m], shape (n, 3); `lag` comes first.

    The result is never higher than the start. Pins stay where they are at the start.
    """
    here = dynamics.place(stage, start)
    cg = 0
    for iteration in range(1, options.iterations + 1):
        gradient = dynamics.linearise(stage, here)
        solution = dynamics.newton_move(gradient, here.positions, options.cg_tolerance)
        cg += solution.iterations
        move = solution.solution
        slope = float(np.vdot(gradient, move))
        share = 1.0
        for _ in range(HALVINGS):
            there = dynamics.place(stage, here.positions + share * move)
            if there.potential <= here.potential + SUFFICIENT * share * slope + ROUNDING * abs(
                here.potential
            ):
                break
            share *= 0.5
        else:
            return NewtonResult(here.positions, iteration, cg, False)
        here = there
        if share == 1.0 and float(np.abs(move).max()) < options.tolerance * stage.h:
            return NewtonResult(here.positions, iteration, cg, True)
    return NewtonResult(here.positions, options.iterations, cg, False)
