"""Stretch of a piece of yarn between two crossings.

With a the distance of the crossings, h the mean of its wave heights there (0 where it does not change sides),
s the rest length between them and l = sqrt(a^2 + h^2):

    E = k_s s/2 (l/s - 1)^2
"""

import numpy as np

from toile.engine.swatch.net import SIDES, Net
from toile.engine.swatch.terms import Terms, gradient
from toile.geometry.arrays import Float, Int


def waves(net: Net, state: Float, crossings: Int, axis: Int) -> Float:
    """Return wave heights of yarns at crossings [m], shape of `crossings`; axis: that of each row."""
    sign = np.array(SIDES)[axis].reshape(-1, *(1,) * (crossings.ndim - 1))
    return np.asarray(net.half_height + sign * state[net.slide(crossings), 2])


def piece_terms(net: Net, state: Float) -> Terms:
    """Return the stretch of all pieces; the four numbers of an element are e = x_b - x_a and h, then s."""
    a, b, axis = net.pieces[:, 0], net.pieces[:, 1], net.piece_axis
    count = len(axis)
    rows = np.arange(count)
    q = _vectors(net, state)
    rest = state[net.slide(b), axis] - state[net.slide(a), axis]
    length = np.sqrt((q * q).sum(axis=1))
    unit = q / length[:, None]
    stiffness = net.of_axis("stiffness", axis)
    tension = stiffness * (length / rest - 1.0)
    jacobian = np.zeros((count, 5, 12))
    jacobian[:, :3, 0:3], jacobian[:, :3, 3:6] = -np.eye(3), np.eye(3)
    share = np.where(net.piece_rises, 0.5 * np.array(SIDES)[axis], 0.0)
    jacobian[:, 3, 8], jacobian[:, 3, 11] = share, share
    jacobian[rows, 4, 6 + axis], jacobian[rows, 4, 9 + axis] = -1.0, 1.0
    slope = np.empty((count, 5))
    slope[:, :4] = tension[:, None] * unit
    slope[:, 4] = 0.5 * stiffness * (1.0 - (length / rest) ** 2)
    hessian = np.empty((count, 5, 5))
    square = unit[:, :, None] * unit[:, None, :]
    # A piece that is pushed would buckle: that part of the Hessian is left out.
    held = np.maximum(tension, 0.0) / length
    hessian[:, :4, :4] = (stiffness / rest - held)[:, None, None] * square + held[:, None, None] * np.eye(4)
    hessian[:, :4, 4] = hessian[:, 4, :4] = -(stiffness * length / rest**2)[:, None] * unit
    hessian[:, 4, 4] = stiffness * length**2 / rest**3
    lift = np.zeros((count, 4))
    lift[:, :2] = np.where(net.piece_rises, 0.5 * slope[:, 3], 0.0)[:, None]
    energy = 0.5 * stiffness * rest * (length / rest - 1.0) ** 2
    nodes = np.stack([a, b, net.slide(a), net.slide(b)], axis=1)
    return Terms(nodes, energy, jacobian, slope, hessian, lift)


def stretched_beyond(net: Net, state: Float, step: Float) -> Float:
    """Return forces of what a step stretches pieces by beyond its linear part, shape (2 n, 3).

    They act along the pieces as these lie before the step.
    """
    one, there = piece_terms(net, state), state + step
    a, b, axis = net.pieces[:, 0], net.pieces[:, 1], net.piece_axis
    q = _vectors(net, state)
    length = np.sqrt((q * q).sum(axis=1))
    unit = q / length[:, None]
    new = _vectors(net, there)
    beyond = np.sqrt((new * new).sum(axis=1)) - length - (unit * (new - q)).sum(axis=1)
    rest = state[net.slide(b), axis] - state[net.slide(a), axis]
    force = (net.of_axis("stiffness", axis) / rest * beyond)[:, None] * unit
    return gradient([one._replace(gradient=np.pad(force, ((0, 0), (0, 1))))], len(state))


def _vectors(net: Net, state: Float) -> Float:
    """Return the vectors e = x_b - x_a and, last, the wave heights h of pieces, shape (P, 4)."""
    q = np.empty((len(net.pieces), 4))
    q[:, :3] = state[net.pieces[:, 1]] - state[net.pieces[:, 0]]
    q[:, 3] = np.where(net.piece_rises, waves(net, state, net.pieces, net.piece_axis).mean(axis=1), 0.0)
    return q
