"""Stitches: springs between the two nodes of a seam whose rest length shrinks to zero."""

import numpy as np

from toile.engine.forces.force import ElementForce, StepState
from toile.engine.solve.assembly import scatter_gradients
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float, Int


class Stitches(ElementForce):
    """Springs E = k/2 (|d| - L)^2 with d the vector between the two nodes, L a share of the first length.

    A step's request gives k, the share, and the longest elongation that pulls: beyond it the force stays what
    it is.

    Attributes
    ----------
    pairs
        Node pairs, shape (s, 2).
    first_length
        Length of every stitch when sewing began [m], shape (s,).
    element_gradient
        Gradient per end [N], shape (s, 2, 3).
    element_hessian
        Positive semi-definite blocks (0,0), (1,1), (0,1) [N/m], shape (s, 3, 3, 3).
    """

    elastic = False

    def __init__(self, pairs: Int, first_length: Float) -> None:
        self.pairs = self.nodes = pairs
        self.first_length = first_length
        self.element_gradient = np.zeros((len(pairs), 2, 3))
        self.element_hessian = np.zeros((len(pairs), 3, 3, 3))
        self._stiffness, self._reach = 0.0, np.inf
        self._wanted: Float = first_length

    def start_from(self, length: Float) -> None:
        """Take lengths [m], shape (s,), for those of the start."""
        self.first_length = length

    def begin(self, step: StepState, x: Float) -> bool:
        """Take stiffness, lengths and reach from the request; without stiffness stitches do not act."""
        request = step.request
        self._stiffness, self._reach = request.stitch_stiffness, request.stitch_reach
        self._wanted = np.asarray(self.first_length * request.stitch_share)
        return self._stiffness > 0.0

    def energy(self, x: Float) -> float:
        """Energy [J] at node positions x [m], shape (n, 3), in the step that began last."""
        extension = self._lengths(x) - self._wanted
        near = np.minimum(extension, self._reach)
        return float(self._stiffness * np.sum(near * (extension - 0.5 * near)))

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add the derivative of the energy [N] to an array of shape (n, 3)."""
        self.evaluate(x, self._target(x), self._stiffness)
        scatter_gradients(self.pairs, self.element_gradient, gradient)

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add gradient and projected Hessian at node positions x [m], shape (n, 3)."""
        self.add_gradient(x, gradient)
        hessian.add_elements(self.pairs, self.element_hessian)

    def _lengths(self, x: Float) -> Float:
        return np.asarray(np.linalg.norm(x[self.pairs[:, 0]] - x[self.pairs[:, 1]], axis=1))

    def _target(self, x: Float) -> Float:
        """Rest length of every stitch [m]: as wanted, but a blocked one pulls no harder than its reach."""
        return np.asarray(np.maximum(self._wanted, self._lengths(x) - self._reach))

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
