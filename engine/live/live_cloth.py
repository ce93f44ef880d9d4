"""Cloth that goes on in steps of 1/60 s while somebody pulls, pins and blows at it, guarded as in films.

Every step is one linearly implicit step of the shipped stepper: its guard lets nothing pass through anything,
whatever the hand asks for. A step in which cloth would stretch a lot more is undone and made in two halves.
One in which obstacles would stretch it beyond what it bears is undone as well, and they rest for a while.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from toile.collide.audit import Auditor
from toile.collide.avatar_surface import AvatarSurface
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.forces.air_flow import AirFlow
from toile.engine.forces.ground import Ground
from toile.engine.forces.step_request import StepRequest
from toile.engine.live.breeze import Breeze
from toile.engine.live.hand import BEARABLE, SPEED, Hand
from toile.engine.live.obstacles import Obstacles, Surface
from toile.engine.live.push import Push
from toile.engine.step.cloth_run import ClothRun
from toile.engine.step.contact_loads import presses_of_nodes
from toile.engine.step.options import StepOptions, StepOutcome
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.errors import InputError
from toile.geometry.stage_clock import StageClock

STEP = 1.0 / 60.0
"""Length of a step [s]."""
TOLERANCE = 3e-2
"""Relative residual of the linear solver: that of films, 1e-2, takes five times the iterations in contact."""
RISE, STRETCHED = 0.05, 0.08
"""A step that raises the largest stretch by more than RISE, beyond STRETCHED, is made in two halves."""
RESTS = 6
"""Steps for which obstacles rest that would stretch the cloth by more than STRETCHED."""
PATCH = 0.04
"""Radius of the patch that a hand grips, along the pattern [m]."""
MORE = 0.02
"""How much more than now cloth may be stretched by a hand."""
FORCE = 10.0
"""Largest force of a hand, unless told [N]."""


@dataclass(frozen=True, kw_only=True)
class LiveFrame:
    """The state after a step.

    Attributes
    ----------
    step, seconds
        Number of the step, 0 at the start, and its time [s].
    positions, velocities
        Of nodes [m], [m/s], shapes (n, 3).
    stretch
        Largest stretch along warp or weft.
    contacts, held_back
        Contacts, and nodes whose motion the guard shortened.
    min_gap
        Smallest gap of a contact [m]; infinite if there was none.
    """

    step: int
    seconds: float
    positions: Float
    velocities: Float
    stretch: float
    contacts: int
    held_back: int
    min_gap: float


class LiveCloth(ClothRun):
    """Cloth beside obstacles, advanced by `advance` and changed by everything else between steps.

    Attributes
    ----------
    hand
        What pulls.
    push
        Forces on nodes.
    obstacles
        What the cloth meets.
    frame
        The state after the last step.
    """

    def __init__(self, cloth: Cloth, obstacles: Mapping[str, Surface], options: StepOptions) -> None:
        self.hand = Hand()
        self.push = Push(len(cloth.positions))
        self.obstacles = Obstacles(obstacles)
        self._breeze = Breeze(cloth.face_nodes, len(cloth.positions))
        self._ground: float | None = None
        self._pin_goals = cloth.positions.copy()
        self._driven = False
        self._rest = 0
        forces = (lambda _: self.hand, lambda _: self.push, lambda _: self._breeze)
        own = replace(options, air=None, more_forces=(*options.more_forces, *forces))
        super().__init__(cloth, self.obstacles.together(), own, StageClock())
        self._breeze.blow(options.air)
        self.frame = self._framed(0, StepOutcome(moved=np.zeros(len(cloth.positions))), self._stretch())

    # Steps.

    def advance(self) -> LiveFrame:
        """Advance by one step and return the state after it."""
        step, before = self.frame.step + 1, self.frame.stretch
        self._rest = max(0, self._rest - 1)
        saved = self.stepper.save()
        outcome = self._step(STEP, step * STEP)
        stretch = self._stretch()
        if stretch > max(before, STRETCHED) and self._driven:
            self.stepper.restore(saved)
            self._rest = RESTS
            outcome = self._step(STEP, step * STEP)
            stretch = self._stretch()
        if stretch > max(before + RISE, STRETCHED):
            self.stepper.restore(saved)
            self.hand.feel(stretch)
            for share in (0.5, 1.0):
                outcome = self._step(0.5 * STEP, (step - 1 + share) * STEP)
            stretch = self._stretch()
        self.hand.feel(stretch)
        self.frame = self._framed(step, outcome, stretch)
        return self.frame

    def _step(self, h: float, until: float) -> StepOutcome:
        """Make one step of h [s] that ends at a time [s]."""
        stepper = self.stepper
        target = pins = None
        if self.surface is not None and not self._rest:
            target = self.obstacles.next(self.surface.vertices, h)
        self._driven = target is not None
        if stepper.pinned is not None:
            ahead = self._pin_goals - stepper.x
            length = np.linalg.norm(ahead, axis=1)[:, None]
            pins = stepper.x + ahead * np.minimum(1.0, SPEED * h / np.maximum(length, 1e-300))
        return stepper.step(
            StepRequest(
                h=h, at_rest=False, cg_tolerance=TOLERANCE, motion_max=inf, avatar_target=target,
                pin_target=pins, seconds=until,
            )
        )  # fmt: skip

    def _stretch(self) -> float:
        return float(self.warp_weft_strain().max())

    def _framed(self, step: int, outcome: StepOutcome, stretch: float) -> LiveFrame:
        """Return the state after a step."""
        stepper = self.stepper
        return LiveFrame(
            step=step, seconds=step * STEP, positions=stepper.x.copy(), velocities=stepper.v.copy(),
            stretch=stretch, contacts=outcome.contacts, held_back=outcome.limited,
            min_gap=outcome.min_gap,
        )  # fmt: skip

    # What somebody does between steps.

    def grip(self, node: int, force: float = FORCE, radius: float = PATCH) -> None:
        """Grip the cloth around a node, along its pattern [m], to pull with `force` [N] at most."""
        self._check_nodes(np.array([node]))
        held = self._around(node, radius)
        held = held[~self.pinned[held]]
        if not len(held):
            raise InputError(f"node {node} is pinned; move it as a pin", field="node")
        fabric = self.cloth.fabrics[0]
        weight = float(self.cloth.mass.sum()) * self.stepper.options.gravity
        softest = min(fabric.stretch_warp, fabric.stretch_weft)
        self.hand.grip(held, self.stepper.x, self.cloth.node_area, force)
        # What hangs on one hand stretches by its own weight, however gently it is pulled; what is stretched
        # already, as a garment that is worn, by a little more.
        self.hand.bear(max(BEARABLE + weight / (2.0 * radius * softest), self.frame.stretch + MORE))

    def pull_to(self, offset: Float | Sequence[float]) -> None:
        """Say how far from where it was gripped the patch shall be [m], shape (3,)."""
        self.hand.wanted = np.asarray(offset, np.float64).reshape(3)

    def release(self) -> None:
        """Let go of what is gripped."""
        self.hand.release()

    @property
    def pinned(self) -> Bool:
        """Nodes that are pinned, shape (n,)."""
        pinned = self.stepper.pinned
        return np.zeros(len(self.stepper.x), bool) if pinned is None else pinned

    def pin(self, nodes: Int) -> None:
        """Pin nodes, shape (k,), where they are."""
        self._check_nodes(nodes)
        pinned = self.pinned.copy()
        pinned[nodes] = True
        self._pin_goals[nodes] = self.stepper.x[nodes]
        self.stepper.pin(pinned)

    def unpin(self, nodes: Int | None = None) -> None:
        """Let pins go, shape (k,), or all."""
        pinned = self.pinned.copy()
        pinned[slice(None) if nodes is None else nodes] = False
        self.stepper.pin(pinned)

    def move_pins(self, nodes: Int, places: Float) -> None:
        """Say where pinned nodes, shape (k,), shall be [m], shape (k, 3): they go there at 1.5 m/s."""
        self._check_nodes(nodes)
        free = np.asarray(nodes)[~self.pinned[nodes]]
        if len(free):
            raise InputError(f"node {free[0]} is not pinned; pin it first", field="nodes")
        self._pin_goals[nodes] = places

    def pressure(self) -> Float:
        """Return the pressure of obstacles and cloth on the nodes now [Pa], shape (n,)."""
        collisions, x = self.stepper.collisions, self.stepper.x
        if collisions is None:
            return np.zeros(len(x))
        press = presses_of_nodes(collisions.detect(x), len(x))
        return np.asarray(press / np.maximum(self.cloth.node_area, 1e-12))

    @property
    def ground(self) -> float | None:
        """Height of the floor [m], or None."""
        return self._ground

    def blow(self, air: AirFlow | None) -> None:
        """Let air flow from here on; None is a vacuum."""
        self._breeze.blow(air)

    def lay_ground(self, height: float | None) -> None:
        """Put a floor at a height [m], or take it away."""
        self._ground = height
        self._renew()

    def change_fabric(self, fabric: Fabric) -> None:
        """Make all of the cloth of another fabric, where it is."""
        self.cloth = replace(self.cloth, fabrics=(fabric,), fabric=np.zeros(len(self.cloth.faces), np.int32))
        self._renew()

    def change_options(self, **numbers: object) -> None:
        """Change numbers of `StepOptions`: gravity, friction, self_contact.

        Raises InputError if cloth that crosses itself is to touch itself.
        """
        options = replace(self.stepper.options, **numbers)  # type: ignore[arg-type]
        if options.self_contact and not self.stepper.options.self_contact and len(self.audit().cloth):
            raise InputError(
                "the cloth crosses itself; reset it before it may touch itself", field="self_contact"
            )
        self._renew(options)

    def put_obstacle(self, name: str, surface: Surface | None) -> None:
        """Put an obstacle there, in the place of any of that name, or take it away.

        Raises InputError if it would cut the cloth.
        """
        surfaces = self.obstacles.surfaces(None if self.surface is None else self.surface.vertices)
        surfaces.pop(name, None)
        if surface is not None:
            if len(Auditor(*surface).audit(self.stepper.x, self.cloth.face_nodes, self.cloth.weld).avatar):
                raise InputError(f"{name} would cut the cloth; put it elsewhere", field=name)
            surfaces[name] = surface
        self.obstacles = Obstacles(surfaces)
        together = self.obstacles.together()
        self.surface, self.auditor = None if together is None else AvatarSurface(*together), None
        self._renew()

    def obstacle(self, name: str) -> Float:
        """Return where an obstacle's vertices are [m], shape (v, 3). Raises InputError if there is none."""
        there = self.obstacles.surfaces(None if self.surface is None else self.surface.vertices)
        if name not in there:
            raise InputError(f"there is no obstacle {name!r}; there is {', '.join(there) or 'none'}")
        return there[name][0]

    def move_obstacle(self, name: str, vertices: Float) -> None:
        """Say where an obstacle's vertices shall be [m], shape (v, 3); it goes there at 1.5 m/s at most."""
        self.obstacle(name)
        self.obstacles.want(name, vertices)
        self.auditor = None

    def _around(self, node: int, radius: float) -> Int:
        """Return the nodes of the same panel within a distance of one in the pattern [m], or that one."""
        cloth = self.cloth
        own = int(np.flatnonzero(cloth.node == node)[0])
        panel = np.full(len(cloth.node), -1, np.int64)
        panel[cloth.faces] = (cloth.garment.astype(np.int64) * 65536 + cloth.panel)[:, None]
        near = np.linalg.norm(cloth.uv - cloth.uv[own], axis=1) <= radius
        return np.unique(cloth.node[near & (panel == panel[own])]).astype(np.int32)

    def _check_nodes(self, nodes: Int) -> None:
        """Raise InputError for a node that is not there."""
        wrong = [int(node) for node in np.atleast_1d(nodes) if not 0 <= node < len(self.stepper.x)]
        if wrong:
            raise InputError(
                f"there is no node {wrong[0]}; they go from 0 to {len(self.stepper.x) - 1}", field="nodes"
            )

    def _renew(self, options: StepOptions | None = None) -> None:
        """Make the stepper anew, as the cloth is and moves."""
        stepper = self.stepper
        pinned, collisions = stepper.pinned, stepper.collisions
        anchors = None if collisions is None else collisions.anchor[: len(stepper.x)].copy()
        cloth = replace(self.cloth, positions=stepper.x.copy(), velocities=stepper.v.copy())
        self.restart(cloth, anchors, options=options)
        self.stepper.pin(pinned)
        if self._ground is not None:
            self.stepper.forces.append(Ground(self._ground, self.cloth.node_area))
