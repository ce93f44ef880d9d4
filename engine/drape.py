"""The frame loop of a drape on a still body: sew the seams shut, let go, settle to equilibrium.

Draping asks for the equilibrium, not for the movie: every step starts at rest, so an implicit step of
size h is a damped Newton step on the static problem, and growing h turns it into the Newton step itself.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import Literal

import numpy as np

from toile.collide.audit import Auditor, Crossings
from toile.collide.search import AvatarSurface
from toile.engine.cloth import Cloth
from toile.engine.forces.hold import Holds, SewingHolds
from toile.engine.step import ClothStepper, StageClock, StepOptions, StepOutcome, StepRequest
from toile.engine.zipper import zipper_distance
from toile.geometry.arrays import Bool, Float, Int

STEPS_PER_FRAME = 10
Phase = Literal["sewing", "growing", "settling"]


@dataclass(frozen=True, kw_only=True)
class DrapePlan:
    """Numbers of the frame loop.

    Attributes
    ----------
    step
        Implicit step options.
    max_steps
        Steps after which the drape stops unconverged.
    steps_per_frame
        Steps between two audited output frames.
    sewing_step, settling_step, longest_step
        Step size while sewing, at the start of settling, and its upper limit [s].
    closing_per_step
        How much the longest seam gap shrinks per sewing step [m].
    zipper_per_step
        How far closing spreads along a seam from its junctions per step [m].
    stitch_stiffness
        Stiffness of one stitch [N/m] when sewing begins.
    stiffening
        Factor on it for every step after the seams should have met.
    sliding_steps, sliding_stiffness
        Steps at most, and hold stiffness [N/m], to slide panels in their planes before they close.
    hold_stiffness
        Stiffness that keeps a stitched node near the place where its seam should meet [N/m].
    late_stiffness
        Stiffness of a stitch that is still open after sewing [N/m].
    closed_gap
        Sewing ends early when every stitch is shorter than this [m].
    merge_gap
        Gap at which the two nodes of a stitch merge [m].
    patience
        Sewing steps granted after the seams should have met.
    jam_radius
        Cloth this close to a stitch that cannot close may pass through itself until it is disentangled [m].
    tighten_stiffness
        Stiffness of the springs that pull tangled cloth smooth [N/m].
    growth_lag
        How far a vertex of the growing avatar may lag before the rest waits [m].
    easing_steps
        Steps without gravity and friction before the garment settles.
    waist_stiffness
        Stiffness that keeps waistbands at their height meanwhile [N/m].
    rms_motion, peak_motion
        Equilibrium: largest RMS and 99.9th percentile node motion over a frame of longest steps [m].
    cg_tolerance
        Relative residual of the linear solver.
    """

    step: StepOptions
    max_steps: int
    steps_per_frame: int = STEPS_PER_FRAME
    sewing_step: float = 1.0 / 60.0
    settling_step: float = 1.0 / 60.0
    longest_step: float = 0.25
    closing_per_step: float = 0.03
    zipper_per_step: float = 0.02
    stitch_stiffness: float = 300.0
    stiffening: float = 1.05
    sliding_steps: int = 15
    sliding_stiffness: float = 30.0
    hold_stiffness: float = 30.0
    late_stiffness: float = 1000.0
    closed_gap: float = 1e-3
    merge_gap: float = 6e-3
    patience: int = 12
    jam_radius: float = 0.03
    tighten_stiffness: float = 50.0
    easing_steps: int = 20
    waist_stiffness: float = 20.0
    growth_lag: float = 0.002
    rms_motion: float = 3e-4
    peak_motion: float = 3e-3
    cg_tolerance: float = 1e-2


@dataclass(frozen=True, kw_only=True)
class Growth:
    """A shape the avatar takes on, vertices (v, 3) [m], and how far it may move in a step [m]."""

    vertices: Float
    per_step: float


@dataclass(frozen=True, kw_only=True)
class Frame:
    """One audited output frame."""

    index: int
    step: int
    phase: Phase
    cloth: Cloth
    contacts: int
    rms_motion: float
    peak_motion: float
    crossings: Crossings


@dataclass
class DrapeRecord:
    """What a drape did.

    `crossings` counts crossing pairs (avatar, cloth) per audited frame; `settled_crossings` only those of
    output frames, in which the sewn garment settles. `node_counts` lists the sizes of its topologies.
    """

    steps: int = 0
    newton_iterations: int = 0
    cg_iterations: int = 0
    contacts_max: int = 0
    simulated_seconds: float = 0.0
    rms_motion: float = np.inf
    peak_motion: float = np.inf
    converged: bool = False
    cancelled: bool = False
    crossings: list[tuple[int, int]] = field(default_factory=list)
    settled_crossings: list[tuple[int, int]] = field(default_factory=list)
    node_counts: list[int] = field(default_factory=list)


class Drape:
    """A drape in progress: call `run`.

    The avatar is given as it is while seams close (vertices, faces); `growth` lists the shapes it then takes
    on one after the other, the last being its true one (none: it has it already).
    """

    def __init__(
        self, cloth: Cloth, avatar: tuple[Float, Int] | None, growth: list[Growth], plan: DrapePlan,
        on_frame: Callable[[Frame], bool],
    ) -> None:  # fmt: skip
        self.cloth = cloth
        self.plan = plan
        self.on_frame = on_frame
        self.clock = StageClock()
        self.record = DrapeRecord()
        self._surface = None if avatar is None else AvatarSurface(*avatar)
        self._growth = growth
        self._auditor: Auditor | None = None
        self._stepper = ClothStepper(cloth, self._surface, plan.step, self.clock)
        self.record.node_counts.append(len(cloth.positions))
        self._ghost = np.zeros(len(cloth.node), bool)
        self._frames = 0
        self._audited = -1
        self.phase: Phase = "sewing" if len(cloth.stitches) else "settling"

    def run(self) -> DrapeRecord:
        """Sew, settle, stop at equilibrium, at the step limit or when on_frame returns False."""
        self._join_touching()
        self._close_frame(0)
        if self.phase == "sewing":
            self._sew()
        if len(self._growth) > 1:
            self._relax_tangles()
            self._ease()
        for shape in self._growth:
            if not self._stopped():
                self.phase = "growing"
                self._grow(shape.vertices, shape.per_step)
        self._relax_tangles()
        self._ease()
        if not self._stopped():
            self.phase = "settling"
            self._settle()
        if self._audited != self.record.steps:
            self._close_frame(0)
        return self.record

    def _audit(self) -> Crossings:
        """Crossings of the cloth as it is; the auditor is made anew after the avatar has moved."""
        stepper, surface = self._stepper, self._surface
        if self._auditor is None:
            self._auditor = Auditor(None, None) if surface is None else Auditor(surface.vertices, surface.faces)
        return self._auditor.audit(stepper.x, stepper.faces, self.cloth.weld)

    def _grow(self, target: Float, per_step: float) -> None:
        """Let the avatar take on its true shape while the cloth gives way.

        It grows evenly: where cloth holds it back the rest waits, or its free parts would form a ledge
        around the cloth.
        """
        plan = self.plan
        assert self._surface is not None
        start = self._surface.vertices.copy()
        longest = max(float(np.linalg.norm(target - start, axis=1).max()), 1e-12)
        share = 0.0
        left = 0.0
        while not self._stopped():
            self._merge_late()
            if left < plan.growth_lag:
                share = min(1.0, share + per_step / longest)
            shape = target if share == 1.0 else start + share * (target - start)
            left = self._stepper.grow_avatar(shape, 2.0 * per_step)
            self._auditor = None
            self._take(
                StepRequest(
                    h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False,
                    stitch_stiffness=plan.late_stiffness, tighten_stiffness=plan.tighten_stiffness, cg_tolerance=plan.cg_tolerance,
                )
            )  # fmt: skip
            if share == 1.0 and left == 0.0:
                break
            if self.record.steps % plan.steps_per_frame == 0:
                self._disentangle()
        self._stepper.grow_avatar(target, 0.0)

    def _take(self, request: StepRequest) -> StepOutcome:
        outcome = self._stepper.step(request)
        record = self.record
        record.steps += 1
        record.newton_iterations += outcome.newton_iterations
        record.cg_iterations += outcome.cg_iterations
        record.contacts_max = max(record.contacts_max, outcome.contacts)
        record.simulated_seconds += request.h
        if record.steps % self.plan.steps_per_frame == 0:
            self._close_frame(outcome.contacts)
        return outcome

    def _close_frame(self, contacts: int) -> None:
        """Audit the cloth as it is and hand it out."""
        now = perf_counter()
        stepper = self._stepper
        self.cloth = replace(self.cloth, positions=stepper.x.copy(), velocities=stepper.v.copy())
        crossings = self._audit()
        counts = (len(crossings.avatar), len(crossings.cloth))
        self.record.crossings.append(counts)
        if self.phase == "settling":
            self.record.settled_crossings.append(counts)
        self.clock.add("audit", now)
        frame = Frame(
            index=self._frames, step=self.record.steps, phase=self.phase, cloth=self.cloth, contacts=contacts,
            rms_motion=self.record.rms_motion, peak_motion=self.record.peak_motion, crossings=crossings,
        )  # fmt: skip
        self._frames += 1
        self._audited = self.record.steps
        if not self.on_frame(frame):
            self.record.cancelled = True

    def warp_weft_strain(self) -> Float:
        """Strain along warp and weft of every face now, shape (t, 2)."""
        return self._stepper.membrane.warp_weft_strain(self._stepper.x)

    def smallest_gap(self) -> float | None:
        """Smallest distance between cloth and avatar or cloth now [m]; None if nothing is within reach."""
        contacts = self._stepper.contacts(StepRequest(h=1.0, at_rest=True))
        return None if contacts is None or not contacts.count else float(contacts.gap.min())

    def _stopped(self) -> bool:
        return self.record.cancelled or self.record.steps >= self.plan.max_steps

    def _gaps(self) -> Float:
        pairs = self.cloth.stitches
        return np.linalg.norm(self._stepper.x[pairs[:, 0]] - self._stepper.x[pairs[:, 1]], axis=1)

    def _join_touching(self) -> None:
        """Merge stitches that are closed from the start, such as those along the texture seams of a mesh."""
        if not len(self.cloth.stitches):
            return
        touching = self.cloth.stitch_length < 1e-9
        if touching.any():
            self.cloth = self.cloth.merged(touching)
            self._stepper = ClothStepper(self.cloth, self._surface, self.plan.step, self.clock)
            self.record.node_counts.append(len(self.cloth.positions))
        if not len(self.cloth.stitches):
            self.phase = "settling"

    def _sew(self) -> None:
        plan = self.plan
        holds = self._stepper.holds
        assert isinstance(holds, SewingHolds)
        self._slide_in_plane()
        if self._stopped():
            return
        self._stepper.stitch_length = self._gaps()
        closing = max(1, int(np.ceil(self._stepper.stitch_length.max() / plan.closing_per_step)))
        pairs = self.cloth.stitches
        delay = (
            zipper_distance(self.cloth.positions, pairs, self.cloth.seam, self.cloth.weld)
            / plan.zipper_per_step
        )
        total = closing + int(np.ceil(delay.max()))
        stiffness, hold = plan.stitch_stiffness, plan.hold_stiffness
        node_share = np.ones(len(self.cloth.positions))
        for count in range(total + 2 * plan.patience):
            share = np.clip(1.0 - (count + 1 - delay) / closing, 0.0, 1.0)
            node_share[pairs[:, 0]] = share
            node_share[pairs[:, 1]] = share
            if count == total + plan.patience:
                self._let_pass(self._around(pairs[self._gaps() >= plan.closed_gap].ravel()))
            if count >= total:
                stiffness *= plan.stiffening
                hold *= 0.7
                if (self._gaps() < plan.closed_gap).all():
                    break
            holds.approach(node_share)
            self._take(
                StepRequest(
                    h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False, hold_stiffness=hold,
                    stitch_share=share, stitch_stiffness=stiffness, cg_tolerance=plan.cg_tolerance,
                )
            )  # fmt: skip
            if self._stopped():
                return
        self._merge()

    def _around(self, nodes: Int, widening: float = 1.0) -> Bool:
        """Mark material vertices within `widening` jam radii of nodes, along the cloth, shape (m,)."""
        faces = self._stepper.faces
        marked = node_mask(len(self._stepper.x), nodes)
        edge = float(np.sqrt(2.0 * self.cloth.rest_area.mean()))
        for _ in range(int(np.ceil(widening * self.plan.jam_radius / edge))):
            marked[faces[marked[faces].any(axis=1)].ravel()] = True
        return np.asarray(marked[self.cloth.node])

    def _let_pass(self, ghost: Bool) -> None:
        """Let marked material vertices, shape (m,), pass through each other until they are disentangled."""
        self._ghost = ghost
        self._stepper.let_pass(node_mask(len(self._stepper.x), self.cloth.node[ghost]))

    def _disentangle(self, effort: float = 1.0) -> bool:
        """Make cloth that no longer crosses itself solid again; return whether all of it is.

        The patch that stays passable around a crossing grows with the square root of `effort`.
        """
        if not self._ghost.any():
            return True
        stepper = self._stepper
        crossing = self._audit().cloth
        if len(crossing):
            self._let_pass(self._around(stepper.faces[crossing.ravel()].ravel(), np.sqrt(effort)))
            return False
        self._let_pass(np.zeros_like(self._ghost))
        return True

    def _slide_in_plane(self) -> None:
        """Bring stitched nodes over their meeting places, each in the plane of its panel."""
        plan = self.plan
        for _ in range(plan.sliding_steps):
            if self._stopped():
                return
            outcome = self._take(
                StepRequest(
                    h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False,
                    hold_stiffness=plan.sliding_stiffness, cg_tolerance=plan.cg_tolerance,
                )
            )  # fmt: skip
            if outcome.moved.max() < 0.1 * plan.closing_per_step:
                break

    def _merge(self) -> None:
        """Move the nodes of closed stitches together as far as is safe, and merge those that arrived."""
        gaps = self._gaps()
        near = gaps < self.plan.merge_gap
        stepper = self._stepper
        cloth = replace(self.cloth, positions=stepper.x.copy(), velocities=stepper.v.copy())
        trial = cloth.merged(near)
        target = np.empty_like(stepper.x)
        target[cloth.node] = trial.positions[trial.node]
        for _ in range(30):
            wanted = target - stepper.x
            if np.abs(wanted).max() < 1e-12:
                break
            stepper.safe_move(wanted)
        # A node stands for all that are merged with it: one late node keeps its whole group open.
        weld = cloth.weld
        late = np.zeros(len(weld), bool)
        late[weld[np.linalg.norm(target - stepper.x, axis=1) >= 1e-9]] = True
        closed = near & ~late[weld[cloth.stitches[:, 0]]]
        if closed.any():
            radius = stepper.radius_body.copy()
            self.cloth = replace(cloth, positions=stepper.x.copy()).merged(closed)
            self._stepper = ClothStepper(self.cloth, self._surface, self.plan.step, self.clock)
            self.record.node_counts.append(len(self.cloth.positions))
            self._stepper.radius_body[:] = radius.max()
            self._let_pass(self._ghost)

    def _merge_late(self) -> bool:
        """Every few steps, merge stitches that have closed since; return whether any were."""
        if not len(self.cloth.stitches) or self.record.steps % self.plan.steps_per_frame:
            return False
        count = len(self.cloth.stitches)
        if (self._gaps() < self.plan.merge_gap).any():
            self._merge()
        return len(self.cloth.stitches) < count

    def _relax_tangles(self) -> None:
        """Pull tangled cloth smooth, without gravity, until nothing crosses any more.

        Whatever resists is pulled harder, over a wider patch, from frame to frame.
        """
        plan = self.plan
        effort = 1.0
        while not self._stopped() and not self._disentangle(effort):
            for _ in range(plan.steps_per_frame):
                if self._stopped():
                    return
                self._take(
                    StepRequest(
                        h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False,
                        stitch_stiffness=plan.late_stiffness, tighten_stiffness=effort * plan.tighten_stiffness,
                        cg_tolerance=plan.cg_tolerance,
                    )
                )  # fmt: skip
            effort = min(2.0 * effort, 16.0)

    def _ease(self) -> None:
        """Let the garment slide into place before friction holds it; waistbands stay at their height."""
        plan = self.plan
        stepper = self._stepper
        waist = self.cloth.waist
        start = np.empty_like(stepper.x)
        start[self.cloth.node] = self.cloth.start_positions
        stepper.holds = Holds(waist, start[waist], np.tile([0.0, 1.0, 0.0], (len(waist), 1)))
        h = plan.sewing_step
        for _ in range(plan.easing_steps):
            if self._stopped():
                return
            self._take(
                StepRequest(
                    h=h, at_rest=True, friction=False, hold_stiffness=plan.waist_stiffness,
                    stitch_stiffness=plan.late_stiffness, cg_tolerance=plan.cg_tolerance,
                )
            )  # fmt: skip
            h = min(1.2 * h, plan.longest_step)
        stepper.holds = None

    def _settle(self) -> None:
        """Step to equilibrium: no node moves any more over a whole frame of long steps."""
        plan, record = self.plan, self.record
        h = plan.settling_step
        before = self._stepper.x.copy()
        long_steps = 0
        while not self._stopped():
            if self._merge_late():
                before, long_steps = self._stepper.x.copy(), 0
            outcome = self._take(
                StepRequest(
                    h=h, at_rest=True, stitch_stiffness=plan.late_stiffness, cg_tolerance=plan.cg_tolerance,
                )
            )  # fmt: skip
            peak = float(np.quantile(outcome.moved, 0.999))
            long_steps = long_steps + 1 if h >= plan.longest_step else 0
            if peak < 0.01:
                h = min(h * 1.2, plan.longest_step)
            elif peak > 0.025:
                h = max(h / 1.5, plan.settling_step)
            if record.steps % plan.steps_per_frame == 0:
                motion = np.linalg.norm(self._stepper.x - before, axis=1)
                before = self._stepper.x.copy()
                record.rms_motion = float(np.sqrt(np.mean(motion**2)))
                record.peak_motion = float(np.quantile(motion, 0.999))
                if long_steps >= plan.steps_per_frame and record.rms_motion < plan.rms_motion:
                    record.converged = record.peak_motion < plan.peak_motion
            if record.converged:
                break


def node_mask(count: int, nodes: Int) -> Bool:
    """Mark nodes in an array of `count`."""
    mask = np.zeros(count, bool)
    mask[nodes] = True
    return mask
