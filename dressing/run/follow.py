"""Garments that follow a moving avatar, written frame by frame."""

import math
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.place import Place
from toile.dressing.files.writers.atomic import writable_folder, write_atomic
from toile.dressing.files.writers.ply import ply_bytes
from toile.dressing.run.checkpoint import Checkpoint, Hung
from toile.dressing.run.listener import Listener
from toile.dressing.run.output.earlier_run import FRAMES
from toile.dressing.run.output.film_files import BODY_NAME, frame_path
from toile.dressing.run.output.garment_figures import strain_figures, strain_percent
from toile.dressing.run.resolved_scene import ResolvedScene
from toile.dressing.run.result import DressedGarment
from toile.dressing.wear.drape_types import Failure, FrameState
from toile.dressing.wear.fault import place_of
from toile.dressing.wear.taken_apart import taken_apart
from toile.dressing.wear.watch import TOP, garment_areas, is_off, strained_places
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.film.begin_holds import at_start
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.film.plan import (
    LONGEST_STEP,
    PUSHED_NEWTON,
    PUSHED_RISE,
    PUSHED_TOLERANCE,
    FilmFrame,
    FilmPlan,
    FilmRecord,
    FilmState,
)
from toile.engine.film.simulate import Simulation
from toile.engine.forces.fan import Fan
from toile.geometry.stage_clock import Spent, StageClock

TIGHT = 0.4
"""Stretch that no fabric bears: where a film reaches it, its place is told."""


@dataclass(frozen=True, kw_only=True)
class Followed:
    """Outcome of a motion: garments and avatar at its end, why it ended early, figures, times.

    `end` are the figures of the garments at its end, by keys of the report.

    `count` is the number of the film's frames: none where its lead-in failed. `last` is the
    state at its end, in the body's frame.
    """

    garments: tuple[DressedGarment, ...]
    avatar: Avatar
    failure: Failure | None
    cancelled: bool
    figures: dict[str, Any]
    end: dict[str, Any]
    stages: dict[str, Spent]
    count: int
    last: FilmState


def follow(
    scene: ResolvedScene,
    hung: Hung,
    checkpoint: Checkpoint | None,
    listener: Listener,
    state: FilmState | None,
) -> Followed:
    """Let hung garments follow their avatar's motion.

    Parameters
    ----------
    scene
        Says how the mesh adapts, and what air there is.
    hung
        The avatar with its motion, and how the garments hang at its first frame.
    checkpoint
        Where every frame is noted, and in whose output folder a PLY per frame goes of every garment, and of
        the body as cloth met it [m, Y up]; None writes nothing.
    listener
        Told every frame; may cancel.
    state
        State to resume from, instead of starting at the beginning.
    """
    motion = hung.body.motion
    assert motion is not None
    started, clock = time.perf_counter(), StageClock()
    last = len(motion.frames) - 1
    shown = _Shown(hung, None if checkpoint is None else writable_folder(checkpoint.output / FRAMES))
    on_frame = listener.on_frame(scene.tolerance)

    def on_film_frame(frame: FilmFrame) -> bool:
        now = clock.now()
        shown.take(frame)
        if frame.index >= motion.lead:
            listener.record(frame.index - motion.lead, shown.garments)
        if frame.index and checkpoint is not None:
            checkpoint.frame(film.state())
        clock.add("io", now)
        return on_frame(
            FrameState(
                frame=frame.index, faces=len(frame.cloth.faces), contacts=frame.contacts, residual=math.nan,
                seconds=time.perf_counter() - started, max_frames=last,
                doing="leading in" if frame.index < motion.lead else "",
                phase="leading in" if frame.index < motion.lead else "film",
            )
        )  # fmt: skip

    body = (hung.body.vertices, hung.body.faces)
    film = Simulation(
        at_start(hung.drape.cloth, motion), body, _plan(scene, hung, motion.fps), on_film_frame, motion,
        clock, hung.drape.pin_motion,
    )  # fmt: skip
    done = 0
    if state is not None:
        film.go_on_from(state)
        shown.go_on_from(state)
        done = len(state.record.crossings) - 1
    made = film.run((last - done) / motion.fps)
    if max(made.stretch_max) > TIGHT:
        listener.say(_tight_sentence(made, shown, motion))
    for name in shown.fallen():
        listener.say(f"garment {name} has come off the body by the end: it is too wide for what holds it")
    return Followed(
        garments=shown.garments, avatar=replace(hung.avatar, vertices=shown.skin),
        failure=_failure(made, shown.crossing, motion), cancelled=made.cancelled,
        figures=_figures(made, motion), end=_end_figures(made, film, shown, hung),
        stages=clock.spent, count=max(len(made.crossings) - motion.lead, 0), last=film.state(),
    )  # fmt: skip


class _Shown:
    """The latest frame of a film, written where there is a folder, and the first place that crossed.

    Attributes
    ----------
    garments
        In the latest frame.
    skin
        The avatar as cloth met it then [m], shape (v, 3).
    crossing
        Frame and place in which triangles crossed first; empty while none did.
    tightest
        Largest stretch, its frame and its place in words, of the frames taken.
    """

    def __init__(self, hung: Hung, frames: Path | None) -> None:
        self.garments = hung.garments
        self.skin = hung.avatar.vertices
        self.crossing = ""
        self.tightest = (0.0, 0, "")
        self._tops = [float(np.quantile(garment.positions[:, 1], TOP)) for garment in hung.garments]
        self._avatar = hung.avatar
        self._place = hung.place
        self._frames = frames
        assert hung.body.motion is not None
        self._motion = hung.body.motion

    def take(self, frame: FilmFrame) -> None:
        """Take a frame."""
        assert frame.avatar is not None
        self.skin, self.garments = self._place.outward(frame.avatar), self._as_of(frame.cloth)
        if self._frames is not None and frame.index >= self._motion.lead:
            self._write(self._frames, frame.index - self._motion.lead)
        if frame.stretch_max > max(self.tightest[0], TIGHT):
            tightest, *_ = strained_places(frame.cloth, self.garments, self._place, beyond=0.0)
            self.tightest = (frame.stretch_max, frame.index, tightest.where)
        if not self.crossing and (len(frame.crossings.avatar) or len(frame.crossings.cloth)):
            where = place_of(frame.cloth, frame.crossings, self.garments, self._place)
            self.crossing = f"{self._motion.name(frame.index)}; {where}"

    def go_on_from(self, state: FilmState) -> None:
        """Take the last frame of a run that was stopped, perhaps between that and its end."""
        self.garments = self._as_of(state.cloth)
        if state.avatar is not None:
            self.skin = self._place.outward(state.avatar)

    def fallen(self) -> list[str]:
        """Return the names of garments that have come down and off the body since it began to move."""
        return [
            garment.name
            for garment, top in zip(self.garments, self._tops, strict=True)
            if is_off(garment.positions, top, self.skin)
        ]

    def _as_of(self, cloth: Cloth) -> tuple[DressedGarment, ...]:
        """Return the garments in the shape of a cloth."""
        parts = taken_apart(cloth, [garment.trims for garment in self.garments])
        return tuple(
            garment.now(part, self._place) for garment, part in zip(self.garments, parts, strict=True)
        )

    def _write(self, frames: Path, index: int) -> None:
        """Write a PLY of every garment and of the body."""
        for garment in self.garments:
            corner_uv = garment.uv[garment.uv_faces] if garment.uv.any() else None
            content = ply_bytes(garment.positions, garment.faces, corner_uv, garment.velocities)
            write_atomic(frame_path(frames, garment.name, index), content)
        write_atomic(frame_path(frames, BODY_NAME, index), ply_bytes(self.skin, self._avatar.faces))


def _tight_sentence(made: FilmRecord, shown: _Shown, motion: VertexMotion) -> str:
    """Say where a film stretches cloth more than fabric bears."""
    most = max(made.stretch_max)
    frame = made.stretch_max.index(most)
    name = motion.name(frame)
    # The place is known of frames of this run.
    where = f"; {shown.tightest[2]}" if shown.tightest[1] == frame and shown.tightest[2] else ""
    return (
        f"cloth is stretched by {100.0 * most:.0f} %, more than fabric bears, in {name}{where}: the "
        "motion leaves it no room there, or the garment is too tight"
    )


def _plan(scene: ResolvedScene, hung: Hung, fps: float) -> FilmPlan:
    """Return how the motion is computed; air blows in the room."""
    air = scene.air
    if air is not None:
        assert hung.body.motion is not None
        lead = hung.body.motion.lead / hung.body.motion.fps
        air = replace(
            air, velocity=tuple(hung.place.turned_in(np.array(air.velocity)).tolist()),
            fans=tuple(_in_frame(fan.later(lead), hung.place) for fan in air.fans),
        )  # fmt: skip
    return FilmPlan(
        integrator=tr_bdf2, longest_step=LONGEST_STEP, step=replace(hung.drape.step, air=air),
        frame_seconds=1.0 / fps, newton=PUSHED_NEWTON,
        newton_tolerance=PUSHED_TOLERANCE, stretch_rise=PUSHED_RISE, sizing=hung.sizing,
    )  # fmt: skip


def _in_frame(fan: Fan, place: Place) -> Fan:
    """Return a fan of the room in the body's frame."""
    return replace(
        fan, velocities=place.turned_in(np.array(fan.velocities)).tolist(),
        places=place.inward(np.array(fan.places or [(0.0, 0.0, 0.0)] * len(fan.times))).tolist(),
    )  # fmt: skip


def _failure(made: FilmRecord, crossing: str, motion: VertexMotion) -> Failure | None:
    """Return why a film failed, if it did; `crossing` is the first place that crossed, where it is known."""
    if made.failure:
        last = motion.name(len(made.crossings) - 1)
        return Failure(kind="motion", message=made.failure, where=last)
    if any(map(sum, made.crossings)):
        frame = next(index for index, found in enumerate(made.crossings) if sum(found))
        # The place is known of frames of this run; a film resumed after a crossing knows the frame only.
        return Failure(kind="crossing", message="triangles cross", where=crossing or motion.name(frame))
    return None


def _end_figures(made: FilmRecord, film: Simulation, shown: "_Shown", hung: Hung) -> dict[str, Any]:
    """Return how the garments are at the end of a film, by keys of the report."""
    before, garments = hung.report, shown.garments
    places = strained_places(film.cloth, garments, hung.place)
    worst = max(before["intersections"]["worst_frame"], *map(sum, made.crossings))
    gap = made.min_gap[-1]
    counts = {
        "nodes": sum(len(garment.positions) for garment in garments),
        "faces": sum(len(garment.faces) for garment in garments),
    }
    return {
        **{
            key: before[key] | {"final": count, "max": max(before[key]["max"], count)}
            for key, count in counts.items()
        },
        "intersections": {
            "avatar": made.crossings[-1][0], "self": made.crossings[-1][1], "worst_frame": worst,
        },
        "min_gap_mm": 1e3 * gap if math.isfinite(gap) else None,
        "strain_percent": strain_percent(garments) | {"over_50": [vars(place) for place in places]},
        "garments": [
            facts
            | {"nodes": len(garment.positions), "faces": len(garment.faces)}
            | {"area_m2": area}
            | strain_figures(garment)
            for facts, garment, area in zip(
                before["garments"], garments, garment_areas(film.cloth, len(garments)), strict=True
            )
        ],
    }  # fmt: skip


def _figures(made: FilmRecord, motion: VertexMotion) -> dict[str, Any]:
    """Return what the report says about a film; the worst and the work are those of its lead-in too."""
    lead, lead_steps = motion.lead, sum(made.steps_per_frame[: motion.lead + 1])
    gaps = [gap for gap in made.min_gap if math.isfinite(gap)]
    return {
        "fps": motion.fps,
        "frames": max(len(made.crossings) - 1 - lead, 0),
        "seconds": max(made.simulated_seconds - lead / motion.fps, 0.0),
        "steps": made.steps - lead_steps,
        "lead_in": {"frames": lead, "seconds": lead / motion.fps, "steps": lead_steps} if lead else None,
        "retries": made.retries,
        "steps_kept_unsolved": made.forced,
        "newton_iterations": made.newton_iterations,
        "faces_max": max(made.faces),
        "intersections_max": max(map(sum, made.crossings)),
        "min_gap_mm": 1e3 * min(gaps) if gaps else None,
        "strain_percent_max": 100.0 * max(made.stretch_max),
        "skin_held_back_mm_max": 1e3 * max(made.lag),
        "remeshings": len(made.remeshings),
    }
