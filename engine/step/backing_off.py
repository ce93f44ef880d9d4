"""Shortening of steps to equilibrium that only stretch the cloth."""

from collections.abc import Callable

import numpy as np

from toile.engine.forces.membrane import Membrane
from toile.geometry.arrays import Float

LOCAL_HALVINGS, HALVINGS = 6, 6
"""How often a step to equilibrium is shortened when it stretches the cloth more than forces pull it."""
TOLERATED = 0.2
"""Share of the membrane energy that a step may add without work."""
GREEDY = 0.01
"""Share of that energy from which a face holds back its nodes."""


def backed_off(
    membrane: Membrane, x: Float, move: Float, gradient: Float, safe: Callable[[Float], Float]
) -> Float:
    """Shorten a move while it takes more membrane energy than all forces do work along it.

    The guard cuts nodes one by one: what it leaves of a Newton step may stretch what was to be relaxed.
    Nodes of faces that take most of the energy are held back first, at last the whole cloth.

    Parameters
    ----------
    membrane
        The membrane as evaluated at the nodes.
    x, move
        Nodes and their safe displacements [m], shape (n, 3).
    gradient
        Gradient of the step's energy [N], shape (n, 3).
    safe
        Shortens displacements to safe ones.
    """
    before = membrane.element_energy.copy()
    total = float(before.sum())
    for attempt in range(LOCAL_HALVINGS + HALVINGS):
        work = max(-float(np.sum(gradient * move)), 0.0)
        taken = membrane.energy(x + move) - total
        if taken <= work + TOLERATED * total:
            break
        if attempt >= LOCAL_HALVINGS:
            move = 0.5 * move
            continue
        stretched = membrane.element_energy - before > GREEDY * taken
        factor = np.ones(len(move))
        factor[membrane.faces[stretched].ravel()] = 0.5
        move = safe(factor[:, None] * move)
    return move
