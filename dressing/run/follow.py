"""The garments follow a moving avatar: one frame after the other, written as it is computed."""

import math
import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from toile.dressing.body.avatar import Avatar
from toile.dressing.files.palette import BODY, garment_colour, linear
from toile.dressing.files.writers.atomic import writable_folder, write_atomic
from toile.dressing.files.writers.ply import PlyMesh, ply_bytes, read_own_ply
from toile.dressing.run.result import DressedGarment, Record, file_stem
from toile.dressing.wear.drape_types import DrapeOutcome, Failure, FrameState
from toile.dressing.wear.fault import place_of
from toile.dressing.wear.put_on import taken_apart
from toile.engine.cloth.cloth import Cloth
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.film.plan import (
    PUSHED_NEWTON,
    PUSHED_RISE,
    PUSHED_TOLERANCE,
    FilmFrame,
    FilmPlan,
    FilmState,
)
from toile.engine.film.simulate import Simulation
from toile.engine.forces.wind import AirFlow
from toile.engine.step.options import StageClock
from toile.remesh.sizing.sizing import SizingOptions

FRAMES = "frames"
"""Name of the folder of frames in the output folder."""
BODY_NAME = "body"
LONGEST_STEP = 1.0 / 60.0
"""Time steps at most [s], of two stages each."""


@dataclass(frozen=True, kw_only=True)
class Followed:
    """How garments followed a motion: they and the avatar at its end, why it ended early, figures."""

    garments: tuple[DressedGarment, ...]
    avatar: Avatar
    failure: Failure | None
    cancelled: bool
    figures: dict[str, Any]
    stage_seconds: dict[str, float]


def frame_path(frames: Path, name: str, index: int) -> Path:
    """Where the mesh of that name and frame is."""
    return frames / f"{file_stem(name)}.{index:04d}.ply"


def write_film(folder: Path, garments: tuple[DressedGarment, ...], fps: float, count: int) -> Path | None:
    """Write dressed.usdc of the `count` frames on disk; return its path, or None without USD."""
    try:
        from toile.dressing.files.writers.usd import UsdMesh, write_usd
    except ImportError:
        return None
    names = [(BODY_NAME, linear(BODY))]
    names += [(garment.name, linear(garment_colour(index))) for index, garment in enumerate(garments)]

    def frames(name: str) -> Iterator[PlyMesh]:
        return (read_own_ply(frame_path(folder / FRAMES, name, index)) for index in range(count))

    meshes = [
        UsdMesh(name=re.sub(r"\W", "_", file_stem(name)), colour=colour, frames=frames(name))
        for name, colour in names
    ]
    return write_usd(folder / "dressed.usdc", fps, meshes)


def follow(
    avatar: Avatar, drape: DrapeOutcome, garments: tuple[DressedGarment, ...], sizing: SizingOptions | None,
    air: AirFlow | None, folder: Path | None, on_frame: Callable[[FrameState], bool],
    keep: Callable[[FilmState], None], record: Record, state: FilmState | None = None,
) -> Followed:  # fmt: skip
    """Let draped garments follow their avatar's motion.

    Parameters
    ----------
    avatar
        The avatar as it was dressed, with its motion.
    drape, garments
        How the garments hang at its first frame.
    sizing
        How the mesh adapts, or None.
    air
        Air around the garments, or None.
    folder
        Where a PLY per frame goes of every garment, and of the body as cloth met it [m, Y up], or None.
    on_frame
        Called after every frame; returning False ends the film.
    keep
        Called after every frame with all that the film needs to go on from there.
    record
        Called with the number of every frame and the garments.
    state
        Where to go on instead of at the beginning.
    """
    motion = avatar.motion
    assert motion is not None
    started = time.perf_counter()
    frames = None if folder is None else writable_folder(folder / FRAMES)
    latest, skin, crossing = garments, avatar.vertices, ""
    last = len(motion.frames) - 1
    plan = FilmPlan(
        integrator=tr_bdf2, longest_step=LONGEST_STEP, step=replace(drape.step, air=air),
        frame_seconds=1.0 / motion.fps, newton=PUSHED_NEWTON,
        newton_tolerance=PUSHED_TOLERANCE, stretch_rise=PUSHED_RISE, sizing=sizing,
    )  # fmt: skip

    def as_of(cloth: Cloth) -> tuple[DressedGarment, ...]:
        parts = taken_apart(cloth, len(garments))
        return tuple(garment.now(part) for garment, part in zip(garments, parts, strict=True))

    def on_film_frame(frame: FilmFrame) -> bool:
        nonlocal latest, skin, crossing
        assert frame.avatar is not None
        skin, latest = frame.avatar, as_of(frame.cloth)
        if frames is not None:
            for garment in latest:
                corner_uv = garment.uv[garment.uv_faces] if garment.uv.any() else None
                content = ply_bytes(garment.positions, garment.faces, corner_uv)
                write_atomic(frame_path(frames, garment.name, frame.index), content)
            write_atomic(frame_path(frames, BODY_NAME, frame.index), ply_bytes(skin, avatar.faces))
        if not crossing and (len(frame.crossings.avatar) or len(frame.crossings.cloth)):
            crossing = f"frame {frame.index}; {place_of(frame.cloth, frame.crossings, garments)}"
        record(frame.index, latest)
        if frame.index:
            keep(film.state())
        return on_frame(
            FrameState(
                frame=frame.index, faces=len(frame.cloth.faces), contacts=frame.contacts, residual=math.nan,
                seconds=time.perf_counter() - started, max_frames=last,
            )
        )  # fmt: skip

    body = (avatar.vertices, avatar.faces)
    film = Simulation(drape.cloth, body, plan, on_film_frame, motion, StageClock(), drape.pin_motion)
    if state is not None:
        film.go_on_from(state)
        # The run may have been stopped between its last frame and its end.
        latest, skin = as_of(state.cloth), avatar.vertices if state.avatar is None else state.avatar
    done = 0 if state is None else len(state.record.crossings) - 1
    made = film.run((last - done) / motion.fps)
    failure = None
    if made.failure:
        frame = len(made.crossings) - 1
        failure = Failure(kind="motion", message=made.failure, where=f"frame {frame}")
    elif any(map(sum, made.crossings)):
        frame = next(index for index, found in enumerate(made.crossings) if sum(found))
        # The place is known of frames of this run; a film taken up after a crossing knows the frame only.
        failure = Failure(kind="crossing", message="triangles cross", where=crossing or f"frame {frame}")
    gaps = [gap for gap in made.min_gap if math.isfinite(gap)]
    figures = {
        "fps": motion.fps,
        "frames": len(made.crossings) - 1,
        "seconds": made.simulated_seconds,
        "steps": made.steps,
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
    return Followed(
        garments=latest, avatar=replace(avatar, vertices=skin), failure=failure, cancelled=made.cancelled,
        figures=figures, stage_seconds=film.clock.seconds,
    )  # fmt: skip
