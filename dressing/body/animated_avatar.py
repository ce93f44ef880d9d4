"""Readers of moving avatars: vertices over time in .npz, animated glTF, USD, folders of meshes."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
from scipy.spatial import cKDTree

from toile.dressing.body.avatar import Avatar, avatar_of, repaired_avatar, used_triangles
from toile.dressing.body.avatar_parts import body_faces
from toile.dressing.body.avatar_units import upright
from toile.dressing.body.reading import RECOGNISED, Reading
from toile.dressing.files.gltf.animated_gltf import read_animated_gltf
from toile.dressing.files.gltf.gltf_file import has_animation
from toile.dressing.files.gltf.gltf_lead_in import has_skeleton, read_lead_in
from toile.dressing.files.gltf.still_gltf import read_still_gltf
from toile.dressing.files.leading.usd_lead_in import has_usd_skeleton, read_usd_lead_in
from toile.dressing.files.moving_file import MovingSurface, read_folder_motion, read_npz_motion
from toile.dressing.files.on_disk import is_folder
from toile.dressing.files.read_surface import GLTF
from toile.dressing.files.usd_file import FORMATS as USD
from toile.dressing.files.usd_file import read_usd
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError, about

DEFAULT_FPS = 24.0
SAME = 1e-6
"""Distance at which a repaired vertex counts as one of the file's [m]."""
SAME_POSE = 1e-4
"""Vertices of two poses that are closer than this share of the body's size are alike."""
RESIZED = 2.5
"""A pose in which the body is so many times larger or smaller is none: its matrices are of other units."""
BOUND_TO = 4
"""Vertices of the file that a new vertex, of a closed hole, say, follows."""


def is_animated(path: Path) -> bool:
    """Whether a path names what `load_animated_avatar` reads."""
    return (
        path.suffix.lower() in (".npz", *USD)
        or is_folder(path)
        or (path.suffix.lower() in GLTF and has_animation(path))
    )


def load_animated_avatar(
    path: Path, *, reading: Reading = RECOGNISED, fps: float | None = None, clip: str | None = None
) -> Avatar:
    """Read a body and its motion; the body is the first frame, repaired.

    Closed parts that overlap stay apart, since in motion they part.

    Parameters
    ----------
    path
        An .npz file with `vertices` (or `positions`, `verts`, `v`), shape (k, v, 3), `faces` (or `f`), shape
        (f, 3), and perhaps `fps`; a .glb or .gltf file with an animation; or a folder of mesh files of the
        same vertices and faces, ordered by numbers in their names; the first decides how polygons are split.
        An .npz of one frame, or of the shape (v, 3), is a body that stands still; so is a USD file in which
        nothing moves.
    reading
        What is known of the file; the rest is recognised from the first frame.
    fps
        Frames per second, at which a glTF animation is sampled; None takes the file's own, or 24.
    clip
        Name of the animation of a glTF file; None takes the first.

    Raises
    ------
    InputError
        If something is missing, of the wrong shape or not finite, or if frames differ in their faces.
    """
    with about(file=path):
        _check_words(path, reading, fps, clip)
        moving = read_motion(path, fps, clip)
        reading = _completed(reading, moving)
        if len(moving.frames) > 1:
            return moving_avatar(path, moving, reading, fps)
        if is_folder(path):
            raise InputError(
                f"{path}: a motion needs at least two frames, got 1; give the mesh instead", file=path
            )
        if fps is not None:
            raise InputError(f"{path}: holds one frame, so it has no fps", file=path, field="fps")
        return _noted(avatar_of(path, moving.surface, reading), moving.notes)


def led_in_avatars(
    path: Path, *, reading: Reading, fps: float | None, clip: str | None, seconds: float,
    up: Literal["y", "z"],
) -> Iterator[Avatar]:  # fmt: skip
    """Read a body with a skeleton that begins in a pose of rest, and moves from there to its first frame.

    Yields one for every pose of rest in which there is a body (see `read_lead_in`), none without a skeleton.
    `seconds` is the length of the lead-in, rounded to whole frames, and `up` the axis of the file that points
    up. Parameters and errors are else those of `load_animated_avatar`.
    """
    with about(file=path):
        if not _has_skeleton(path):
            return
        moving = read_motion(path, fps, clip)
        count = max(round(seconds * (fps or moving.fps or DEFAULT_FPS)), 1)
        axis = "xyz".index(up)
        seen: list[Float] = []
        leads = (
            read_lead_in(path, clip, count, axis) if _is_gltf(path) else read_usd_lead_in(path, count, axis)
        )
        for lead in leads:
            size = np.ptp(moving.frames[0], axis=0).max()
            if any(np.abs(lead[0] - other).max() < SAME_POSE * size for other in seen):
                continue
            if not 1.0 / RESIZED < np.ptp(lead[0], axis=0).max() / size < RESIZED:
                continue
            seen.append(lead[0])
            led = replace(
                moving,
                frames=np.concatenate([lead, moving.frames]),
                surface=replace(moving.surface, positions=lead[0].copy()),
                lead=count,
            )
            try:
                avatar = moving_avatar(path, led, replace(_completed(reading, moving), up=up), fps)
            except InputError:
                # The clip can be read: what is wrong is this pose.
                continue
            yield avatar


def load_posed_avatar(
    path: Path, *, time: float, reading: Reading = RECOGNISED, fps: float | None = None,
    clip: str | None = None,
) -> Avatar:  # fmt: skip
    """Read a body that moves as it stands at a time [s], and stand still there.

    The time is that of a glTF animation's keys, or counts from the first frame of an .npz or a folder; before
    the first and after the last key or frame, they hold. Other parameters and errors are those of
    `load_animated_avatar`.
    """
    with about(file=path):
        _check_words(path, reading, fps, clip)
        if not np.isfinite(time):
            raise InputError(f"{path}: time must be finite, got {time:g}", file=path, field="time")
        said: tuple[str, ...]
        if _is_gltf(path):
            surface, said = read_still_gltf(path, time=time, clip=clip)
        else:
            moving = _read_frames(path)
            surface, said, reading = moving.surface, moving.notes, _completed(reading, moving)
            if len(moving.frames) > 1:
                motion = VertexMotion(frames=moving.frames, fps=fps or moving.fps or DEFAULT_FPS)
                surface = replace(surface, positions=motion.at(time))
                said = (
                    *said,
                    f"The body stands as at {time:g} s, {motion.fps:g} frames per second.",
                )
        return _noted(avatar_of(path, surface, reading), said)


def _noted(avatar: Avatar, said: tuple[str, ...]) -> Avatar:
    """Return an avatar with notes on how its file was read."""
    return replace(avatar, notes=(*said, *avatar.notes))


def _completed(reading: Reading, moving: MovingSurface) -> Reading:
    """Return what is known of a file, by what it says itself where the user does not."""
    return replace(reading, units=reading.units or moving.units, up=reading.up or moving.up)


def _is_gltf(path: Path) -> bool:
    """Whether a path names a glTF file."""
    return not is_folder(path) and path.suffix.lower() in GLTF


def _check_words(path: Path, reading: Reading, fps: float | None, clip: str | None) -> None:
    """Raise InputError for what no file or not this one can have."""
    reading.check(path.name)
    if fps is not None and not 0.0 < fps < np.inf:
        raise InputError(f"{path}: fps must be greater than zero, got {fps:g}", file=path, field="fps")
    if clip is not None and not _is_gltf(path):
        raise InputError(f"{path}: clip names an animation of a .glb or .gltf file", file=path, field="clip")


def _has_skeleton(path: Path) -> bool:
    """Whether a file holds a skeleton with joints that move."""
    if is_folder(path):
        return False
    return has_skeleton(path) if _is_gltf(path) and has_animation(path) else has_usd_skeleton(path)


def read_motion(path: Path, fps: float | None, clip: str | None) -> MovingSurface:
    """Return the frames of a file or folder; those of glTF are sampled."""
    if not _is_gltf(path):
        return _read_frames(path)
    sampled = read_animated_gltf(path, fps or DEFAULT_FPS, clip)
    return MovingSurface(frames=sampled.frames, surface=sampled.surface, notes=(sampled.note,))


def _read_frames(path: Path) -> MovingSurface:
    """Return the frames of an .npz or USD file or a folder."""
    if is_folder(path):
        return read_folder_motion(path)
    return read_usd(path) if path.suffix.lower() in USD else read_npz_motion(path)


def moving_avatar(path: Path, moving: MovingSurface, reading: Reading, fps: float | None) -> Avatar:
    """Return the avatar of frames, with its motion."""
    surface = moving.surface
    kept, said = body_faces(path.name, surface, reading.only, reading.without)
    used = np.unique(surface.faces[kept])
    vertices, faces = used_triangles(path, surface.positions, surface.faces[kept])
    avatar = repaired_avatar(path, vertices, faces, reading, said, moves=True)
    scale = avatar.metres_per_unit
    metres = np.stack([upright(frame[used], avatar.up_axis) * scale for frame in moving.frames])
    own_fps = fps or moving.fps
    motion = VertexMotion(
        frames=followed(avatar.vertices, metres), fps=own_fps or DEFAULT_FPS, lead=moving.lead
    )
    assumed = "" if own_fps else " (assumed; set fps to change it)"
    count = f"{len(metres) - moving.lead} frames at {motion.fps:g} per second{assumed}"
    return replace(avatar, motion=motion, notes=(*avatar.notes, *moving.notes, count))


def followed(vertices: Float, frames: Float) -> Float:
    """Let repaired vertices, shape (v, 3), follow the file's over time, shape (k, n, 3), [m]."""
    distance, nearest = cKDTree(frames[0]).query(vertices, k=BOUND_TO)
    distance, nearest = np.asarray(distance), np.asarray(nearest)
    if len(vertices) == frames.shape[1] and (distance[:, 0] < SAME).all():
        if np.linalg.norm(frames[0] - vertices, axis=1).max() < SAME:
            return frames
        return np.ascontiguousarray(frames[:, nearest[:, 0]])
    weights = 1.0 / np.maximum(distance, SAME) ** 2
    weights[distance[:, 0] < SAME, 1:] = 0.0
    weights /= weights.sum(axis=1, keepdims=True)
    moved = [np.einsum("vq,vqi->vi", weights, (frame - frames[0])[nearest]) for frame in frames]
    return np.asarray(vertices + np.stack(moved))
