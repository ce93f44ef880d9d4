"""Backtracking line search on the function that a step minimises."""

from collections.abc import Callable

import numpy as np

from toile.geometry.arrays import Float

SUFFICIENT = 1e-4
"""Share of the decrease that the slope promises with which a displacement is accepted (Armijo 1966)."""
ROUNDING = 1e-13
"""Changes of the minimised sum below this share of its terms say nothing."""
HALVINGS = 30


def accepted_share(potential: Callable[[Float], float], place: Float, move: Float, gradient: Float) -> float:
    """Return the first of the shares 1, 1/2, 1/4 ... of a move that lowers the potential enough; 0 if none.

    Parameters
    ----------
    potential
        What is minimised [J], at positions [m], shape (n, 3).
    place, move
        Where it was linearised, and Newton's displacement from there [m], shapes (n, 3).
    gradient
        Its gradient at `place` [N], shape (n, 3).
    """
    slope = float(np.vdot(gradient, move))
    here = potential(place)
    share = 1.0
    for _ in range(HALVINGS):
        if potential(place + share * move) <= here + SUFFICIENT * share * slope + ROUNDING * abs(here):
            return share
        share *= 0.5
    return 0.0
