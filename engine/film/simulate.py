"""The frame loop of a film: cloth in motion on a still or moving avatar, frames at a fixed rate."""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from math import inf

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.film.advance import Way, advance
from toile.engine.film.avatar_path import AvatarPath
from toile.engine.film.avatar_skin import AvatarSkin
from toile.engine.film.plan import FilmFrame, FilmPlan, FilmRecord, FilmState
from toile.engine.film.step_sizes import StepLimits, StepSizes
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.cloth_run import ClothRun
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import CrowdedError
from toile.geometry.stage_clock import StageClock

MOVED = 1.0
"""RMS motion since the last remeshing, drift aside, at which a mesh is adapted again, in shortest edges."""
RELAXING = 0.01
"""Step size in which the nodes around remeshed faces find their places [s]."""
CATCHING_UP = 12
"""Short steps at most in which cloth gives way to an avatar that it has held back."""
ARRIVED = 2e-4
"""Distance at which an avatar's vertex counts as where it shall be [m]: less is not worth short steps."""
PINNED = 1e-9
"""The same of a pin [m]."""


class Simulation(ClothRun):
    """A film in progress: call `run`.

    The avatar is given as (vertices, faces) where it is at the start; it follows `motion`, from time 0, or
    does not move. Where cloth is caught between two skins, it holds them back: the avatar stays behind its
    motion there until they part. Pins and goals follow the handles of the cloth, which go along `pin_motion`.
    `on_frame` is called with every audited frame and ends the film by returning False.
    """

    def __init__(
        self, cloth: Cloth, avatar: tuple[Float, Int] | None, plan: FilmPlan,
        on_frame: Callable[[FilmFrame], bool], motion: VertexMotion | None = None,
        clock: StageClock | None = None, pin_motion: VertexMotion | None = None,
    ) -> None:  # fmt: skip
        super().__init__(cloth, avatar, plan.step, clock or StageClock())
        self.plan = plan
        self.on_frame = on_frame
        self.motion = motion
        self.pin_motion = None if cloth.handles is None else pin_motion
        self.path: AvatarPath | None = None
        self.skin: AvatarSkin | None = None
        if motion is not None and avatar is not None:
            self.path, self.skin = AvatarPath(motion, avatar[1]), AvatarSkin(*avatar)
        self.record = FilmRecord()
        self._meshed_at = cloth.positions
        limits = StepLimits(
            longest=plan.longest_step, shortest=plan.shortest_step, motion_max=plan.motion_max,
            stretch_rise=plan.stretch_rise,
        )  # fmt: skip
        self._sizes = StepSizes(limits, plan.longest_step)
        self._contacts = 0
        self._min_gap = inf
        self._steps = 0
        self._driven_speed = 0.0
        self._lag = 0.0

    def run(self, seconds: float) -> FilmRecord:
        """Advance by `seconds`, rounded to whole frames, or until on_frame returns False."""
        if not self.record.crossings:
            self._close_frame()
        for _ in range(round(seconds / self.plan.frame_seconds)):
            if self.record.cancelled or self._jumps():
                break
            try:
                self._to_next_frame()
            except (FloatingPointError, CrowdedError) as error:
                last = self._called(len(self.record.crossings) - 1)
                self.record.failure = f"the solver broke down after {last}: {error}"
            if self.record.failure:
                break
        return self.record

    def _to_next_frame(self) -> None:
        """Adapt the mesh, step to the next frame and close it."""
        # Before the mesh is adapted, and after: a film that is resumed after this frame runs the same.
        self._focus(self._frame_time())
        if self._remesh():
            self._focus(self._frame_time())
        self._advance()
        self._catch_up()
        self._close_frame()

    def state(self) -> FilmState:
        """Return all that is needed to resume the film after a frame."""
        stepper = self.stepper
        return FilmState(
            cloth=self.cloth, memory=stepper.memory,
            anchors=self.anchors(),
            avatar=self.body()[0],
            poses={} if self.path is None else dict(self.path.poses),
            meshed_at=self._meshed_at, longest_step=self._sizes.h, record=deepcopy(self.record),
        )  # fmt: skip

    def go_on_from(self, state: FilmState) -> None:
        """Resume a film of the same avatar, plan and motion from the state of another."""
        if self.path is not None and self.skin is not None and state.avatar is not None:
            self.skin.vertices = state.avatar
            self.path.poses.update(state.poses)
        self.restart(state.cloth, state.anchors, state.memory)
        self._meshed_at, self._sizes.h = state.meshed_at, state.longest_step
        self.record = deepcopy(state.record)

    def _frame_time(self) -> float:
        """Time of the last frame [s]."""
        return (len(self.record.crossings) - 1) * self.plan.frame_seconds

    def body(self) -> tuple[Float | None, Int | None]:
        """Vertices [m], shape (v, 3), and faces, (t, 3), of the whole avatar as cloth met it last."""
        return super().body() if self.skin is None else (self.skin.vertices, self.skin.faces)

    def _focus(self, since: float, length: float = 0.0) -> None:
        """Let steps meet the part of a moving avatar that cloth may come to from a time on [s].

        In the midst of a frame nothing happens while cloth stays near that part in a step of a length [s].
        """
        if self.path is None or self.skin is None:
            return
        stepper, skin = self.stepper, self.skin
        if length and skin.reaches(stepper.x + length * stepper.v):
            return
        now = self.clock.now()
        path, left = self.path, self._frame_time() + self.plan.frame_seconds - since
        if length:
            skin.whole(path.at(since))
        near = skin.focus(
            (stepper.x, self.cloth.face_nodes), left * stepper.v, path.at(since + left),
            lambda share, part: path.at(since + share * left, part),
        )  # fmt: skip
        self.surface = near.surface
        self._driven_speed = max(self._driven_speed, near.longest_way / left)
        stepper.meet(near.surface, near.roam)
        self.clock.add("avatar", now)

    def _jumps(self) -> bool:
        """Whether avatar or pins jump until the next frame: no cloth can follow."""
        if self.path is not None and self.skin is not None:
            now = self.clock.now()
            self.path.see(self.skin.vertices, self.stepper.x)
            self.clock.add("avatar", now)
        self._driven_speed = 0.0
        for motion, name, point in (
            (self.motion, "the avatar jumps", "its vertex"), (self.pin_motion, "pins jump", "handle")
        ):  # fmt: skip
            if motion is None:
                continue
            speed, number = motion.speed(self._frame_time(), self.plan.frame_seconds)
            if motion is self.pin_motion:
                self._driven_speed = speed
            if speed > self.plan.speed_max:
                self.record.failure = (
                    f"{name} after {self._called(len(self.record.crossings) - 1)}: {point} {number} moves "
                    f"{speed * self.plan.frame_seconds:.2f} m in {self.plan.frame_seconds:.3g} s; give more "
                    "frames in between, or start a new scene there"
                )
        return bool(self.record.failure)

    def _called(self, index: int) -> str:
        """Return what messages call a frame."""
        return f"frame {index}" if self.motion is None else self.motion.name(index)

    def _remesh(self) -> bool:
        """Adapt the mesh to the cloth's shape and motion, where the plan says so and both have changed.

        Returns whether there is a new mesh.

        Cloth that has not moved yet keeps its mesh: a flat one would lose what its first folds need.
        """
        plan, record = self.plan, self.record
        if plan.sizing is None or not record.steps or (len(record.crossings) - 1) % plan.remesh_frames:
            return False
        away = self.stepper.x - self._meshed_at
        away -= away.mean(axis=0)
        if float(np.sqrt((away**2).sum() / len(away))) < MOVED * plan.sizing.size_min:
            return False
        # Its kernels are compiled for scenes that ask for it only.
        from toile.engine.adapt.remeshing import remesh_run

        now = self.clock.now()
        request = StepRequest(
            h=RELAXING, at_rest=True, gravity=0.0, cg_tolerance=plan.cg_tolerance, seconds=self.cloth.now
        )
        done = remesh_run(self, plan.sizing, request, record.steps, keep_energy=True)
        if done is not None:
            record.remeshings.append(done)
        self._meshed_at = self.stepper.x.copy()
        self.clock.add("remesh", now)
        return done is not None

    def _advance(self) -> None:
        """Step to the next frame."""
        way = Way(
            integrator=self.plan.integrator, ask=self._request, prepare=self._focus, stretch=self.stretch_max,
            driven_speed=self._driven_speed,
        )  # fmt: skip
        span = (self._frame_time(), self.plan.frame_seconds)
        for outcome in advance(self.stepper, way, self._sizes, span, self.record):
            self._steps += 1
            self._contacts = outcome.contacts
            self._min_gap = min(self._min_gap, outcome.min_gap)

    def _request(self, length: float, until: float) -> StepRequest:
        """Return what a stage of a length [s] that ends at a time [s] is asked for."""
        plan = self.plan
        return StepRequest(
            h=length, at_rest=False, newton=plan.newton, newton_tolerance=plan.newton_tolerance,
            cg_tolerance=plan.cg_tolerance, motion_max=inf,
            avatar_target=self._avatar_at(until),
            pin_target=self._pins(until), seconds=until,
        )  # fmt: skip

    def _avatar_at(self, seconds: float) -> Float | None:
        """Where the avatar near cloth is at a time [m], shape (k, 3); None if it stands still."""
        if self.path is None or self.skin is None:
            return None
        now = self.clock.now()
        place = self.path.at(seconds, self.skin.part)
        self.clock.add("avatar", now)
        return place

    def _pins(self, seconds: float) -> Float | None:
        """Where handles take pins and goals at a time [m], shape (n, 3); only their rows count."""
        cloth = self.cloth
        if self.pin_motion is None or cloth.handles is None:
            return None
        stay = cloth.positions
        if cloth.goals is not None:
            stay = np.where(cloth.pinned[:, None], stay, cloth.goals.places)
        led = np.asarray(cloth.handles.sum(axis=1)).reshape(-1, 1) > 0.5
        return np.where(led, cloth.handles @ self.pin_motion.at(seconds), stay)

    def _catch_up(self) -> None:
        """Let cloth give way where it holds avatar or pins back, without time passing."""
        plan, stepper = self.plan, self.stepper
        if self.path is None and self.pin_motion is None:
            return
        now = self._frame_time() + plan.frame_seconds
        target, pins = self._avatar_at(now), self._pins(now)
        arrived = ARRIVED if pins is None else PINNED
        lag, place = self._behind(target, pins)
        if lag > arrived:
            velocities, memory = stepper.v, stepper.memory
            for _ in range(CATCHING_UP):
                stepper.put(stepper.x, np.zeros_like(stepper.x), memory)
                stepper.step(
                    StepRequest(
                        h=plan.shortest_step, at_rest=False, gravity=0.0, cg_tolerance=plan.cg_tolerance,
                        motion_max=inf, avatar_target=target, pin_target=pins, seconds=now,
                    )
                )  # fmt: skip
                before = lag
                lag, place = self._behind(target, pins)
                if lag <= arrived or lag > 0.9 * before:
                    break
            stepper.put(stepper.x, velocities, memory)
        if lag > plan.lag_max:
            self.record.failure = (
                f"cloth holds {'the avatar' if pins is None else 'avatar or pins'} back by "
                f"{1e3 * lag:.0f} mm in {self._called(len(self.record.crossings))} near ({place[0]:.2f}, "
                f"{place[1]:.2f}, {place[2]:.2f}) m: it is caught where it cannot give way"
            )
        self._lag = lag

    def _behind(self, avatar: Float | None, pins: Float | None) -> tuple[float, Float]:
        """How far and where avatar or pins are farthest from their targets [m], shapes (v, 3), (n, 3)."""
        stepper = self.stepper
        apart = [(0.0, np.zeros(3))]
        if avatar is not None and self.surface is not None:
            apart.append(_farthest(self.surface.vertices, avatar))
        if pins is not None and stepper.pinned is not None:
            apart.append(_farthest(stepper.x[stepper.pinned], pins[stepper.pinned]))
        return max(apart, key=lambda one: one[0])

    def stretch_max(self) -> float:
        """Largest stretch along warp or weft now."""
        return float(self.warp_weft_strain().max())

    def _close_frame(self) -> None:
        """Audit the cloth as it is, pass it to the caller and record it."""
        record = self.record
        if self.path is not None and self.skin is not None and record.crossings:
            self.skin.whole(self.path.at(self._frame_time() + self.plan.frame_seconds))
            self.stepper.forget()
            self.auditor = None
        self.cloth = replace(self.cloth, now=len(record.crossings) * self.plan.frame_seconds)
        crossings = self.audited_cloth()
        frame = FilmFrame(
            index=len(record.crossings), seconds=record.simulated_seconds, cloth=self.cloth,
            crossings=crossings, steps=self._steps, contacts=self._contacts, min_gap=self._min_gap,
            stretch_max=self.stretch_max(),
            avatar=self.body()[0], lag=self._lag,
        )  # fmt: skip
        record.crossings.append((len(crossings.avatar), len(crossings.cloth)))
        record.faces.append(len(self.cloth.faces))
        record.steps_per_frame.append(frame.steps)
        record.stretch_max.append(frame.stretch_max)
        record.min_gap.append(frame.min_gap)
        record.lag.append(frame.lag)
        self._steps, self._contacts, self._min_gap = 0, 0, inf
        if not self.on_frame(frame):
            record.cancelled = True


def _farthest(there: Float, target: Float) -> tuple[float, Float]:
    """Largest distance between vertices, both shape (v, 3), and where it is [m]."""
    distance = np.linalg.norm(there - target, axis=1)
    most = int(distance.argmax())
    return float(distance[most]), there[most]
