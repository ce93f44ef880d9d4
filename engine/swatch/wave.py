"""Bending of a yarn by its waves, at a crossing b between a and c.

With h its wave height at b, m the mean distance to the neighbours towards which it changes sides, t how many
these are, w the rest length from a to c, and theta_0 its turn at rest:

    E = k_b (t alpha - theta_0)^2 / w,  alpha = atan(h / m)
"""

import numpy as np

from toile.engine.swatch.net import SIDES, Net
from toile.engine.swatch.piece import waves
from toile.engine.swatch.terms import Terms, place_columns, without_negative
from toile.geometry.arrays import Float


def wave_terms(net: Net, state: Float) -> Terms:
    """Return the bending of all waves; the numbers of an element are m, h and w."""
    turning = net.bend_rises.any(axis=1)
    (a, b, c), axis = net.bends[turning].T, net.bend_axis[turning]
    rises = net.bend_rises[turning].astype(float)
    count = len(axis)
    rows = np.arange(count)
    before, behind = state[b] - state[a], state[c] - state[b]
    lengths = np.stack([np.sqrt((e * e).sum(axis=1)) for e in (before, behind)], axis=1)
    turns = rises.sum(axis=1)
    share = rises / turns[:, None]
    m = (share * lengths).sum(axis=1)
    h = waves(net, state, b, axis)
    w = state[net.slide(c), axis] - state[net.slide(a), axis]
    square = m * m + h * h
    slope = np.array([strand.set * strand.slope for strand in net.strands])[axis]
    angle = turns * (np.arctan2(h, m) - slope)
    stiffness = net.of_axis("bending", axis)
    by_angle = 2.0 * stiffness * turns * angle / w
    gradient = np.stack(
        [-by_angle * h / square, by_angle * m / square, -stiffness * (angle / w) ** 2], axis=1
    )
    # By (angle, w) the energy is convex; what the curvature of the angle adds is cut where it is negative.
    towards = np.stack([-h / square, m / square], axis=1)
    hessian = np.empty((count, 3, 3))
    hessian[:, :2, :2] = (2.0 * stiffness * turns**2 / w)[:, None, None] * (
        towards[:, :, None] * towards[:, None, :]
    )
    bent = np.array([[2.0 * m * h, h * h - m * m], [h * h - m * m, -2.0 * m * h]]) / square**2
    hessian[:, :2, :2] += by_angle[:, None, None] * bent.transpose(2, 0, 1)
    hessian[:, :2, 2] = hessian[:, 2, :2] = -(by_angle / w)[:, None] * towards
    hessian[:, 2, 2] = 2.0 * stiffness * angle**2 / w**3
    jacobian = np.zeros((count, 3, 18))
    unit = [share[:, k, None] * e / lengths[:, k, None] for k, e in enumerate((before, behind))]
    place_columns(jacobian, 0, 0, -unit[0])
    place_columns(jacobian, 0, 1, unit[0] - unit[1])
    place_columns(jacobian, 0, 2, unit[1])
    jacobian[:, 1, 14] = np.array(SIDES)[axis]
    jacobian[rows, 2, 9 + axis], jacobian[rows, 2, 15 + axis] = -1.0, 1.0
    lift = np.zeros((count, 6))
    lift[:, 1] = gradient[:, 1]
    nodes = np.stack([a, b, c, net.slide(a), net.slide(b), net.slide(c)], axis=1)
    return Terms(nodes, stiffness * angle**2 / w, jacobian, gradient, without_negative(hessian), lift)
