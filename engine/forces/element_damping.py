"""Damping of elements: forces in proportion to the velocities of their nodes.

Over a step of h the dissipation potential is h/2 v . D v with v = (x - origin)/h and D the blocks at the
positions that the step starts from: quadratic in the positions, its gradient D v, its Hessian D/h.
"""

from abc import ABC, abstractmethod

import numpy as np

from toile.engine.forces.force import StepState
from toile.engine.solve.assembly import node_pairs, scatter_gradients
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float, Int


class ElementDamping(ABC):
    """Damping of elements of k nodes; a subclass fills the blocks.

    Attributes
    ----------
    nodes
        Of every element, shape (e, k).
    element_damping
        Positive semi-definite blocks in the order of `node_pairs(k)` [N s/m], shape (e, k (k + 1) / 2, 3, 3).
    """

    elastic = False
    constant_matrix = None

    def __init__(self, nodes: Int) -> None:
        self.nodes = nodes
        corners = nodes.shape[1]
        self.element_damping = np.zeros((len(nodes), corners * (corners + 1) // 2, 3, 3))
        self._step: StepState | None = None

    @abstractmethod
    def evaluate(self, x: Float) -> None:
        """Fill the blocks at node positions x [m], shape (n, 3)."""

    def begin(self, step: StepState, x: Float) -> bool:
        """Take the directions of damping at x; it always acts."""
        self.evaluate(x)
        self._step = step
        return True

    def energy(self, x: Float) -> float:
        """Dissipation potential of the step [J]."""
        power = np.einsum("eki,eki->e", self._at_corners(x), self._resistance(x))
        return 0.5 * float(self._element_h() @ power)

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add minus the damping force [N] to an array of shape (n, 3)."""
        scatter_gradients(self.nodes, self._resistance(x), gradient)

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add the force and D/h. Of nodes with different step sizes the shorter one counts."""
        self.add_gradient(x, gradient)
        hessian.add_elements(self.nodes, self.element_damping / self._element_h()[:, None, None, None])

    def _element_h(self) -> Float:
        assert self._step is not None
        return np.asarray(self._step.h[self.nodes].min(axis=1))

    def _at_corners(self, x: Float) -> Float:
        assert self._step is not None
        return np.asarray(self._step.velocity_at(x)[self.nodes])

    def _resistance(self, x: Float) -> Float:
        """D v of every element [N], shape (e, k, 3)."""
        v = self._at_corners(x)
        product = np.zeros_like(v)
        for (a, b), block in zip(node_pairs(v.shape[1]), self.element_damping.swapaxes(0, 1), strict=True):
            product[:, a] += np.einsum("eij,ej->ei", block, v[:, b])
            if a != b:
                product[:, b] += np.einsum("eji,ej->ei", block, v[:, a])
        return product
