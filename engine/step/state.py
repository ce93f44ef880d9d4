"""A step in progress: its request, its inertia and the contacts it has met."""

from dataclasses import dataclass

import numpy as np

from toile.engine.forces.contact import Contacts
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.inertia import Inertia, inertia_of
from toile.engine.step.options import StepOutcome
from toile.engine.step.stages import Stage
from toile.geometry.arrays import Bool, Float


@dataclass
class StepInProgress:
    """A step between its start and its outcome.

    Attributes
    ----------
    request, stage
        What it is asked to do; what it is a stage of, None for a backward Euler step.
    start, velocity
        Nodes [m] and their velocities [m/s] at its start, shapes (n, 3).
    first_order
        Nodes that take a backward Euler step whatever the stage, shape (n,).
    touched
        Nodes that contact has met in this step, shape (n,).
    held_back
        Nodes that the guard has held back, shape (n,).
    inertia
        Where nodes get to by themselves.
    ahead
        How far nodes will move, about [m], shape (n, 3), or None where the step starts at rest.
    place
        Where forces are linearised next [m], shape (n, 3).
    warm_start
        Start of the first linear solve [m], shape (n, 3), or None.
    contacts
        Contacts of the last iteration, with the friction that held in it; None without contact.
    last
        Largest component of the last displacement [m]; infinite where a line search shortened it.
    stuck
        Whether no share of it was low enough: further iterations are of no use.
    outcome
        What has been done.
    """

    request: StepRequest
    stage: Stage | None
    start: Float
    velocity: Float
    first_order: Bool
    touched: Bool
    held_back: Bool
    inertia: Inertia
    ahead: Float | None
    place: Float
    warm_start: Float | None
    outcome: StepOutcome
    contacts: Contacts | None = None
    last: float = np.inf
    stuck: bool = False

    @property
    def h(self) -> Float:
        """Step size of every node [s], shape (n,)."""
        return self.inertia.h

    def velocity_at(self, x: Float) -> Float:
        """Velocities [m/s] of a step that ends at x [m], shapes (n, 3)."""
        return self.inertia.velocity_at(x)

    def meet(self, contacts: Contacts) -> None:
        """Take note of contacts: nodes in them take backward Euler steps from here on."""
        self.contacts = contacts
        if self.stage is not None:
            self.touched = contacts.touched(len(self.start))
            self.first_order = self.first_order | self.touched
            self.inertia = inertia_of(self.start, self.velocity, self.request.h, self.stage, self.first_order)

    def finished(self) -> bool:
        """Whether another iteration is not needed, or of no use."""
        return self.stuck or self.last < self.request.newton_tolerance

    def end(self, x: Float) -> StepOutcome:
        """Return the outcome of a step that ends at x [m], shape (n, 3)."""
        outcome, request = self.outcome, self.request
        outcome.converged &= request.newton == 1 or self.last < request.newton_tolerance
        outcome.moved = np.linalg.norm(x - self.start, axis=1)
        # What the guard has held back meets something: its velocity jumps.
        late = inertia_of(self.start, self.velocity, request.h, self.stage, self.first_order | self.held_back)
        self.inertia = late
        return outcome


@dataclass(frozen=True)
class Instant:
    """A moment, for forces that are evaluated where nodes are and move: no step is taken.

    Attributes
    ----------
    request
        Carries the time.
    velocity
        Of the nodes [m/s], shape (n, 3).
    start
        Where they are [m], shape (n, 3).
    """

    request: StepRequest
    velocity: Float
    start: Float

    @property
    def h(self) -> Float:
        """Step size of every node [s], shape (n,): that of the request."""
        return np.full(len(self.velocity), self.request.h)

    def velocity_at(self, x: Float) -> Float:
        """Velocities as they are [m/s], shape (n, 3)."""
        return self.velocity
