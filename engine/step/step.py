"""One implicit step of one cloth topology: predict, find contacts, Newton iterations, safe moves.

A step minimises 1/(2 h^2) |x - y|_M^2 + energies(x), y = x0 + h v0 + h^2 g, or what a stage of another
integrator has for it, by Newton's method with positive semi-definite Hessians. A first iteration from x0 is
the linearly implicit step of Baraff and Witkin (1998). Every displacement passes the guard, so no pair meets.
"""

import numpy as np

from toile.collide.guard import safe_factors
from toile.collide.search import AvatarSurface, ContactSearch
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.contact_pairs import node_thickness, pair_friction
from toile.engine.forces.bend import Bending
from toile.engine.forces.contact import NO_MOTION, Contacts, evaluate_contacts
from toile.engine.forces.hold import Holds, SewingHolds
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.stitch import Stitches
from toile.engine.forces.untangle import Untangling
from toile.engine.forces.wind import Wind
from toile.engine.solve.assembly import scatter_gradients, scatter_hessians
from toile.engine.solve.block_pattern import BlockPattern
from toile.engine.solve.linear_system import LinearSystem
from toile.engine.step.backing_off import backed_off
from toile.engine.step.friction_anchors import slid_anchors
from toile.engine.step.inertia import inertia_of
from toile.engine.step.iteration_solver import Iteration, IterationSolver
from toile.engine.step.memory import Memory, Saved
from toile.engine.step.request import StageClock, StepOptions, StepOutcome, StepRequest
from toile.engine.step.safe_motion import LEAST_ALLOWANCE, MOTION_AHEAD, expect, expect_avatar, safe_in_motion
from toile.geometry.arrays import Bool, Float
from toile.geometry.normals import vertex_normals

DRIFT_ALLOWANCE, EDGE_SHARE = 5e-3, 0.2
"""Room of candidates in motion beside the drift of the nodes: at most [m], and as a share of their edges."""
OVERSIZE, FEW = 4.0, 0.02
"""Candidates for more than OVERSIZE times the motion at hand are too many, and searched anew; a share of FEW
nodes may be held back for want of candidates rather than search anew."""


class ClothStepper:
    """Forces, matrix pattern and contact search of one topology; makes steps on its cloth."""

    def __init__(
        self, cloth: Cloth, avatar: AvatarSurface | None, options: StepOptions, clock: StageClock
    ) -> None:
        started = clock.now()
        self.options = options
        self.clock = clock
        self.avatar = avatar
        self.x = cloth.positions.copy()
        self.v = cloth.velocities.copy()
        # Without a past all nodes take a backward Euler step.
        self.memory = Memory(np.zeros_like(self.x), np.ones(len(self.x), bool))
        self.mass = cloth.mass
        self.pinned: Bool | None = cloth.pinned if cloth.pinned.any() else None
        faces = cloth.face_nodes
        self.faces = faces
        fabrics = cloth.fabrics

        def per_face(name: str) -> Float:
            return np.array([getattr(fabric, name) for fabric in fabrics])[cloth.fabric]

        self.membrane = Membrane(
            faces, cloth.rest_corners, per_face("stretch_warp"), per_face("stretch_weft"), per_face("shear"),
            per_face("compression"),
        )  # fmt: skip
        self.bending: Bending | None = None
        if any(max(f.bending_warp, f.bending_weft, f.bending_bias) > 0.0 for f in fabrics):
            self.bending = Bending.for_cloth(cloth)
        self.wind = None if options.air is None else Wind(faces, len(self.x), options.air)
        self.stitches = Stitches(cloth.stitches) if len(cloth.stitches) else None
        self.stitch_length = cloth.stitch_length
        self.untangling: Untangling | None = None
        self.holds: Holds | None = None
        self.goals = None if cloth.goals is None else cloth.goals.springs(cloth.node_area, cloth.pinned)
        if len(cloth.stitches):
            normals = vertex_normals(self.x, faces)
            self.holds = SewingHolds(self.x, normals, cloth.weld, cloth.stitches, cloth.held)
        stencils = [faces] + ([cloth.stitches] if len(cloth.stitches) else [])
        self.pattern = BlockPattern(len(self.x), stencils)
        self.system = LinearSystem(self.pattern, None if self.bending is None else self.bending.stiffness)
        self.solver = IterationSolver(self.system)
        self.blocks = self.pattern.zeros()
        weld = cloth.weld
        self.search: ContactSearch | None = None
        self.thickness = node_thickness(cloth)
        if avatar is not None or options.self_contact:
            self.search = ContactSearch(
                faces, weld, avatar, self_contact=options.self_contact,
                radius_self=max(options.radius_self, float(self.thickness.max())),
                radius_body=options.radius_body,
            )  # fmt: skip
            others = 0 if avatar is None else len(avatar.vertices)
            self.pair_friction = pair_friction(cloth, others, options.friction)
            self.area = np.concatenate(
                [cloth.node_area, np.zeros(0) if avatar is None else avatar.vertex_area]
            )
            self.radius_body = np.empty(len(self.x) + others)
            self.set_body_radius(options.radius_body)
            self.radius_self = np.minimum(
                np.maximum(options.radius_self, self.thickness), 0.4 * cloth.shortest_edge
            )
            self.anchor = np.concatenate([self.x, np.zeros((0, 3)) if avatar is None else avatar.vertices])
        self._motion = np.zeros(len(self.x))
        self._allowed = np.clip(EDGE_SHARE * cloth.shortest_edge, LEAST_ALLOWANCE, DRIFT_ALLOWANCE)
        clock.add("assembly", started)

    def contacts(
        self, request: StepRequest, ahead: Float | None = None, avatar_ahead: Float | None = None
    ) -> Contacts | None:
        """Find and evaluate contacts at the current positions, and those that motion leads to.

        `ahead` is the expected motion of the nodes [m], shape (n, 3), `avatar_ahead` the avatar's, (v, 3).
        """
        if self.search is None:
            return None
        if avatar_ahead is None and self.avatar is not None and self.avatar.drift is not None:
            # From here on it stands still.
            self.avatar.stay()
            self.search.expire_body()
        if ahead is None:
            allowance, motion = self.search.allowance(self.x), MOTION_AHEAD * self._motion + LEAST_ALLOWANCE
            if not (allowance > 0.0).all() or allowance.max() > OVERSIZE * motion.max():
                self.search.search(self.x, motion)
            moving = NO_MOTION
        elif avatar_ahead is not None and self.avatar is not None:
            expect_avatar(self.search, self.avatar, avatar_ahead, self.x, ahead, self._allowed)
            moving = np.concatenate([ahead, avatar_ahead])
        else:
            # Candidates that miss some contacts ahead are safe: what the step then asks for is searched.
            expect(self.search, self.x, ahead, self._allowed)
            moving = np.zeros_like(self.search.positions)
            moving[: len(self.x)] = ahead
        self.search.place(self.x)
        return evaluate_contacts(
            self.search.positions, self.anchor, len(self.x), self.search.body, self.search.cloth,
            self.radius_body, self.radius_self_all(), self.area, self.options.law_body, self.options.law_self,
            self.pair_friction, moving,
        )  # fmt: skip

    def radius_self_all(self) -> Float:
        """Self-contact radius for nodes and, unused, avatar vertices."""
        count = len(self.anchor) - len(self.x)
        return np.concatenate([self.radius_self, np.full(count, self.options.radius_self)])

    def gradient(self, place: Float, inertial: Float, request: StepRequest) -> Float:
        """Gradient of the step's energy [N], contacts aside, after forces were evaluated, shape (n, 3).

        `place` is where they were [m], shape (n, 3), `inertial` the part of inertia [N], shape (n, 3).
        """
        gradient = inertial.copy()
        scatter_gradients(self.faces, self.membrane.element_gradient, gradient)
        if self.bending is not None:
            gradient += request.bending_factor * self.bending.gradient(place)
        if self.stitches is not None and request.stitch_stiffness > 0.0:
            scatter_gradients(self.stitches.pairs, self.stitches.element_gradient, gradient)
        if self.holds is not None and request.hold_stiffness > 0.0:
            self.holds.add_gradient(place, request.hold_stiffness, gradient)
        if self.goals is not None:
            self.goals.add_gradient(place, 1.0, gradient)
        if self.untangling is not None and request.untangle_stiffness > 0.0:
            self.untangling.add_gradient(request.untangle_stiffness, gradient)
        return gradient

    def save(self) -> Saved:
        """Return what a step changes, so that it can be tried again."""
        anchor = None if self.search is None else self.anchor.copy()
        body = None if self.avatar is None else self.avatar.vertices
        return Saved(self.x.copy(), self.v.copy(), self.memory, anchor, body)

    def restore(self, saved: Saved) -> None:
        """Go back to where the stepper was when it was saved."""
        self.x[:], self.v = saved.positions, saved.velocities.copy()
        self.memory = saved.memory
        if saved.anchor is not None:
            self.anchor[:] = saved.anchor
        if self.avatar is not None and saved.avatar is not None:
            self.avatar.move_to(saved.avatar)

    def step(self, request: StepRequest) -> StepOutcome:
        """Advance the cloth by one step; positions never pass through each other or the avatar."""
        start = self.x.copy()
        if request.at_rest:
            self.v = np.zeros_like(self.x)
        blunt, touched = self.memory.touched, np.zeros(len(self.x), bool)
        inertia = inertia_of(start, self.v, request.h, request.stage, blunt)
        ahead = request.h * self.v
        place = self._foreseen(request)
        if not request.at_rest:
            # Gravity counts where cloth moves: what hangs still beside the avatar is not drawn to it.
            fall = request.h**2 * self.options.gravity * request.gravity
            ahead[:, 1] -= np.minimum(fall, np.linalg.norm(ahead, axis=1))
        outcome = StepOutcome(moved=np.zeros(len(self.x)))
        if self.wind is not None:
            self.wind.begin(start, request.seconds)
        if self.goals is not None and request.pin_target is not None:
            self.goals.targets = request.pin_target[self.goals.nodes]
        avatar_ahead: Float | None = None
        guess = None if request.at_rest or request.stage is not None else request.h * self.v
        held_back = np.zeros(len(self.x), bool)
        for _ in range(request.newton):
            now = self.clock.now()
            if request.pin_target is not None and self.pinned is not None:
                ahead[self.pinned] = (request.pin_target - start)[self.pinned]
            if request.avatar_target is not None and self.avatar is not None:
                avatar_ahead = request.avatar_target - self.avatar.vertices
            contacts = self.contacts(
                request, None if request.at_rest else start + ahead - self.x, avatar_ahead
            )
            if request.stage is not None and contacts is not None:
                touched = contacts.touched(len(self.x))
                blunt = blunt | touched
                inertia = inertia_of(start, self.v, request.h, request.stage, blunt)
            now = self.clock.add("contact", now)
            self.membrane.evaluate(place)
            self.blocks[:] = 0.0
            scatter_hessians(self.pattern.slots[0], self.membrane.element_hessian, self.blocks)
            if self.stitches is not None and request.stitch_stiffness > 0.0:
                target = self._stitch_target(self.stitches, request)
                self.stitches.evaluate(place, target, request.stitch_stiffness)
                scatter_hessians(self.pattern.slots[1], self.stitches.element_hessian, self.blocks)
            if self.untangling is not None and request.untangle_stiffness > 0.0:
                assert self.search is not None
                self.search.place(self.x)
                self.untangling.evaluate(self.search.positions)
            node_diagonal = self.mass / inertia.h**2
            inertial = node_diagonal[:, None] * (
                place - inertia.without_forces(request.gravity * self.options.gravity)
            )
            gradient = self.gradient(place, inertial, request)
            if self.wind is not None:
                gradient += self.wind.gradient(inertia.velocity_at(place))
                self.blocks[self.pattern.rank] += self.wind.drag / inertia.h[:, None, None]
            stencils = []
            if self.holds is not None and request.hold_stiffness > 0.0:
                stencils.append(self.holds.stencils(request.hold_stiffness))
            if self.goals is not None:
                stencils.append(self.goals.stencils(1.0))
            if self.untangling is not None and request.untangle_stiffness > 0.0:
                stencils.append(self.untangling.stencils(request.untangle_stiffness))
            self.clock.add("assembly", now)
            if contacts is not None:
                outcome.contacts = contacts.count
                outcome.min_gap = float(contacts.gap.min(initial=np.inf))
            iteration = Iteration(
                request, place, self.blocks, gradient, node_diagonal, stencils, self.pinned,
                None if place is self.x else place - self.x, guess,
            )  # fmt: skip
            guess = None
            result, contacts = self.solver.solve(iteration, contacts, self.options.slip, self.clock)
            now = self.clock.now()
            outcome.newton_iterations += 1
            outcome.cg_iterations += result.iterations
            if request.at_rest:
                move, limited = self._safe(request.move_share * result.solution, request.motion_max)
                if contacts is not None:
                    contacts.add_gradient(gradient)
                move = backed_off(
                    self.membrane, self.faces, self.x, move, gradient,
                    lambda some: self._safe(some, np.inf)[0],
                )  # fmt: skip
                self._motion = np.linalg.norm(move, axis=1)
            else:
                move, limited = self._safe_in_motion(result.solution, avatar_ahead)
            held_back |= limited
            outcome.limited = int(np.count_nonzero(limited))
            self.x += move
            self.clock.add("contact", now)
            outcome.converged &= result.converged
            last = float(np.abs(move).max())
            if last < request.newton_tolerance:
                break
            place = self._pins_at_target(self.x, request)
        outcome.converged &= request.newton == 1 or last < request.newton_tolerance
        outcome.moved = np.linalg.norm(self.x - start, axis=1)
        self._take_motion(start, request, blunt | held_back, touched | held_back)
        if contacts is not None:
            self._take_anchors(request, contacts)
        return outcome

    def _foreseen(self, request: StepRequest) -> Float:
        """Where forces of a step are linearised [m], shape (n, 3); the nodes themselves where they are there.

        Backward Euler steps linearise where nodes are, as published: it takes energy from cloth that turns.
        Other stages do so where nodes will be, about: a memory of what was taken would add up.
        """
        if request.stage is None:
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

    def _take_motion(self, start: Float, request: StepRequest, blunt: Bool, touched: Bool) -> None:
        """Take over velocities and accelerations of a step from `start` [m], shape (n, 3).

        Nodes in `blunt`, shape (n,), took a backward Euler step; those in `touched` will take one next.
        """
        if request.at_rest:
            self.v = np.zeros_like(self.x)
            return
        inertia = inertia_of(start, self.v, request.h, request.stage, blunt)
        self.v = inertia.velocity_at(self.x)
        if request.stage is not None:
            self.memory = Memory(inertia.acceleration_at(self.x), touched)

    def _take_anchors(self, request: StepRequest, contacts: Contacts) -> None:
        """Let friction anchors follow a step, and the search know where the avatar has got to."""
        count = len(self.x)
        carried = None
        if request.avatar_target is not None and self.avatar is not None:
            carried = self.avatar.vertices - self.anchor[count:]
            self.anchor[count:] = self.avatar.vertices
        self.anchor[:count] = slid_anchors(self.x, self.anchor[:count], contacts, self.options.slip, carried)

    def _safe_in_motion(self, wanted: Float, avatar_wanted: Float | None) -> tuple[Float, Bool]:
        """Shorten displacements to what is safe and move the avatar; also mark the nodes held back."""
        if self.search is None:
            return wanted, np.zeros(len(wanted), bool)
        # Pinned cloth goes nowhere.
        common = None if avatar_wanted is None or self.pinned is not None else wanted.mean(axis=0)
        done = safe_in_motion(self.search, self.x, wanted, self._allowed, self.avatar, avatar_wanted, common)
        if avatar_wanted is not None and self.avatar is not None:
            self.avatar.move_to(self.avatar.vertices + done.avatar)
        return done.cloth, done.limited

    def _stitch_target(self, stitches: Stitches, request: StepRequest) -> Float:
        """Rest length of every stitch [m]: on schedule, but a blocked one pulls no harder than its reach."""
        gap = np.linalg.norm(self.x[stitches.pairs[:, 0]] - self.x[stitches.pairs[:, 1]], axis=1)
        return np.asarray(np.maximum(self.stitch_length * request.stitch_share, gap - request.stitch_reach))

    def _safe(self, wanted: Float, longest: float) -> tuple[Float, Bool]:
        """Shorten a displacement to `longest` and to what is safe; also mark the nodes held back."""
        length = np.linalg.norm(wanted, axis=1)
        scale = np.minimum(1.0, longest / np.maximum(length, 1e-300))
        wanted = wanted * scale[:, None]
        length = length * scale
        self._motion = length
        if self.search is None:
            return wanted, np.zeros(len(wanted), bool)
        allowance = self.search.allowance(self.x)
        short = ~(allowance >= length)
        if np.count_nonzero(short) > FEW * len(length) or not np.isfinite(allowance).all():
            self.search.search(self.x, MOTION_AHEAD * length + LEAST_ALLOWANCE)
        elif short.any():
            # A few nodes wait: using up their allowance brings about the next search.
            cut = np.where(short, np.maximum(allowance, 0.0) / np.maximum(length, 1e-300), 1.0)
            wanted = wanted * cut[:, None]
        self.search.place(self.x)
        move = np.zeros_like(self.search.positions)
        move[: len(self.x)] = wanted
        factor = safe_factors(self.search.positions, move, *self.search.pairs)[: len(self.x)]
        return wanted * factor[:, None], factor < 1.0

    def let_pass(self, ghost: Bool, avatar_ghost: Bool | None = None) -> None:
        """Let marked nodes, shape (n,), pass through each other and through marked avatar vertices.

        Where they cross they are drawn apart.
        """
        if self.search is None:
            return
        own = np.zeros(len(self.anchor) - len(self.x), bool) if avatar_ghost is None else avatar_ghost
        marked = np.concatenate([ghost, own])
        self.search.let_pass(marked)
        self.untangling = None
        if ghost.any():
            faces = self.search.all_faces
            self.untangling = Untangling(
                np.ascontiguousarray(faces[marked[faces].any(axis=1)]), self.search.weld, len(self.x)
            )

    def set_body_radius(self, radius: float) -> None:
        """Set the least contact radius against the avatar [m]; thicker fabrics keep their thickness away."""
        if self.search is None:
            return
        self.least_body_radius = radius
        self.radius_body[: len(self.x)] = np.maximum(radius, self.thickness)
        most = float(self.radius_body[: len(self.x)].max())
        self.radius_body[len(self.x) :] = most
        if self.search.radius_body != most:
            self.search.radius_body = most
            self.search.expire()

    def safe_move(self, wanted: Float) -> Float:
        """Move nodes by `wanted` [m] as far as is safe; return the share each node moved, shape (n,)."""
        length = np.linalg.norm(wanted, axis=1)
        move, _ = self._safe(wanted, np.inf)
        self.x += move
        return np.where(length > 0.0, np.linalg.norm(move, axis=1) / np.maximum(length, 1e-300), 1.0)

    def elastic_energy(self) -> float:
        """Membrane and bending energy at the current positions [J]."""
        return self.membrane.energy(self.x) + (0.0 if self.bending is None else self.bending.energy(self.x))
