"""Energies of the elements of a net by a few numbers each, and their sums over its nodes.

An element's energy depends on its nodes through M numbers q. With J = dq/dz, its gradient is J^T dE/dq, and
J^T H J stands for its Hessian, where H is that of E by q without its negative part. What the curvature of q
adds is left out; where it counts, q is chosen so that J is constant.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from toile.engine.solve.assembly import node_pairs, scatter_gradients, scatter_hessians
from toile.geometry.arrays import Bool, Float, Int

AT_ONCE = 4096
"""Elements whose blocks are made at a time: what lies in memory meanwhile stays small."""


class Terms(NamedTuple):
    """Elements of one kind.

    Attributes
    ----------
    nodes
        Shape (E, k).
    energy
        [J], shape (E,).
    jacobian
        J, shape (E, M, 3 k).
    gradient, hessian
        By the M numbers, shapes (E, M) and (E, M, M).
    lift
        Force [N] by which each element presses the two yarns of a crossing together, shape (E, k) by the
        places of its crossings, zero at other nodes; None: it does not depend on waves.
    rows
        Which of their kind these elements are, shape (E,); None: all of them.
    """

    nodes: Int
    energy: Float
    jacobian: Float
    gradient: Float
    hessian: Float
    lift: Float | None = None
    rows: Int | None = None


def energy(terms: Sequence[Terms]) -> float:
    """Return the sum of the energies [J]."""
    return float(sum(one.energy.sum() for one in terms))


def gradient(terms: Sequence[Terms], node_count: int) -> Float:
    """Return the gradient over the nodes [N], shape (node_count, 3)."""
    total = np.zeros((node_count, 3))
    for one in terms:
        parts = np.matmul(one.gradient[:, None, :], one.jacobian)[:, 0]
        scatter_gradients(one.nodes, np.ascontiguousarray(parts.reshape(*one.nodes.shape, 3)), total)
    return total


def add_hessian(one: Terms, free: Bool, slots: Int, blocks: Float) -> None:
    """Add the Hessian of elements to the blocks of a matrix; numbers that are not free have none.

    free: shape (node_count, 3). slots: those of all elements of the kind, see `BlockPattern.slots`.
    """
    slots = slots if one.rows is None else np.ascontiguousarray(slots[one.rows])
    corners = one.nodes.shape[1]
    pairs = node_pairs(corners)
    rows, columns = [a for a, _ in pairs], [b for _, b in pairs]
    for first in range(0, len(one.nodes), AT_ONCE):
        part = slice(first, first + AT_ONCE)
        jacobian = one.jacobian[part] * free[one.nodes[part]].reshape(-1, 1, 3 * corners)
        whole = np.matmul(jacobian.transpose(0, 2, 1), np.matmul(one.hessian[part], jacobian))
        whole = whole.reshape(-1, corners, 3, corners, 3)
        scatter_hessians(slots[part], np.ascontiguousarray(whole[:, rows, :, columns].swapaxes(0, 1)), blocks)


def place_columns(jacobian: Float, number: int, node: int, values: Float) -> None:
    """Add derivatives of one of the M numbers by a node, shape (E, 3), to a Jacobian."""
    jacobian[:, number, 3 * node : 3 * node + 3] += values


def across(direction: Float, length: Float) -> Float:
    """Return how a direction turns with the vector it is of, (I - d d^T) / length, shape (E, 3, 3)."""
    return (np.eye(3) - direction[:, :, None] * direction[:, None, :]) / length[:, None, None]


def without_negative(hessian: Float) -> Float:
    """Return symmetric matrices without their negative parts, shape (E, M, M)."""
    values, vectors = np.linalg.eigh(hessian)
    return np.asarray((vectors * np.maximum(values, 0.0)[:, None, :]) @ vectors.transpose(0, 2, 1))
