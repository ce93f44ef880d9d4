"""Cloth without contact as integrators see it: masses, forces, and what an implicit stage minimises.

The mass-spring cloth and the triangle cloth are two lists of forces under one class. A stage minimises

    1/(2 h^2) |x - y|_M^2  +  E(x)  +  h/2 v . D v,    v = (x - origin)/h

with E elastic and gravitational energy. Damping D and the drag and normals of wind are those of one place and
time (`lag`), so they are quadratic in x.
"""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from toile.engine.forces.bend import Bending
from toile.engine.forces.wind import Wind
from toile.engine.solve.assembly import scatter_gradients, scatter_hessians
from toile.engine.solve.block_pattern import BlockPattern
from toile.engine.solve.cg import CgResult, solve
from toile.engine.solve.linear_system import LinearSystem
from toile.engine.solve.preconditioner.base import Preconditioner
from toile.engine.solve.preconditioner.choice import make_preconditioner
from toile.engine.step.stages import Stage
from toile.geometry.arrays import Bool, Float, Int


class ElementForce(Protocol):
    """A force of elements of k nodes that derives from an energy.

    Attributes
    ----------
    element_gradient, element_hessian
        Gradients [N], shape (e, k, 3), and positive semi-definite blocks in the order of `node_pairs(k)`
        [N/m].
    """

    element_gradient: Float
    element_hessian: Float

    def energy(self, x: Float) -> float:
        """Energy [J] at node positions x [m], shape (n, 3)."""

    def evaluate_gradient(self, x: Float) -> None:
        """Fill the gradients."""

    def evaluate(self, x: Float) -> None:
        """Fill gradients and Hessians."""


class ElementDamping(Protocol):
    """Damping of elements of k nodes: blocks in the order of `node_pairs(k)` [N s/m]."""

    element_damping: Float

    def evaluate(self, x: Float) -> None:
        """Fill the blocks at node positions x [m], shape (n, 3)."""


class Place(NamedTuple):
    """Node positions [m], what a stage minimises there [J], and the gradient of bending [N].

    Shapes (n, 3); the last is zero-dimensional without bending. It is kept because its product is dear.
    """

    positions: Float
    potential: float
    bending: Float


class Elements:
    """Elements with one force and perhaps damping; `nodes` has shape (e, k)."""

    def __init__(self, nodes: Int, force: ElementForce, damping: ElementDamping | None = None) -> None:
        self.nodes = nodes
        self.force = force
        self.damping = damping


class Dynamics:
    """Masses and forces of one topology, with the matrix that goes with them.

    Attributes
    ----------
    mass
        Of every node [kg], shape (n,).
    pinned
        Nodes that do not move, shape (n,).
    """

    def __init__(
        self,
        mass: Float,
        pinned: Bool,
        elements: Sequence[Elements],
        *,
        gravity: float = 9.81,
        bending: Bending | None = None,
        wind: Wind | None = None,
    ) -> None:
        """Build for masses [kg] and pins, shapes (n,), and forces; gravity [m/s^2] acts along -y."""
        self.mass = mass
        self.pinned = pinned
        self._elements = elements
        self._weight: Float = gravity * mass
        self._mobility: Float = np.where(pinned, 0.0, 1.0 / mass)
        self._bending = bending
        self._wind = wind
        pattern = BlockPattern(len(mass), [each.nodes for each in elements])
        self.system = LinearSystem(pattern, None if bending is None else bending.stiffness)
        self._preconditioner: Preconditioner = make_preconditioner(self.system)
        self._blocks = pattern.zeros()
        self._damping: Float | None = None
        if any(each.damping is not None for each in elements):
            self._damping = pattern.zeros()

    def drifted(self, x: Float, v: Float, h: float) -> Float:
        """Return where nodes at x [m] get to within h [s], shape (n, 3); pins stay."""
        return np.where(self.pinned[:, None], x, x + h * v)

    def lag(self, x: Float, seconds: float) -> None:
        """Take the directions of damping and wind at positions x [m], (n, 3), and the air's speed then."""
        if self._wind is not None:
            self._wind.begin(x, seconds)
        if self._damping is None:
            return
        self._damping[:] = 0.0
        for each, slots in zip(self._elements, self.system.pattern.slots, strict=True):
            if each.damping is not None:
                each.damping.evaluate(x)
                scatter_hessians(slots, each.damping.element_damping, self._damping)

    def energy(self, x: Float) -> float:
        """Elastic and gravitational energy [J] at node positions x [m], shape (n, 3)."""
        total = self._element_energy(x)
        return total if self._bending is None else total + self._bending.energy(x)

    def total_energy(self, x: Float, v: Float) -> float:
        """Kinetic and potential energy [J] at positions [m] and velocities [m/s], shapes (n, 3)."""
        return 0.5 * float(self.mass @ (v * v).sum(axis=1)) + self.energy(x)

    def acceleration(self, x: Float, v: Float, seconds: float) -> Float:
        """Acceleration [m/s^2] at positions, velocities, shapes (n, 3), and a time; zero at pins."""
        self.lag(x, seconds)
        gradient = np.zeros_like(x)
        gradient[:, 1] = self._weight
        for each in self._elements:
            each.force.evaluate_gradient(x)
            scatter_gradients(each.nodes, each.force.element_gradient, gradient)
        if self._bending is not None:
            gradient += self._bending.gradient(x)
        self._add_resistance(v, gradient)
        return np.asarray(-self._mobility[:, None] * gradient)

    def place(self, stage: Stage, x: Float) -> Place:
        """Return what the stage minimises at node positions x [m], shape (n, 3); `lag` comes first."""
        away = x - stage.inertial
        total = 0.5 / stage.h**2 * float(self.mass @ (away * away).sum(axis=1)) + self._element_energy(x)
        v = stage.velocity_at(x)
        if self._damping is not None:
            total += 0.5 * stage.h * float(np.vdot(v, self._damped(v)))
        if self._wind is not None:
            total += self._wind.energy(v, stage.h)
        bending: Float = np.zeros(())
        if self._bending is not None:
            bending, energy = self._bending.gradient_and_energy(x)
            total += energy
        return Place(x, total, bending)

    def linearise(self, stage: Stage, place: Place) -> Float:
        """Set the matrix at a place of the stage; return the gradient of its potential [N], shape (n, 3)."""
        x = place.positions
        inertia = self.mass / stage.h**2
        gradient = inertia[:, None] * (x - stage.inertial) + place.bending
        gradient[:, 1] += self._weight
        blocks = self._blocks
        if self._damping is None:
            blocks[:] = 0.0
        else:
            np.multiply(self._damping, 1.0 / stage.h, out=blocks)
        for each, slots in zip(self._elements, self.system.pattern.slots, strict=True):
            each.force.evaluate(x)
            scatter_gradients(each.nodes, each.force.element_gradient, gradient)
            scatter_hessians(slots, each.force.element_hessian, blocks)
        if self._wind is not None:
            blocks[self.system.pattern.rank] += self._wind.drag / stage.h
        self._add_resistance(stage.velocity_at(x), gradient)
        gradient[self.pinned] = 0.0
        self.system.update(blocks, inertia, pinned=self.pinned)
        return gradient

    def newton_move(self, gradient: Float, x: Float, tolerance: float) -> CgResult:
        """Solve the system that `linearise` set at x for the Newton displacement [m], shape (n, 3)."""
        self._preconditioner.update(self.system, x)
        return solve(self.system, -gradient, self._preconditioner, tolerance=tolerance)

    def _damped(self, v: Float) -> Float:
        """D v [N], shape (n, 3)."""
        assert self._damping is not None
        pattern = self.system.pattern
        product = np.empty_like(v)
        pattern.multiply(self._damping, v[pattern.order], np.zeros((len(v), 4)), product)
        return product[pattern.rank]

    def _element_energy(self, x: Float) -> float:
        """Energy [J] of weight and elements."""
        return float(self._weight @ x[:, 1]) + sum(each.force.energy(x) for each in self._elements)

    def _add_resistance(self, v: Float, gradient: Float) -> None:
        """Add minus the forces [N] of damping and wind at velocities [m/s]."""
        if self._damping is not None:
            gradient += self._damped(v)
        if self._wind is not None:
            gradient += self._wind.gradient(v)
