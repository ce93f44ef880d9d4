"""The protocol of a force: an energy with derivatives, on nodes that it names.

`ClothStepper` keeps a plain list of forces. In every step it asks each whether it acts (`begin`), and in
every Newton iteration for its gradient and Hessian where the nodes are (`linearise`).
"""

from typing import Protocol

from scipy.sparse import csr_array

from toile.engine.forces.step_request import StepRequest
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float, Int


class StepState(Protocol):
    """The part of a step that a force may see.

    Attributes
    ----------
    request
        What the step is asked to do.
    h
        Step size of every node [s], shape (n,): nodes in contact may take another stage than free ones.
    start
        Where nodes are as it begins [m], shape (n, 3): forces are linearised where they may be foreseen.
    """

    @property
    def request(self) -> StepRequest:
        """The request of the step."""

    @property
    def h(self) -> Float:
        """Step size of every node [s], shape (n,)."""

    @property
    def start(self) -> Float:
        """Positions as the step begins [m], shape (n, 3)."""

    def velocity_at(self, x: Float) -> Float:
        """Velocities [m/s] at the end of a step that ends at positions x [m], shapes (n, 3)."""


class Force(Protocol):
    """One force. Methods take node positions x [m], shape (n, 3), and leave them as they are.

    Attributes
    ----------
    nodes
        Elements, shape (e, k): every pair of nodes of one element has a block in the matrix. None: the force
        adds blocks of single nodes or stencils only, or has a constant matrix.
    elastic
        Whether its energy is what the cloth stores: remeshing must not change it.
    constant_matrix
        Scalar Hessian [N/m], sparse (n, n), the same for x, y and z for as long as the force lives; None
        where there is none. At most one force of a list has one.
    """

    @property
    def nodes(self) -> Int | None:
        """Elements, shape (e, k), or None."""

    @property
    def elastic(self) -> bool:
        """Whether its energy is stored in the cloth."""

    @property
    def constant_matrix(self) -> csr_array | None:
        """Constant scalar Hessian [N/m], or None."""

    def begin(self, step: StepState, x: Float) -> bool:
        """Take from a step what does not change in it, at the positions it starts from; whether it acts."""

    def energy(self, x: Float) -> float:
        """Energy, or what a dissipative force has for it over the step [J]."""

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add the derivative of the energy, minus the force [N], to an array of shape (n, 3)."""

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add the gradient, and the positive semi-definite part of the second derivatives [N/m]."""


class NodalForce:
    """Base of forces without elements, without a constant matrix and without stored energy.

    They act in every step, unless a class says otherwise.
    """

    nodes: Int | None = None
    elastic = False
    constant_matrix: csr_array | None = None

    def begin(self, step: StepState, x: Float) -> bool:
        """Act in every step."""
        return True


class ElementForce:
    """Base of forces on elements: they store energy, and act in every step unless a class says otherwise."""

    nodes: Int | None = None
    elastic = True
    constant_matrix: csr_array | None = None

    def begin(self, step: StepState, x: Float) -> bool:
        """Act in every step."""
        return True
