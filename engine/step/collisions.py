"""Contact of one cloth in one object: search, contact forces, safe moves and friction anchors.

It is a force like others where its energy and derivatives are concerned. Beyond that it finds the pairs that
can touch, shortens displacements to what is safe, and moves the avatar along.
"""

import numpy as np

from toile.collide.avatar_surface import AvatarSurface
from toile.collide.cover import Cover
from toile.collide.guard import safe_factors
from toile.collide.search import ContactSearch
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.folds import pressed_radius
from toile.engine.forces.contact import NO_MOTION, Contacts, Meeting, evaluate_contacts
from toile.engine.forces.contact_pairs import node_thickness, pair_friction
from toile.engine.forces.force import NodalForce
from toile.engine.forces.untangle import Untangling
from toile.engine.solve.hessian import Hessian
from toile.engine.solve.linear_system import ContactStencils
from toile.engine.step.friction_anchors import slid_anchors
from toile.engine.step.options import StepOptions
from toile.engine.step.safe_motion import (
    LEAST_ALLOWANCE,
    MOTION_AHEAD,
    expect,
    expect_avatar,
    safe_in_motion,
)
from toile.geometry.arrays import Bool, Float

DRIFT_ALLOWANCE, EDGE_SHARE = 5e-3, 0.2
"""Room of candidates in motion beside the drift of the nodes: at most [m], and as a share of their edges."""
OVERSIZE, FEW = 4.0, 0.02
"""Candidates for more than OVERSIZE times the motion at hand are too many, and searched anew; a share of FEW
nodes may be held back for want of candidates rather than search anew."""


class Collisions(NodalForce):
    """Contact of a cloth with itself, where it may touch itself, and with an avatar, where there is one.

    Attributes
    ----------
    search
        Candidate pairs.
    avatar
        The avatar's surface, or None.
    anchor
        Where friction holds every node and avatar vertex [m], shape (n + v, 3).
    radius_body
        Contact radius against the avatar of every node and vertex [m], shape (n + v,).
    least_body_radius
        What `set_body_radius` was given last [m].
    found
        Contacts of the last detection.
    """

    def __init__(self, cloth: Cloth, avatar: AvatarSurface | None, options: StepOptions) -> None:
        self.options = options
        self._cloth = cloth
        self._count = len(cloth.positions)
        self._thickness = node_thickness(cloth)
        self.search = ContactSearch(
            cloth.face_nodes, cloth.weld, avatar, self_contact=options.self_contact,
            radius_self=max(options.radius_self, float(self._thickness.max())),
            radius_body=options.radius_body,
        )  # fmt: skip
        self.least_body_radius = options.radius_body
        self._allowed = np.clip(EDGE_SHARE * cloth.shortest_edge, LEAST_ALLOWANCE, DRIFT_ALLOWANCE)
        self._beside(avatar, cloth.positions)

    def meet(self, avatar: AvatarSurface, roam: Cover | None = None) -> None:
        """Meet this avatar, or part of one, from here on, with no memory of searches; anchors stay.

        `roam` says where nodes may be before other parts come near; None: anywhere.
        """
        self.search.meet(avatar, roam)
        self._beside(avatar, self.anchor[: self._count])

    def _beside(self, avatar: AvatarSurface | None, anchor: Float) -> None:
        """Set up what there is per node and per vertex of an avatar; anchors of nodes [m], shape (n, 3)."""
        options, count, cloth = self.options, self._count, self._cloth
        self.avatar = avatar
        others = 0 if avatar is None else len(avatar.vertices)
        rows = None if avatar is None else avatar.rows
        self._pair_friction = pair_friction(cloth, others, options.friction, options.parts, rows)
        self._area = np.concatenate([cloth.node_area, np.zeros(0) if avatar is None else avatar.vertex_area])
        self.radius_body = np.empty(count + others)
        self.set_body_radius(self.least_body_radius)
        radius_self = np.minimum(np.maximum(options.radius_self, self._thickness), 0.4 * cloth.shortest_edge)
        if cloth.folds is not None:
            pressed = pressed_radius(cloth.folds, cloth.faces, cloth.uv, cloth.node)
            radius_self = np.minimum(radius_self, pressed)
        self._radius_self = np.concatenate([radius_self, np.full(others, options.radius_self)])
        self.anchor = np.concatenate([anchor, np.zeros((0, 3)) if avatar is None else avatar.vertices])
        self._motion = np.zeros(count)
        self.found: Contacts | None = None

    # As a force.

    def energy(self, x: Float) -> float:
        """Barrier energy [J] of the candidates at x [m], shape (n, 3)."""
        return self._evaluate(x, NO_MOTION).energy

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add minus the contact forces, without friction, of the candidates at x [N] to shape (n, 3)."""
        self._evaluate(x, NO_MOTION).add_gradient(gradient)

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add what `detect` found, without friction: the iteration solver adds it with friction instead."""
        assert self.found is not None
        self.found.add_gradient(gradient)
        hessian.add_stencils(ContactStencils(self.found.nodes, self.found.weights, self.found.stiffness))

    # Detection.

    def detect(self, x: Float, ahead: Float | None = None, avatar_ahead: Float | None = None) -> Contacts:
        """Find and evaluate contacts at x [m], shape (n, 3), and those that motion leads to.

        `ahead` is the expected motion of the nodes [m], shape (n, 3), `avatar_ahead` the avatar's, (v, 3).
        """
        search, avatar = self.search, self.avatar
        if avatar_ahead is None and avatar is not None and avatar.drift is not None:
            # From here on it stands still.
            avatar.stay()
            search.expire_body()
        if ahead is None:
            allowance, motion = search.allowance(x), MOTION_AHEAD * self._motion + LEAST_ALLOWANCE
            if not (allowance > 0.0).all() or allowance.max() > OVERSIZE * motion.max():
                search.search(x, motion)
            moving = NO_MOTION
        elif avatar_ahead is not None and avatar is not None:
            expect_avatar(search, avatar, avatar_ahead, x, ahead, self._allowed)
            moving = np.concatenate([ahead, avatar_ahead])
        else:
            # Candidates that miss some contacts ahead are safe: what the step then asks for is searched.
            expect(search, x, ahead, self._allowed)
            moving = np.zeros_like(search.positions)
            moving[: self._count] = ahead
        self.found = self._evaluate(x, moving)
        search.measured(*self.found.distances)
        return self.found

    def _evaluate(self, x: Float, moving: Float) -> Contacts:
        """Evaluate the candidates at x [m], shape (n, 3), with motion to come [m], shape (n + v, 3)."""
        search, options = self.search, self.options
        search.place(x)
        return evaluate_contacts(
            search.positions, self.anchor, self._count,
            Meeting(search.body, self.radius_body, options.law_body),
            Meeting(search.cloth, self._radius_self, options.law_self),
            self._area, self._pair_friction, moving,
        )  # fmt: skip

    def set_body_radius(self, radius: float) -> None:
        """Set the least contact radius against the avatar [m]; thicker fabrics keep their thickness away."""
        self.least_body_radius = radius
        own = np.maximum(radius, self._thickness)
        most = float(own.max())
        self.radius_body[: self._count], self.radius_body[self._count :] = own, most
        if self.search.radius_body != most:
            self.search.radius_body = most
            self.search.expire()

    # Safe moves.

    def safe(self, x: Float, wanted: Float, longest: float) -> tuple[Float, Bool]:
        """Shorten displacements from x [m], shapes (n, 3), to `longest` and to what is safe.

        Also marks the nodes held back, shape (n,).
        """
        length = np.linalg.norm(wanted, axis=1)
        scale = np.minimum(1.0, longest / np.maximum(length, 1e-300))
        wanted, length = wanted * scale[:, None], length * scale
        self._motion = length
        search = self.search
        allowance = search.allowance(x)
        short = ~(allowance >= length)
        if np.count_nonzero(short) > FEW * len(length) or not np.isfinite(allowance).all():
            search.search(x, MOTION_AHEAD * length + LEAST_ALLOWANCE)
        elif short.any():
            # A few nodes wait: using up their allowance brings about the next search.
            cut = np.where(short, np.maximum(allowance, 0.0) / np.maximum(length, 1e-300), 1.0)
            wanted = wanted * cut[:, None]
        search.place(x)
        move = np.zeros_like(search.positions)
        move[: self._count] = wanted
        factor = safe_factors(search.positions, move, *search.pairs)[: self._count]
        return wanted * factor[:, None], factor < 1.0

    def moved_by(self, move: Float) -> None:
        """Say how far a step at rest has moved the nodes [m], shape (n, 3): the next goes about as far."""
        self._motion = np.linalg.norm(move, axis=1)

    def safe_in_motion(
        self, x: Float, wanted: Float, avatar_wanted: Float | None, pinned: bool
    ) -> tuple[Float, Bool]:
        """Shorten displacements from x [m], shapes (n, 3), to what is safe, and move the avatar.

        Also marks the nodes held back. `avatar_wanted` is how far the avatar's vertices shall move [m], shape
        (v, 3). With `pinned` nodes cloth goes nowhere as a whole.
        """
        common = None if avatar_wanted is None or pinned else wanted.mean(axis=0)
        done = safe_in_motion(self.search, x, wanted, self._allowed, self.avatar, avatar_wanted, common)
        if avatar_wanted is not None and self.avatar is not None:
            self.avatar.move_to(self.avatar.vertices + done.avatar)
        return done.cloth, done.limited

    def put_avatar(self, vertices: Float) -> None:
        """Put the avatar's vertices somewhere [m], shape (v, 3), whatever cloth is there."""
        assert self.avatar is not None
        self.avatar.move_to(np.ascontiguousarray(vertices))
        self.avatar.stay()
        self.anchor[self._count :] = vertices
        self.search.expire()

    def forget(self) -> None:
        """Let go of what was found: the next detection searches anew."""
        self.search.forget()
        self.found = None

    # What may pass, and what friction holds on to.

    def let_pass(self, ghost: Bool, avatar_ghost: Bool | None = None) -> Untangling | None:
        """Let marked nodes, shape (n,), pass through each other and through marked avatar vertices.

        Returns what draws them apart where they cross; None if none are marked.
        """
        own = np.zeros(len(self.anchor) - self._count, bool) if avatar_ghost is None else avatar_ghost
        marked = np.concatenate([ghost, own])
        self.search.let_pass(marked)
        if not ghost.any():
            return None
        faces = self.search.all_faces
        crossing = np.ascontiguousarray(faces[marked[faces].any(axis=1)])
        return Untangling(crossing, self.search.weld, self._count, self.search.positions)

    def ignore(self, still: Bool | None) -> None:
        """Leave out pairs in which only marked nodes, shape (n,), and the avatar take part; None: none.

        Pairs in which nothing moves need no look.
        """
        marked = np.zeros(len(self.anchor), bool)
        if still is not None:
            marked[:] = True
            marked[: self._count] = still
        self.search.let_pass(marked)

    def take_anchors(self, x: Float, contacts: Contacts, avatar_moved: bool) -> None:
        """Let friction anchors follow a step that ended at x [m], shape (n, 3), with these contacts."""
        count, carried = self._count, None
        if avatar_moved and self.avatar is not None:
            carried = self.avatar.vertices - self.anchor[count:]
            self.anchor[count:] = self.avatar.vertices
        self.anchor[:count] = slid_anchors(x, self.anchor[:count], contacts, self.options.slip, carried)
