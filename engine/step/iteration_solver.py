"""The linear systems of one Newton iteration, solved again until friction fits the solution."""

from typing import NamedTuple

import numpy as np

from toile.engine.forces.contact import Contacts
from toile.engine.forces.friction import friction_after, friction_at_start, rubbed
from toile.engine.forces.step_request import StepRequest
from toile.engine.solve.cg import CgResult, solve
from toile.engine.solve.hessian import Hessian
from toile.engine.solve.linear_system import NO_CONTACTS, ContactStencils, LinearSystem, joined
from toile.engine.solve.preconditioner.base import Preconditioner
from toile.engine.solve.preconditioner.block_jacobi import BlockJacobi
from toile.engine.solve.preconditioner.choice import make_preconditioner
from toile.geometry.arrays import Bool, Float
from toile.geometry.stage_clock import StageClock

RUBBINGS, RUBBED = 3, 0.1
"""How often friction is worked out anew in one iteration, while it changes by more than that share."""


class Iteration(NamedTuple):
    """The part that all linear systems of one Newton iteration share.

    Attributes
    ----------
    request
        The step.
    positions
        Places of the nodes at which elastic forces are linearised [m], shape (n, 3).
    hessian
        Second derivatives of all forces but contact.
    gradient
        Gradient of the step's energy there, without contacts [N], shape (n, 3).
    node_diagonal
        Mass over the square of the time step [N/m], shape (n,).
    pinned
        Pinned nodes, shape (n,), or None.
    ahead
        How far `positions` are from the nodes [m], shape (n, 3), or None where they are the same. Contacts
        are linearised at the nodes themselves, from where their motion must be safe.
    warm_start
        What the displacement from `positions` may be [m], shape (n, 3), or None: nothing, as where they
        are ahead already.
    """

    request: StepRequest
    positions: Float
    hessian: Hessian
    gradient: Float
    node_diagonal: Float
    pinned: Bool | None
    ahead: Float | None
    warm_start: Float | None


class IterationSolver:
    """Solves iterations on one topology."""

    def __init__(self, system: LinearSystem) -> None:
        self.system = system
        self.preconditioner: Preconditioner = make_preconditioner(system)
        # With a loose tolerance, what is left of a warm start acts as a force on smooth motions, unless those
        # are solved exactly: cloth in fast flight would not feel gravity.
        self._warm_starts = not isinstance(self.preconditioner, BlockJacobi)

    def solve(
        self, iteration: Iteration, contacts: Contacts | None, slip: float, clock: StageClock
    ) -> tuple[CgResult, Contacts | None]:
        """Return the displacement of the nodes, and the contacts that hold in it, with their friction.

        `slip` is the elastic slip of friction [m]; time is booked on `clock`.
        """
        if contacts is None:
            return self._solved(iteration, None, clock), None
        friction = friction_at_start(contacts, slip)
        if not iteration.request.friction:
            friction = friction._replace(grip=np.zeros(contacts.count))
        rubbing = rubbed(contacts, friction)
        result = self._solved(iteration, rubbing, clock)
        iterations = result.iterations
        inertia = iteration.node_diagonal
        if iteration.pinned is not None:
            inertia = np.where(iteration.pinned, np.inf, inertia)
        for _ in range(RUBBINGS if iteration.request.friction else 0):
            after = friction_after(contacts, friction, result.solution, inertia, slip)
            if not after.differs(friction, RUBBED):
                break
            friction = after
            rubbing = rubbed(contacts, friction)
            result = self._solved(iteration, rubbing, clock, result)
            iterations += result.iterations
            if not result.iterations:
                # What friction changed is less than the solver resolves.
                break
        return result._replace(iterations=iterations), rubbing

    def _solved(
        self,
        iteration: Iteration,
        contacts: Contacts | None,
        clock: StageClock,
        known: CgResult | None = None,
    ) -> CgResult:
        """Solve one linear system, from the solution of one that differs little."""
        now = clock.now()
        request, hessian = iteration.request, iteration.hessian
        stencils = hessian.stencils
        gradient = iteration.gradient.copy()
        if contacts is not None:
            contacts.add_gradient(gradient, iteration.ahead)
            stencils = [ContactStencils(contacts.nodes, contacts.weights, contacts.stiffness), *stencils]
        self.system.update(
            hessian.blocks, iteration.node_diagonal, contacts=joined(stencils) if stencils else NO_CONTACTS,
            pinned=iteration.pinned, bending_scale=hessian.constant_scale, squares=hessian.squares,
        )  # fmt: skip
        ahead = iteration.ahead
        if known is None:
            self.preconditioner.update(self.system, iteration.positions)
            start = iteration.warm_start if self._warm_starts else None
        else:
            start = known.solution if ahead is None else known.solution - ahead
        now = clock.add("assembly", now)
        result = solve(
            self.system, -gradient, self.preconditioner, tolerance=request.cg_tolerance,
            max_iterations=request.cg_iterations, start=start,
            reference=None if known is None else known.reference,
        )  # fmt: skip
        clock.add("solve", now)
        return result if ahead is None else result._replace(solution=result.solution + ahead)
