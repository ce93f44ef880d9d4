"""Holds: springs that keep nodes near a place, so that the garment closes where it was put."""

from abc import ABC, abstractmethod

import numpy as np

from toile.engine.forces.force import NodalForce, StepState
from toile.engine.solve.hessian import Hessian
from toile.engine.solve.linear_system import ContactStencils
from toile.geometry.arrays import Float, Int


class NodeSprings(NodalForce, ABC):
    """Springs E = k/2 sum_axis w_axis (x - target)^2 on single nodes; `begin` says what k is in a step.

    Attributes
    ----------
    held
        Held nodes, shape (k,).
    targets
        Where they are held [m], shape (k, 3); may be moved.
    axes
        Weight of each axis, shape (k, 3): (0, 1, 0) holds the height only.
    """

    def __init__(self, held: Int, targets: Float, axes: Float) -> None:
        self.held = held
        self.targets = targets
        self.axes = axes
        self._stiffness = 0.0

    @abstractmethod
    def begin(self, step: StepState, x: Float) -> bool:
        """Take the stiffness k [N/m] of a step, and tell whether the springs act in it."""

    def energy(self, x: Float) -> float:
        """Energy [J]."""
        return float(0.5 * self._stiffness * np.sum(self.axes * (x[self.held] - self.targets) ** 2))

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add the gradient [N] to shape (n, 3)."""
        np.add.at(gradient, self.held, self._stiffness * self.axes * (x[self.held] - self.targets))

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add gradient and Hessian."""
        self.add_gradient(x, gradient)
        hessian.add_stencils(self.stencils())

    def stencils(self) -> ContactStencils:
        """Return the Hessian as single-node stencils."""
        count = len(self.held)
        nodes = np.full((count, 4), -1, np.int32)
        nodes[:, 0] = self.held
        weights = np.zeros((count, 4))
        weights[:, 0] = 1.0
        block = np.zeros((count, 3, 3))
        block[:, np.arange(3), np.arange(3)] = self._stiffness * self.axes
        return ContactStencils(nodes, weights, block)


class Holds(NodeSprings):
    """Nodes held near a place as strongly as a step asks for."""

    def begin(self, step: StepState, x: Float) -> bool:
        """Take the stiffness [N/m] from the request: without any nothing is held."""
        self._stiffness = step.request.hold_stiffness
        return self._stiffness > 0.0


class SewingHolds(Holds):
    """Holds of a garment about to be sewn.

    Stitched nodes are held at the mean start place of the nodes they will join, labelled edges
    (waistbands, collars, straps) at their height. While `approach` is 1 a stitched node's target lies
    in the plane its panel starts in, so that neighbouring panels that overlap slide clear of each
    other before they meet; at 0 it is the meeting place.
    """

    def __init__(self, x: Float, normals: Float, weld: Int, stitches: Int, held: Int) -> None:
        sewn = np.unique(stitches).astype(np.int32)
        heights = np.setdiff1d(held, sewn).astype(np.int32)
        count = np.maximum(np.bincount(weld[sewn], minlength=int(weld.max(initial=0)) + 1), 1)
        means = [np.bincount(weld[sewn], weights=x[sewn, k], minlength=len(count)) / count for k in range(3)]
        self._meeting = np.concatenate([np.stack(means, axis=1)[weld[sewn]], x[heights]])
        nodes = np.concatenate([sewn, heights])
        normal = normals[nodes]
        self._offset = normal * np.sum(normal * (x[nodes] - self._meeting), axis=1, keepdims=True)
        axes = np.concatenate([np.ones((len(sewn), 3)), np.tile([0.0, 1.0, 0.0], (len(heights), 1))])
        super().__init__(nodes, self._meeting + self._offset, axes)

    def approach(self, share: Float) -> None:
        """Set how far along its panel's normal each node's target still is from the meeting place.

        `share` is 1 at the start and 0 at the meeting place, one value per node of the cloth, shape (n,).
        """
        self.targets = self._meeting + share[self.held, None] * self._offset
