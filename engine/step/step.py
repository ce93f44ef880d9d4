"""One implicit step of one topology: predict, detect contacts, Newton iterations, safe moves.

A step minimises 1/(2 h^2) |x - y|_M^2 + energies(x), y = x0 + h v0 + h^2 g, or what a stage of another
integrator has for it, by Newton's method with positive semi-definite Hessians. A first iteration from x0 is
the linearly implicit step of Baraff and Witkin (1998). Every displacement passes the guard, so no pair meets;
without contact, a line search on what is minimised shortens it instead.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TypeVar

import numpy as np

from toile.collide.avatar_surface import AvatarSurface
from toile.collide.cover import Cover
from toile.engine.forces.force import Force
from toile.engine.forces.hold import Holds
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.step_request import StepRequest
from toile.engine.forces.untangle import Untangling
from toile.engine.solve.hessian import Hessian
from toile.engine.solve.linear_system import LinearSystem
from toile.engine.solve.preconditioner.base import Preconditioner
from toile.engine.step.backing_off import backed_off
from toile.engine.step.collisions import Collisions
from toile.engine.step.inertia import inertia_of
from toile.engine.step.iteration_solver import Iteration, IterationSolver
from toile.engine.step.line_search import accepted_share
from toile.engine.step.memory import Before, Memory, Saved
from toile.engine.step.nodes import Nodes
from toile.engine.step.options import StepOptions, StepOutcome
from toile.engine.step.stages import Stage
from toile.engine.step.state import Instant, StepInProgress
from toile.geometry.arrays import Bool, Float
from toile.geometry.stage_clock import StageClock

Some = TypeVar("Some")


class ClothStepper:
    """Advances nodes with masses under a list of forces and, where there is any, contact.

    Attributes
    ----------
    x, v
        Node positions [m] and velocities [m/s], shapes (n, 3).
    mass
        Of every node [kg], shape (n,).
    pinned
        Nodes that no force moves, shape (n,), or None.
    forces
        All forces but contact.
    collisions
        Contact, or None.
    memory
        The past that integrators use; None at the start and after a jump.
    """

    def __init__(
        self, nodes: Nodes, forces: Sequence[Force], collisions: Collisions | None, options: StepOptions,
        clock: StageClock,
    ) -> None:  # fmt: skip
        self.x, self.v, self.mass = nodes.positions.copy(), nodes.velocities.copy(), nodes.mass
        self.pinned: Bool | None = nodes.pinned if nodes.pinned.any() else None
        self.forces = list(forces)
        self.collisions = collisions
        self.options = options
        self.clock = clock
        self.memory: Memory | None = None
        elements = {id(force.nodes): force.nodes for force in forces if force.nodes is not None}
        self._hessian = Hessian(len(self.x), list(elements.values()))
        constant = [force.constant_matrix for force in forces if force.constant_matrix is not None]
        if len(constant) > 1:
            raise ValueError(f"{len(constant)} forces have a constant matrix; at most one may")
        self._system = LinearSystem(self._hessian.pattern, constant[0] if constant else None)
        self._solver = IterationSolver(self._system)

    def step(self, request: StepRequest, stage: Stage | None = None) -> StepOutcome:
        """Advance by a step, or a stage of one; nothing ever passes through the cloth or the avatar."""
        step = self._predicted(request, stage)
        forces = [force for force in self.forces if force.begin(step, step.place)]
        for _ in range(request.newton):
            avatar_ahead = self._detect_contacts(step)
            iteration = self._assembled(step, forces)
            displacement = self._solved(step, iteration)
            if request.at_rest:
                self._move_at_rest(step, displacement, iteration.gradient)
            elif self.collisions is not None:
                self._move_safely(step, displacement, avatar_ahead)
            else:
                self._search_line(step, forces, displacement, iteration.gradient)
            if step.finished():
                break
        outcome = step.end(self.x)
        self._remember(step)
        return outcome

    # Parts of a step, in their order.

    def _predicted(self, request: StepRequest, stage: Stage | None) -> StepInProgress:
        """Begin a step: where nodes get to by themselves, and where forces are linearised."""
        count = len(self.x)
        if request.at_rest:
            self.v = np.zeros_like(self.x)
        # Without a past nodes that may touch something take a backward Euler step.
        unknown = np.full(count, self.collisions is not None)
        first_order = unknown if self.memory is None else self.memory.touched
        ahead: Float | None = None
        if not request.at_rest:
            # Gravity counts where cloth moves: what hangs still beside the avatar is not drawn to it.
            ahead = request.h * self.v
            fall = request.h**2 * self.options.gravity * request.gravity
            ahead[:, 1] -= np.minimum(fall, np.linalg.norm(ahead, axis=1))
        start = self.x.copy()
        return StepInProgress(
            request=request, stage=stage, start=start, velocity=self.v, first_order=first_order,
            touched=np.zeros(count, bool), held_back=np.zeros(count, bool),
            inertia=inertia_of(start, self.v, request.h, stage, first_order), ahead=ahead,
            place=self._foreseen(request, stage),
            warm_start=None if request.at_rest or stage is not None else request.h * self.v,
            outcome=StepOutcome(moved=np.zeros(count)),
        )  # fmt: skip

    def _foreseen(self, request: StepRequest, stage: Stage | None) -> Float:
        """Where forces of a step are linearised [m], shape (n, 3); the nodes themselves where they are there.

        Backward Euler steps linearise where nodes are, as published: it takes energy from cloth that turns.
        Other stages do so where nodes will be, about: a memory of what was taken would add up.
        """
        if stage is None:
            return self._pins_at_target(self.x, request)
        there = self.x + request.h * self.v
        if self.pinned is not None:
            there[self.pinned] = self.x[self.pinned]
        return self._pins_at_target(there, request)

    def _pins_at_target(self, place: Float, request: StepRequest) -> Float:
        """Return places of the nodes [m], shape (n, 3), with pins where they shall be, if they move."""
        if request.pin_target is None or self.pinned is None:
            return place
        return np.where(self.pinned[:, None], request.pin_target, place)

    def _detect_contacts(self, step: StepInProgress) -> Float | None:
        """Find contacts; return how far the avatar still has to go [m], shape (v, 3), or None."""
        now = self.clock.now()
        request, collisions = step.request, self.collisions
        if step.ahead is not None and request.pin_target is not None and self.pinned is not None:
            step.ahead[self.pinned] = (request.pin_target - step.start)[self.pinned]
        if collisions is None:
            return None
        avatar_ahead: Float | None = None
        if request.avatar_target is not None and collisions.avatar is not None:
            avatar_ahead = request.avatar_target - collisions.avatar.vertices
        ahead = None if step.ahead is None else step.start + step.ahead - self.x
        step.meet(collisions.detect(self.x, ahead, avatar_ahead))
        self.clock.add("contact", now)
        return avatar_ahead

    def _assembled(self, step: StepInProgress, forces: Sequence[Force]) -> Iteration:
        """Linearise inertia and forces: contact is left to the solver, with its friction."""
        now = self.clock.now()
        place, inertia, hessian = step.place, step.inertia, self._hessian
        hessian.clear()
        node_diagonal = self.mass / inertia.h**2
        away = place - inertia.without_forces(step.request.gravity * self.options.gravity)
        gradient = node_diagonal[:, None] * away
        for force in forces:
            force.linearise(place, gradient, hessian)
        self.clock.add("assembly", now)
        return Iteration(
            step.request, place, hessian, gradient, node_diagonal, self.pinned,
            None if place is self.x else place - self.x, step.warm_start,
        )  # fmt: skip

    def _solved(self, step: StepInProgress, iteration: Iteration) -> Float:
        """Return the displacement of the nodes [m], shape (n, 3), and book what it took."""
        result, contacts = self._solver.solve(iteration, step.contacts, self.options.slip, self.clock)
        step.contacts, step.warm_start = contacts, None
        outcome = step.outcome
        outcome.newton_iterations += 1
        outcome.cg_iterations += result.iterations
        outcome.converged &= result.converged
        if contacts is not None:
            outcome.contacts = contacts.count
            outcome.min_gap = float(contacts.gap.min(initial=np.inf))
        return result.solution

    def _move_at_rest(self, step: StepInProgress, displacement: Float, gradient: Float) -> None:
        """Move as far as is safe and stretches the cloth no more than forces pull it."""
        now = self.clock.now()
        request = step.request
        move, limited = self._safe(request.move_share * displacement, request.motion_max)
        if step.contacts is not None:
            step.contacts.add_gradient(gradient)
        membrane = self.force(Membrane)
        if membrane is not None:
            move = backed_off(membrane, self.x, move, gradient, lambda some: self._safe(some, np.inf)[0])
        if self.collisions is not None:
            self.collisions.moved_by(move)
        self._carry_out(step, move, limited)
        self.clock.add("contact", now)

    def _safe(self, wanted: Float, longest: float) -> tuple[Float, Bool]:
        """Shorten displacements [m], shape (n, 3), to `longest` and to what is safe; mark nodes held back."""
        if self.collisions is not None:
            return self.collisions.safe(self.x, wanted, longest)
        length = np.linalg.norm(wanted, axis=1)
        scale = np.minimum(1.0, longest / np.maximum(length, 1e-300))
        return wanted * scale[:, None], np.zeros(len(wanted), bool)

    def _move_safely(self, step: StepInProgress, wanted: Float, avatar_wanted: Float | None) -> None:
        """Move as far as is safe, and the avatar with the cloth."""
        now = self.clock.now()
        assert self.collisions is not None
        move, limited = self.collisions.safe_in_motion(
            self.x, wanted, avatar_wanted, pinned=self.pinned is not None
        )
        self._carry_out(step, move, limited)
        self.clock.add("contact", now)

    def _search_line(
        self, step: StepInProgress, forces: Sequence[Force], displacement: Float, gradient: Float
    ) -> None:
        """Move cloth without contact until what the step minimises has fallen enough."""
        y = step.inertia.without_forces(step.request.gravity * self.options.gravity)
        node_diagonal = self.mass / step.inertia.h**2

        def potential(x: Float) -> float:
            kinetic = 0.5 * float(node_diagonal @ ((x - y) ** 2).sum(axis=1))
            return kinetic + sum(force.energy(x) for force in forces)

        place, move = step.place, displacement if step.place is self.x else self.x + displacement - step.place
        share = 1.0 if step.request.newton == 1 else accepted_share(potential, place, move, gradient)
        self._carry_out(step, place + share * move - self.x, step.held_back)
        step.last = float(np.abs(move).max()) if share == 1.0 else np.inf
        step.stuck = share == 0.0

    def _carry_out(self, step: StepInProgress, move: Float, limited: Bool) -> None:
        """Move the nodes, and say where forces are linearised next."""
        step.held_back = step.held_back | limited
        step.outcome.limited = int(np.count_nonzero(limited))
        step.last = float(np.abs(move).max())
        self.x += move
        step.place = self._pins_at_target(self.x, step.request)

    def _remember(self, step: StepInProgress) -> None:
        """Take over velocities, what integrators remember, and friction anchors."""
        if step.request.at_rest:
            self.v = np.zeros_like(self.x)
        else:
            self.v = step.inertia.velocity_at(self.x)
            if step.stage is not None:
                self.memory = Memory(
                    step.inertia.acceleration_at(self.x), step.touched | step.held_back,
                    Before(step.start, step.velocity, step.request.h),
                )  # fmt: skip
        if self.collisions is not None and step.contacts is not None:
            self.collisions.take_anchors(self.x, step.contacts, step.request.avatar_target is not None)

    # What drapes, films and integrators ask of a stepper between steps.

    def force(self, kind: type[Some]) -> Some | None:
        """Return the first force of a class, or None."""
        return next((force for force in self.forces if isinstance(force, kind)), None)

    def elastic_energy(self) -> float:
        """Energy that the cloth stores at the current positions [J]."""
        return float(sum(force.energy(self.x) for force in self.forces if force.elastic))

    def acceleration(self, seconds: float) -> Float:
        """Acceleration without contact [m/s^2] at a time [s], shape (n, 3); zero at pins."""
        gradient = np.zeros_like(self.x)
        now = Instant(StepRequest(h=1.0, at_rest=False, seconds=seconds), self.v, self.x)
        for force in self.forces:
            if force.begin(now, self.x):
                force.add_gradient(self.x, gradient)
        acceleration = -gradient / self.mass[:, None]
        acceleration[:, 1] -= self.options.gravity
        if self.pinned is not None:
            acceleration[self.pinned] = 0.0
        return np.asarray(acceleration)

    def past(self, seconds: float) -> Memory:
        """Return what the last step left at a time [s], or what serves instead at the start.

        Where there is contact nothing is known, and all nodes take a backward Euler step first.
        """
        if self.memory is not None:
            return self.memory
        if self.collisions is not None:
            return Memory(np.zeros_like(self.x), np.ones(len(self.x), bool))
        return Memory(self.acceleration(seconds), np.zeros(len(self.x), bool))

    def put(self, positions: Float, velocities: Float, memory: Memory | None = None) -> None:
        """Put nodes somewhere [m] with velocities [m/s], shapes (n, 3), whatever is in between."""
        self.x[:], self.v, self.memory = positions, velocities.copy(), memory

    def meet(self, avatar: AvatarSurface, roam: Cover | None) -> None:
        """Meet this part of an avatar from here on, with no memory of searches: see `Collisions.meet`."""
        assert self.collisions is not None
        self.collisions.meet(avatar, roam)

    def forget(self) -> None:
        """Let go of what contact has found: where a frame ends, it only takes memory."""
        if self.collisions is not None:
            self.collisions.forget()

    def save(self) -> Saved:
        """Return what a step changes, so that it can be tried again."""
        collisions = self.collisions
        anchor = None if collisions is None else collisions.anchor.copy()
        body = None if collisions is None or collisions.avatar is None else collisions.avatar.vertices
        return Saved(self.x.copy(), self.v.copy(), self.memory, anchor, body)

    def restore(self, saved: Saved) -> None:
        """Go back to where the stepper was when it was saved."""
        self.put(saved.positions, saved.velocities, saved.memory)
        if self.collisions is not None and saved.anchor is not None:
            self.collisions.anchor[:] = saved.anchor
            if self.collisions.avatar is not None and saved.avatar is not None:
                self.collisions.avatar.move_to(saved.avatar)

    def safe_move(self, wanted: Float) -> Float:
        """Move nodes by `wanted` [m] as far as is safe; return the share each node moved, shape (n,)."""
        length = np.linalg.norm(wanted, axis=1)
        move, _ = self._safe(wanted, np.inf)
        self.x += move
        return np.where(length > 0.0, np.linalg.norm(move, axis=1) / np.maximum(length, 1e-300), 1.0)

    def hold(self, holds: Holds | None) -> None:
        """Hold nodes, instead of those held so far, as strongly as requests say; None lets go."""
        self.forces = [force for force in self.forces if not isinstance(force, Holds)]
        if holds is not None:
            self.forces.append(holds)

    def pin(self, pinned: Bool | None) -> None:
        """Let no force move marked nodes, shape (n,), from here on, and all others again."""
        self.pinned = None if pinned is None or not pinned.any() else pinned

    def let_pass(self, ghost: Bool, avatar_ghost: Bool | None = None) -> None:
        """Let marked nodes, shape (n,), pass through each other and through marked avatar vertices.

        Where they cross they are drawn apart.
        """
        if self.collisions is None:
            return
        self.forces = [force for force in self.forces if not isinstance(force, Untangling)]
        untangling = self.collisions.let_pass(ghost, avatar_ghost)
        if untangling is not None:
            self.forces.append(untangling)

    @contextmanager
    def others_still(self, free: Bool, without: tuple[type, ...]) -> Iterator[None]:
        """Keep all but the free nodes, shape (n,), where they are, and leave out forces of some classes."""
        still, collisions = ~free, self.collisions
        pinned, forces = self.pinned, self.forces
        self.pinned = still if pinned is None else pinned | still
        self.forces = [force for force in forces if not isinstance(force, without)]
        anchors = None if collisions is None else collisions.anchor[: len(still)][still]
        try:
            if collisions is not None:
                collisions.ignore(still)
            yield
        finally:
            self.pinned, self.forces = pinned, forces
            if collisions is not None:
                # What still nodes hold by friction they hold on.
                collisions.anchor[: len(still)][still] = anchors
                collisions.ignore(None)

    def book_on(self, clock: StageClock) -> None:
        """Book the time that steps take on another clock from here on."""
        self.clock = clock

    def precondition(self, make: Callable[[LinearSystem], Preconditioner]) -> None:
        """Take another preconditioner than the usual one."""
        self._solver.preconditioner = make(self._system)
