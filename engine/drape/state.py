"""A drape in progress: its cloth, its stepper and what was done so far."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.drape.plan import DrapePlan, DrapeRecord, Frame, Growth, Phase
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.cloth_run import ClothRun
from toile.engine.step.memory import Memory
from toile.engine.step.options import StepOptions, StepOutcome
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.stage_clock import StageClock

MOVED, MOVED_AT_END = 0.5, 0.1
"""RMS motion since the last remeshing, in shortest edges, at which a mesh is adapted again."""

FIRST_SHARE, GENTLE_SHARE = 0.4, 0.65
"""Share of all steps after which the first and the second attempt to loosen tangles are given up."""

STITCH_REACH, OPEN_REACH = 0.02, 0.004
"""Largest elongation of a stitch that pulls [m]; of one that is left open, which would only crumple cloth."""

POP = 0.1
"""How much farther a node of a settled drape may move after a remeshing, in shortest edges: more would be
seen."""


class BeforePassing(NamedTuple):
    """A drape before cloth was let pass through itself: the cloth, and avatar vertices [m], shape (v, 3)."""

    cloth: Cloth
    avatar: Float | None


class DrapeState(ClothRun):
    """State that the phases of a drape share.

    Attributes
    ----------
    ghost
        Material vertices that may pass through each other until they are disentangled, shape (m,).
    avatar_ghost
        Avatar vertices they may pass through as well, shape (v,), or None.
    before_passing
        The drape before cloth was let pass so that seams could close, or None.
    gentle
        Whether tangles that resisted a first attempt are drawn apart less hard, over narrower patches.
    solid
        Whether no cloth may pass any more: seams that close only so stay open.
    pin_when_sewn
        Material vertices pinned once the cloth is sewn and the avatar has its true shape, shape (m,),
        in the mesh in which the cloth is sewn; or None.
    pins_hold
        Whether they are pinned.
    reach
        Largest elongation of a stitch that pulls [m].
    growth
        Shapes the avatar takes on one after the other.
    phase
        What is being done.
    audited
        Step after which the last frame was audited; -1 before the first.
    record, plan
        What was done, and what to do.
    """

    def __init__(
        self, cloth: Cloth, avatar: tuple[Float, Int] | None, growth: list[Growth], plan: DrapePlan,
        on_frame: Callable[[Frame], bool], pin_when_sewn: Bool | None = None,
    ) -> None:  # fmt: skip
        super().__init__(cloth, avatar, plan.step, StageClock())
        self.plan = plan
        self.on_frame = on_frame
        self.record = DrapeRecord(first_faces=len(cloth.faces))
        self.growth = growth
        self.record.node_counts.append(len(cloth.positions))
        self.ghost: Bool = np.zeros(len(cloth.node), bool)
        self.avatar_ghost: Bool | None = None
        self.before_passing: BeforePassing | None = None
        self.gentle = False
        self.solid = False
        self.pin_when_sewn = pin_when_sewn
        self.pins_hold = False
        self.reach = STITCH_REACH
        self._meshed_at = cloth.positions
        self._before: tuple[Cloth, ClothStepper] | None = None
        self._fitted = False
        self._frames = 0
        self.audited = -1
        self.phase: Phase = "sewing" if len(cloth.stitches) else "growing" if growth else "settling"

    def over(self) -> bool:
        """Whether the user cancelled, or the limit of steps or of work has come."""
        return self.record.cancelled or self.record.steps >= self.plan.max_steps or self.is_spent()

    def is_spent(self) -> bool:
        """Whether cloth took all the work that it may take until it settles."""
        return self.plan.most_work is not None and self.record.work >= self.plan.most_work

    def stopped(self) -> bool:
        """Whether the present phase must end: the drape is over, or tangles had their share of the steps.

        That holds for tangles that can be taken back: what is left of the steps is for the next attempt.
        """
        share = GENTLE_SHARE if self.gentle else FIRST_SHARE
        late = self.record.steps >= share * self.plan.max_steps
        return self.over() or (late and bool(self.ghost.any()) and self.before_passing is not None)

    def gaps(self) -> Float:
        """Length of every open stitch now [m], shape (s,)."""
        pairs = self.cloth.stitches
        return np.asarray(np.linalg.norm(self.stepper.x[pairs[:, 0]] - self.stepper.x[pairs[:, 1]], axis=1))

    def restart(
        self, cloth: Cloth, anchors: Float | None = None, memory: Memory | None = None,
        options: StepOptions | None = None,
    ) -> None:  # fmt: skip
        """Continue with a cloth of another topology."""
        super().restart(cloth, anchors, memory, options)
        self._before = None
        self._meshed_at = self.stepper.x.copy()
        self.record.node_counts.append(len(cloth.positions))
        self.let_pass(self.ghost, self.avatar_ghost)

    def remesh(self, at_rest: bool = False) -> bool:
        """Adapt the mesh to the cloth's present shape, where the plan says so; return whether it changed.

        While cloth may pass through itself its mesh stays. Cloth `at_rest` finds its new equilibrium where
        the mesh has changed; else its elastic energy stays what it is.
        """
        if self.plan.sizing is None or self.ghost.any():
            return False
        # Its kernels are compiled for scenes that ask for it only.
        from toile.engine.adapt.remeshing import remesh_run

        started = self.clock.now()
        before = self.cloth, self.stepper
        request = StepRequest(
            h=self.plan.longest_step, at_rest=True, gravity=float(at_rest),
            stitch_stiffness=self.plan.late_stiffness, stitch_reach=self.reach,
            cg_tolerance=self.plan.cg_tolerance,
        )  # fmt: skip
        done = remesh_run(self, self.plan.sizing, request, self.record.steps, keep_energy=not at_rest)
        if done is not None:
            self.record.remeshings.append(done)
            self.record.node_counts.append(len(self.cloth.positions))
            self.ghost = np.zeros(len(self.cloth.node), bool)
            self._before = before if at_rest else None
        self._meshed_at = self.stepper.x.copy()
        self.clock.add("remesh", started)
        return done is not None

    def keep_mesh(self, pop: float) -> bool:
        """Keep the mesh; return False where a remeshing at rest, just made, is taken back instead.

        `pop` is how much farther a node moved in the first step on it than in the last on the one before [m].
        The first mesh that is fitted to cloth at rest is kept anyway: before, the drape is not settled.
        """
        if self.plan.sizing is None or self._before is None:
            return True
        before, self._before = self._before, None
        if not self._fitted:
            self._fitted = True
            return True
        if pop <= POP * self.plan.sizing.size_min:
            self.record.pop = max(self.record.pop, pop)
            return True
        self.cloth, self.stepper = before
        self.ghost = np.zeros(len(self.cloth.node), bool)
        self.record.remeshings.pop()
        self.record.node_counts.pop()
        return False

    def needs_remeshing(self, finished: bool) -> bool:
        """Whether the cloth has moved so far since it was meshed that its mesh may not fit any more."""
        if self.plan.sizing is None:
            return False
        moved = float(np.sqrt(np.mean((self.stepper.x - self._meshed_at) ** 2) * 3.0))
        return moved > (MOVED_AT_END if finished else MOVED) * self.plan.sizing.size_min

    def remember(self) -> None:
        """Save the drape as it is, so that a second attempt can start from here."""
        cloth = replace(self.cloth, positions=self.stepper.x.copy(), velocities=np.zeros_like(self.stepper.x))
        avatar = None if self.surface is None else self.surface.vertices.copy()
        self.before_passing = BeforePassing(cloth, avatar)

    def let_pass(self, ghost: Bool, avatar_ghost: Bool | None = None) -> None:
        """Let marked material vertices, shape (m,), pass through each other and marked avatar vertices."""
        self.ghost, self.avatar_ghost = ghost, avatar_ghost
        self.stepper.let_pass(node_mask(len(self.stepper.x), self.cloth.node[ghost]), avatar_ghost)

    def take(self, request: StepRequest) -> StepOutcome:
        """Make one step, book it, and close a frame where one is due."""
        outcome = self.stepper.step(request)
        record = self.record
        record.steps += 1
        if self.phase != "settling":
            record.work += outcome.newton_iterations * len(self.cloth.faces)
        record.newton_iterations += outcome.newton_iterations
        record.cg_iterations += outcome.cg_iterations
        record.contacts_max = max(record.contacts_max, outcome.contacts)
        record.simulated_seconds += request.h
        if record.steps % self.plan.steps_per_frame == 0:
            self.close_frame(outcome.contacts)
        return outcome

    def close_frame(self, contacts: int) -> None:
        """Audit the cloth as it is and hand it out."""
        crossings = self.audited_cloth()
        counts = (len(crossings.avatar), len(crossings.cloth))
        self.record.crossings.append(counts)
        if self.phase == "settling":
            self.record.settled_crossings.append(counts)
        frame = Frame(
            index=self._frames, step=self.record.steps, phase=self.phase, cloth=self.cloth, contacts=contacts,
            rms_motion=self.record.rms_motion, peak_motion=self.record.peak_motion, crossings=crossings,
        )  # fmt: skip
        self._frames += 1
        self.audited = self.record.steps
        if not self.on_frame(frame):
            self.record.cancelled = True


def node_mask(count: int, nodes: Int) -> Bool:
    """Mark nodes in an array of `count`."""
    mask = np.zeros(count, bool)
    mask[nodes] = True
    return mask
