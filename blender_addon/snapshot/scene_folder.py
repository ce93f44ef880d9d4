"""The folder that the engine reads: scene.toml, job.json, the avatar, a file per garment."""

import hashlib
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from toile.blender_addon.frame_folders import file_stem
from toile.blender_addon.problem import Problem
from toile.blender_addon.properties import NOT_DRAFTED, OWN_VALUES
from toile.blender_addon.snapshot.avatar_snapshot import MOVING, STILL, AvatarSnapshot, write_still
from toile.blender_addon.snapshot.cast import Cast
from toile.blender_addon.snapshot.garment_snapshot import GarmentSnapshot, fed_by_modifiers_above
from toile.blender_addon.snapshot.obstacle_snapshot import ObstacleSnapshot
from toile.blender_addon.snapshot.space import Space, metres_per_unit
from toile.blender_addon.snapshot.wind import Weather
from toile.dressing.files.writers.npz_motion import MotionWriter
from toile.geometry.arrays import Float

ELSEWHERE = 0.05
"""A body that moves by more than this between draft and simulation is in another place [m]."""


def check_settings(scene: Any) -> None:
    """Raise Problem where a run could not begin, before any work is done."""
    if not bpy.data.filepath:
        raise Problem("save the .blend file first: the frames are kept beside it")
    if scene.toile.mode == "SIMULATE" and scene.toile.frame_end <= scene.toile.frame_start:
        raise Problem("a simulation needs at least two frames: set its end after its start")


def write_scene(context: Any, folder: Path, cast: Cast, pattern: str | None = None) -> Iterator[str]:
    """Write all that the engine needs, a bit at a time; yield what is being done.

    `pattern` is what is to be drafted to the avatars of the cast, which has no garments then. What is to be
    simulated is drafted at the first frame of the simulation, wherever the playhead is.
    """
    scene, settings = context.scene, context.scene.toile
    garments = list(cast.garments)
    films = pattern is None and settings.mode == "SIMULATE"
    travels = settings.mode == "SIMULATE"
    frames = [first_frame(scene)]
    if films:
        frames = list(range(settings.frame_start, settings.frame_end + 1))
    seen: list[GarmentSnapshot] = []
    solids: list[ObstacleSnapshot] = []
    fps = scene.render.fps / scene.render.fps_base
    before = scene.frame_current, scene.frame_subframe
    body: AvatarSnapshot | None = None
    with fed_by_modifiers_above(garments):
        try:
            writer: MotionWriter | None = None
            for frame in frames:
                if travels:
                    scene.frame_set(frame)
                depsgraph = context.evaluated_depsgraph_get()
                if body is None:
                    space = Space.upright(scene) if pattern is not None else Space.falling(scene)
                    weather = Weather(scene, space, films=films)
                    body = AvatarSnapshot(cast.avatars, scene, space)
                    solids += [
                        ObstacleSnapshot(part, number, scene, space, folder, len(frames))
                        for number, part in enumerate(cast.obstacles)
                    ]
                    for solid in (body, *solids):
                        for _ in solid.read(depsgraph):
                            yield f"reading {solid.name}"
                    for obj, stem in zip(garments, stems(garments), strict=True):
                        seen.append(GarmentSnapshot(obj, stem, space, folder, len(frames)))
                        for _ in seen[-1].read(context.evaluated_depsgraph_get()):
                            yield f"reading {obj.name}"
                    depsgraph = context.evaluated_depsgraph_get()
                vertices = body.see(depsgraph)
                for solid in solids:
                    solid.note(depsgraph)
                weather.see(scene)
                if films and frame == frames[0]:
                    _check_drafts(context, body, vertices, [garment.obj for garment in seen])
                for garment in seen:
                    garment.see(depsgraph)
                if not films:
                    write_still(folder, vertices, body.faces)
                    continue
                if writer is None:
                    writer = MotionWriter(folder / MOVING, "vertices", len(frames), len(vertices))
                writer.add(vertices)
                yield f"reading frame {frame}"
            if writer is not None and body is not None:
                writer.close(faces=body.faces, fps=fps)
        finally:
            if travels:
                scene.frame_set(before[0], subframe=before[1])
    for garment in seen:
        garment.write(fps)
        yield f"reading {garment.obj.name}"
    text = _scene_toml(scene, weather, films, seen, pattern)
    text += "".join(f"{line}\n" for solid in solids for line in solid.write(fps))
    (folder / "scene.toml").write_text(text, encoding="utf-8")
    parts = [body, *solids] if body is not None else []
    job = {
        "first_frame": frames[0], "sequence": films, "turn": space.turn.tolist(), "fit": settings.use_fit,
        "notes": [*weather.notes(), *(_without_fit(garments) if settings.use_fit else ())],
        "avatars": [part.obj.name for part in cast.avatars],
        "thickened": [name for part in parts for name in part.thickened],
        "garments": [_entry(garment, text) for garment in seen],
    }  # fmt: skip
    (folder / "job.json").write_text(json.dumps(job), encoding="utf-8")


def first_frame(scene: Any) -> int:
    """Return the frame in which garments are put on: the start of a simulation, else the present one."""
    start: int = scene.toile.frame_start if scene.toile.mode == "SIMULATE" else scene.frame_current
    return start


def _check_drafts(context: Any, body: AvatarSnapshot, vertices: Float, garments: list[Any]) -> None:
    """Raise Problem if a garment was drafted where the body, vertices (v, 3) now, was elsewhere."""
    scene = context.scene
    start = scene.frame_current
    for obj in garments:
        frame = obj.toile.draft_frame
        if frame in (NOT_DRAFTED, start):
            continue
        scene.frame_set(frame)
        there = body.see(context.evaluated_depsgraph_get())
        scene.frame_set(start)
        if np.abs(there - vertices).max() > ELSEWHERE:
            raise Problem(
                f"'{obj.name}' was drafted in frame {frame}, where the body is elsewhere than in frame "
                f"{start}: let the simulation start there, or draft it again"
            )


def stems(garments: Sequence[Any]) -> list[str]:
    """Return a file name for every garment, each another."""
    names: list[str] = []
    for obj in garments:
        stem = file_stem(obj.name)
        while stem in names or stem in ("avatar", "draft"):
            stem += "_"
        names.append(stem)
    return names


def _without_fit(garments: Sequence[Any]) -> list[str]:
    """Return a sentence for every garment that can have no maps of its fit."""
    return [
        f"'{obj.name}' has no fit maps: it keeps its topology" for obj in garments if obj.toile.keep_topology
    ]


def _entry(garment: GarmentSnapshot, text: str) -> dict[str, Any]:
    """Return what the writer of a garment's frames must know."""
    obj = garment.obj
    geometry = b"".join(garment.arrays[key].tobytes() for key in ("faces", "uv_faces", "uv"))
    return {
        "stem": garment.stem,
        "name": obj.name,
        "pieces": garment.pieces(),
        "carriers": [list(carrier) for carrier in garment.carriers],
        "left_behind": garment.left_behind,
        "keep_topology": obj.toile.keep_topology,
        "fingerprints": {
            "settings": hashlib.sha256(text.encode()).hexdigest()[:16],
            "topology": hashlib.sha256(geometry).hexdigest()[:16],
        },
    }


def _scene_toml(
    scene: Any, weather: Weather, films: bool, seen: list[GarmentSnapshot], pattern: str | None
) -> str:
    """Return toile's own scene file."""
    settings, scale = scene.toile, metres_per_unit(scene)
    lines = [f'quality = "{settings.quality}"', f"threads = {settings.threads}"]
    if settings.use_fit and pattern is None:
        lines.append('fit = "maps"')
    lines += weather.lines
    if settings.size_min > 0.0:
        lines.append(f"edge_length = {scale * settings.size_min:.6f}")
    if not settings.use_remesh:
        lines.append("remesh = false")
    elif settings.size_max > 0.0:
        lines += ["[remesh]", f"size_max = {scale * settings.size_max:.6f}"]
    lines += weather.air(scene.render.fps / scene.render.fps_base)
    lines += ["[avatar]", f'file = "{MOVING if films else STILL}"', 'units = "m"', 'up = "y"']
    if pattern is not None:
        lines += ["[[garment]]", f"source = {json.dumps(pattern, ensure_ascii=False)}"]
    for garment in seen:
        fabric = f"fabric of {garment.obj.name}"
        lines += [
            "[[garment]]", f'source = "./{garment.stem}.npz"', f'name = "{garment.stem}"',
            f"fabric = {json.dumps(fabric, ensure_ascii=False)}",
        ]  # fmt: skip
        lines += garment.fields_toml(scene.render.fps / scene.render.fps_base)
    for garment in seen:
        lines += _fabric_toml(garment.obj, scale)
    return "\n".join(lines) + "\n"


def _fabric_toml(obj: Any, scale: float) -> list[str]:
    """Return the table of an object's fabric."""
    own, name = obj.toile, json.dumps(f"fabric of {obj.name}", ensure_ascii=False)
    lines = [f"[fabric.{name}]", f'like = "{own.fabric}"']
    if own.use_own_values:
        for value in OWN_VALUES:
            size = 1e-6 if value.startswith("bending") else 1.0
            lines.append(f"{value} = {size * getattr(own, value):.9g}")
    if own.thickness > 0.0:
        lines.append(f"thickness = {scale * own.thickness:.9g}")
    return lines
