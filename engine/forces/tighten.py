"""Tightening: springs of rest length zero that pull tangled cloth smooth, as a minimal surface.

A patch of cloth that crosses itself is contracted within its surroundings until nothing crosses; then the
springs go and it unfolds again, now solid. The discrete Dirichlet energy k/2 sum |x_i - x_j|^2.
"""

import numpy as np

from toile.engine.linear_system import ContactStencils
from toile.geometry.arrays import Bool, Float, Int


class Tightening:
    """Springs on all edges whose two nodes are marked.

    Attributes
    ----------
    edges
        Node pairs, shape (e, 2).
    """

    def __init__(self, faces: Int, marked: Bool) -> None:
        sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        sides = np.unique(np.sort(sides, axis=1), axis=0)
        self.edges = np.ascontiguousarray(sides[marked[sides].all(axis=1)], np.int32)

    def energy(self, x: Float, stiffness: float) -> float:
        """Energy [J] for spring stiffness [N/m]."""
        return float(0.5 * stiffness * np.sum((x[self.edges[:, 0]] - x[self.edges[:, 1]]) ** 2))

    def add_gradient(self, x: Float, stiffness: float, gradient: Float) -> None:
        """Add the gradient [N] to shape (n, 3)."""
        pull = stiffness * (x[self.edges[:, 0]] - x[self.edges[:, 1]])
        np.add.at(gradient, self.edges[:, 0], pull)
        np.subtract.at(gradient, self.edges[:, 1], pull)

    def stencils(self, stiffness: float) -> ContactStencils:
        """Return the Hessian as two-node stencils."""
        count = len(self.edges)
        nodes = np.full((count, 4), -1, np.int32)
        nodes[:, :2] = self.edges
        weights = np.zeros((count, 4))
        weights[:, 0] = 1.0
        weights[:, 1] = -1.0
        return ContactStencils(nodes, weights, np.tile(stiffness * np.eye(3), (count, 1, 1)))
