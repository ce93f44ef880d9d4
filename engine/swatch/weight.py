"""Weight of yarns: that of a piece hangs at the middle of its crossings."""

import numpy as np

from toile.engine.swatch.net import Net
from toile.geometry.arrays import Float


def weight_energy(net: Net, state: Float, gravity: Float) -> tuple[float, Float]:
    """Return the energy of all yarns in a field of gravity [J] and its gradient [N], shape (2 n, 3)."""
    a, b, axis = net.pieces[:, 0], net.pieces[:, 1], net.piece_axis
    mass = net.of_axis("linear_density", axis)
    rest = state[net.slide(b), axis] - state[net.slide(a), axis]
    middle = 0.5 * (state[a] + state[b]) @ gravity
    gradient = np.zeros_like(state)
    half = -0.5 * (mass * rest)[:, None] * gravity
    np.add.at(gradient, a, half)
    np.add.at(gradient, b, half)
    np.add.at(gradient, (net.slide(b), axis), -mass * middle)
    np.add.at(gradient, (net.slide(a), axis), mass * middle)
    return -float((mass * rest * middle).sum()), gradient
