"""Stitches: springs between the two nodes of a seam whose rest length shrinks to zero."""

import numpy as np

from toile.geometry.arrays import Float, Int


class Stitches:
    """Springs E = k/2 (|d| - L)^2 with d the vector between the two nodes.

    Attributes
    ----------
    pairs
        Node pairs, shape (s, 2).
    element_gradient
        Gradient per end [N], shape (s, 2, 3).
    element_hessian
        Positive semi-definite blocks (0,0), (1,1), (0,1) [N/m], shape (s, 3, 3, 3).
    """

    def __init__(self, pairs: Int) -> None:
        self.pairs = pairs
        self.element_gradient = np.zeros((len(pairs), 2, 3))
        self.element_hessian = np.zeros((len(pairs), 3, 3, 3))

    def energy(self, x: Float, length: Float, stiffness: float) -> float:
        """Energy [J] at node positions x for rest lengths [m], shape (s,), and stiffness [N/m]."""
        d = np.linalg.norm(x[self.pairs[:, 0]] - x[self.pairs[:, 1]], axis=1)
        return float(0.5 * stiffness * np.sum((d - length) ** 2))

    def evaluate(self, x: Float, length: Float, stiffness: float) -> None:
        """Fill element_gradient and element_hessian; compression's negative part is clamped to zero."""
        d = x[self.pairs[:, 0]] - x[self.pairs[:, 1]]
        distance = np.linalg.norm(d, axis=1)
        ratio = np.where(distance > 0.0, length / np.maximum(distance, 1e-300), 0.0)
        pull = stiffness * (1.0 - ratio)[:, None] * d
        self.element_gradient[:, 0] = pull
        self.element_gradient[:, 1] = -pull
        n = d / np.maximum(distance, 1e-300)[:, None]
        along = n[:, :, None] * n[:, None, :]
        across = np.where(length > 0.0, np.maximum(1.0 - ratio, 0.0), 1.0)[:, None, None]
        block = stiffness * (np.where(length > 0.0, 1.0, across[:, 0, 0])[:, None, None] * along
                             + across * (np.eye(3) - along))  # fmt: skip
        self.element_hessian[:, 0] = block
        self.element_hessian[:, 1] = block
        self.element_hessian[:, 2] = -block
