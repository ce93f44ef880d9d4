"""Readers of moving avatars: .npz of vertices over time, animated glTF, or a folder with a mesh per frame."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from toile.dressing.body.avatar import Avatar, avatar_of, checked_frame_words, used_triangles
from toile.dressing.body.avatar_units import upright
from toile.dressing.files.corner_surface import triangle_surface
from toile.dressing.files.gltf.animated_gltf import read_animated_gltf
from toile.dressing.files.gltf.gltf_file import has_animation
from toile.dressing.files.gltf.still_gltf import read_still_gltf
from toile.dressing.files.npz_file import npz_arrays
from toile.dressing.files.read_surface import FORMATS, GLTF, read_surface
from toile.dressing.files.surface_check import check_vertex_numbers
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError, about

DEFAULT_FPS = 24.0
SAME = 1e-6
"""Distance at which a repaired vertex counts as one of the file's [m]."""
BOUND_TO = 4
"""Vertices of the file that a new vertex, of a closed hole, say, follows."""


def is_animated(path: Path) -> bool:
    """Whether a path names what `load_animated_avatar` reads."""
    return (
        path.suffix.lower() == ".npz"
        or path.is_dir()
        or (path.suffix.lower() in GLTF and has_animation(path))
    )


def load_animated_avatar(
    path: Path,
    *,
    units: str | None = None,
    up: str | None = None,
    fps: float | None = None,
    clip: str | None = None,
) -> Avatar:
    """Read a body and its motion; the body is the first frame, repaired.

    Parameters
    ----------
    path
        An .npz file with `vertices` (or `positions`), shape (k, v, 3), `faces`, shape (f, 3), and perhaps
        `fps`; a .glb or .gltf file with an animation; or a folder of mesh files of the same vertices and
        faces, ordered by numbers in their names; the first decides how polygons are split.
    units, up
        As for `load_avatar`, recognised from the first frame where None.
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
        _check_words(path, units, up, fps, clip)
        return _loaded(path, units, up, fps, clip)


def load_posed_avatar(
    path: Path,
    *,
    time: float,
    units: str | None = None,
    up: str | None = None,
    fps: float | None = None,
    clip: str | None = None,
) -> Avatar:
    """Read a body that moves as it stands at a time [s], and stand still there.

    The time is that of a glTF animation's keys, or counts from the first frame of an .npz or a folder; before
    the first and after the last key or frame, they hold. Other parameters and errors are those of
    `load_animated_avatar`.
    """
    with about(file=path):
        _check_words(path, units, up, fps, clip)
        if not np.isfinite(time):
            raise InputError(f"{path}: time must be finite, got {time:g}", file=path, field="time")
        is_gltf = _is_gltf(path)
        said: tuple[str, ...]
        if is_gltf:
            surface, said = read_still_gltf(path, time=time, clip=clip)
        else:
            frames, faces, own_fps = _read_frames(path)
            motion = VertexMotion(frames=frames, fps=fps or own_fps or DEFAULT_FPS)
            surface = triangle_surface(motion.at(time), faces)
            said = (f"The body stands as at {time:g} s, {motion.fps:g} frames per second.",)
        avatar = avatar_of(
            path.name, path.stem, *used_triangles(path, surface), units=units, up=up, is_gltf=is_gltf
        )
        return replace(avatar, notes=(*said, *avatar.notes))


def _is_gltf(path: Path) -> bool:
    """Whether a path names a glTF file."""
    return not path.is_dir() and path.suffix.lower() in GLTF


def _check_words(path: Path, units: str | None, up: str | None, fps: float | None, clip: str | None) -> None:
    """Raise InputError for what no file or not this one can have."""
    checked_frame_words(path.name, units, up)
    if fps is not None and not 0.0 < fps < np.inf:
        raise InputError(f"{path}: fps must be greater than zero, got {fps:g}", file=path, field="fps")
    if clip is not None and not _is_gltf(path):
        raise InputError(f"{path}: clip names an animation of a .glb or .gltf file", file=path, field="clip")


def _read_frames(path: Path) -> tuple[npt.NDArray[np.float32], Int, float | None]:
    """Vertices over time in file units, faces and frames per second of an .npz file or a folder."""
    frames, faces, fps = _read_folder(path) if path.is_dir() else _read_npz(path)
    if not len(frames):
        raise InputError(f"{path}: holds no frames; export the motion again", file=path)
    return frames, faces, fps


def _loaded(path: Path, units: str | None, up: str | None, fps: float | None, clip: str | None) -> Avatar:
    """Return the avatar of a file or folder, with its motion."""
    own_fps: float | None = None
    said: tuple[str, ...] = ()
    is_gltf = _is_gltf(path)
    if is_gltf:
        sampled = read_animated_gltf(path, fps or DEFAULT_FPS, clip)
        frames, faces, said = sampled.frames, sampled.faces, (sampled.note,)
    else:
        frames, faces, own_fps = _read_frames(path)
    if len(frames) < 2:
        raise InputError(
            f"{path}: a motion needs at least two frames, got {len(frames)}; give a mesh instead", file=path
        )
    bad = np.flatnonzero(~np.isfinite(frames).all(axis=(1, 2)))
    if len(bad):
        raise InputError(
            f"{path}: frame {bad[0]} has NaN or infinite coordinates; export the motion again", file=path
        )
    first = np.ascontiguousarray(frames[0], np.float64)
    avatar = avatar_of(path.name, path.stem, first, faces, units=units, up=up, is_gltf=is_gltf)
    metres = np.asarray(upright(frames, avatar.up_axis) * avatar.metres_per_unit, np.float32)
    motion = VertexMotion(frames=_followed(avatar.vertices, metres), fps=fps or own_fps or DEFAULT_FPS)
    assumed = "" if fps or own_fps else " (assumed; set fps to change it)"
    count = f"{len(frames)} frames at {motion.fps:g} per second{assumed}"
    return replace(avatar, motion=motion, notes=(*avatar.notes, *said, count))


def _read_npz(path: Path) -> tuple[npt.NDArray[np.float32], Int, float | None]:
    """Vertices over time in file units, faces and frames per second of an .npz file."""
    if not path.is_file():
        raise InputError(f"{path}: avatar file not found; check the path", file=path)
    held = npz_arrays(path, "the motion")
    name = next((key for key in ("vertices", "positions") if key in held), None)
    if name is None or "faces" not in held:
        raise InputError(
            f"{path}: needs arrays `vertices` (frames, vertices, 3) and `faces` (faces, 3), "
            f"has {', '.join(sorted(held)) or 'none'}",
            file=path,
        )
    frames, faces = held[name], held["faces"]
    if frames.ndim != 3 or frames.shape[2] != 3 or frames.dtype.kind not in "fiu":
        raise InputError(
            f"{path}: {name} must have the shape (frames, vertices, 3), got {frames.shape}",
            file=path,
            field=name,
        )
    if faces.ndim != 2 or faces.shape[1] != 3 or not np.issubdtype(faces.dtype, np.integer) or not len(faces):
        raise InputError(
            f"{path}: faces must be whole numbers of the shape (faces, 3), got {faces.shape}",
            file=path,
            field="faces",
        )
    check_vertex_numbers(path, faces, frames.shape[1], "export the motion again")
    fps = None
    if "fps" in held:
        own = np.asarray(held["fps"]).ravel()
        if len(own) != 1 or own.dtype.kind not in "fiu":
            raise InputError(f"{path}: fps must be one number, is {own.tolist()[:3]}", file=path, field="fps")
        fps = float(own[0])
        if not np.isfinite(fps) or fps <= 0.0:
            raise InputError(f"{path}: fps must be greater than zero, got {fps:g}", file=path, field="fps")
    return frames.astype(np.float32), np.ascontiguousarray(faces, np.int32), fps


def _read_folder(path: Path) -> tuple[npt.NDArray[np.float32], Int, None]:
    """Vertices over time in file units and faces of the meshes in a folder."""
    files = sorted(
        (file for file in path.iterdir() if file.suffix.lower() in FORMATS),
        key=lambda file: [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", file.name)],
    )
    if not files:
        raise InputError(
            f"{path}: holds no mesh files; export one of {', '.join(FORMATS)} per frame", file=path
        )
    frames: list[npt.NDArray[np.float32]] = []
    first, faces = read_surface(files[0], "the body").surface, np.empty((0, 3), np.int32)
    for file in files:
        surface = read_surface(file, "the body", first.positions).surface
        vertices, own = used_triangles(file, surface)
        if not frames:
            faces = own
        elif not np.array_equal(own, faces) or frames[0].shape != vertices.shape:
            raise InputError(
                f"{file}: its faces differ from those of {files[0].name}; "
                "all frames must be the same mesh in motion",
                file=file,
            )
        frames.append(vertices.astype(np.float32))
    return np.stack(frames), faces, None


def _followed(vertices: Float, frames: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
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
    moved = np.einsum("vq,kvqi->kvi", weights, (frames - frames[0])[:, nearest])
    return np.asarray(vertices + moved, np.float32)
