"""Readers of surfaces that move: .npz files of vertices over time, and folders with a mesh per frame."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from toile.dressing.files.corner_surface import Surface, triangle_surface
from toile.dressing.files.npz_file import npz_arrays
from toile.dressing.files.on_disk import is_file
from toile.dressing.files.read_surface import FORMATS, read_surface
from toile.dressing.files.surface_check import check_vertex_numbers
from toile.dressing.files.unknown_format import foreign_npz
from toile.geometry.errors import InputError

VERTICES = ("vertices", "positions", "verts", "v")
FACES = ("faces", "f", "triangles")
"""Names of arrays that hold vertices and faces, the first that is there."""


@dataclass(frozen=True, kw_only=True)
class MovingSurface:
    """A surface over time.

    Attributes
    ----------
    frames
        Vertices in file units, shape (k, n, 3), k at least 1.
    surface
        The surface in the first frame.
    fps
        Frames per second, None if the file does not say.
    units, up
        Unit and up axis that the file names, or None.
    notes
        What was noticed, one sentence each.
    lead
        Frames of a lead-in, before the file's own.
    """

    frames: npt.NDArray[np.floating]
    surface: Surface
    fps: float | None = None
    units: str | None = None
    up: str | None = None
    notes: tuple[str, ...] = ()
    lead: int = 0


def read_npz_motion(path: Path) -> MovingSurface:
    """Return the one or many frames of an .npz file. Raises InputError naming what is missing."""
    if not is_file(path):
        raise InputError(f"{path}: avatar file not found; check the path", file=path)
    held = npz_arrays(path, "the motion")
    name, face_name = (next((key for key in names if key in held), None) for names in (VERTICES, FACES))
    if name is None or face_name is None:
        known = foreign_npz(frozenset(held))
        raise InputError(
            f"{path}: {known}"
            if known
            else f"{path}: needs arrays `vertices` (frames, vertices, 3) and `faces` (faces, 3), "
            f"has {', '.join(sorted(held)) or 'none'}",
            file=path,
        )
    frames, faces = held[name], _checked_faces(path, held[face_name])
    if frames.ndim == 2:
        frames = frames[None]
    if frames.ndim != 3 or frames.shape[2] != 3 or frames.dtype.kind not in "fiu":
        raise InputError(
            f"{path}: {name} must have the shape (frames, vertices, 3), or (vertices, 3) of a body that "
            f"stands still, got {held[name].shape}",
            file=path,
            field=name,
        )
    check_vertex_numbers(path, faces, frames.shape[1], "export the motion again")
    if frames.dtype not in (np.float32, np.float64):
        frames = frames.astype(np.float64)
    surface = triangle_surface(_first(path, frames), faces.astype(np.int32))
    return _moving(path, frames, surface, _frames_per_second(path, held))


def read_folder_motion(path: Path) -> MovingSurface:
    """Return the meshes in a folder as frames, ordered by numbers in their names.

    Raises InputError if there are none, or frames differ in their faces.
    """
    files = sorted(
        (file for file in path.iterdir() if file.suffix.lower() in FORMATS),
        key=lambda file: [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", file.name)],
    )
    if not files:
        raise InputError(
            f"{path}: holds no mesh files; export one of {', '.join(FORMATS)} per frame", file=path
        )
    first = read_surface(files[0], "the body").surface
    frames = []
    for file in files:
        surface = first if file == files[0] else read_surface(file, "the body", first.positions).surface
        same = surface.positions.shape == first.positions.shape
        if not same or not np.array_equal(surface.faces, first.faces):
            raise InputError(
                f"{file}: its faces differ from those of {files[0].name}; "
                "all frames must be the same mesh in motion",
                file=file,
            )
        frames.append(surface.positions)
    return _moving(path, np.stack(frames), first, None)


def _first(path: Path, frames: npt.NDArray[np.floating]) -> npt.NDArray[np.float64]:
    """Return the first frame. Raises InputError if there is none."""
    if not len(frames):
        raise InputError(f"{path}: holds no frames; export the motion again", file=path)
    return np.ascontiguousarray(frames[0], np.float64)


def _moving(
    path: Path, frames: npt.NDArray[np.floating], surface: Surface, fps: float | None
) -> MovingSurface:
    """Return frames with their surface. Raises InputError if a frame after the first is not finite."""
    bad = np.flatnonzero(~np.isfinite(frames).all(axis=(1, 2)))
    if len(bad) and len(frames) > 1:
        raise InputError(
            f"{path}: frame {bad[0]} has NaN or infinite coordinates; export the motion again", file=path
        )
    return MovingSurface(frames=frames, surface=surface, fps=fps)


def _checked_faces(path: Path, faces: npt.NDArray[Any]) -> npt.NDArray[np.integer]:
    """Return faces of an array, shape (f, 3). Raises InputError if it holds none."""
    if faces.ndim != 2 or faces.shape[1] != 3 or not np.issubdtype(faces.dtype, np.integer) or not len(faces):
        raise InputError(
            f"{path}: faces must be whole numbers of the shape (faces, 3), got {faces.shape}",
            file=path,
            field="faces",
        )
    return faces


def _frames_per_second(path: Path, held: dict[str, Any]) -> float | None:
    """Return what the file says of its frames per second. Raises InputError if that is no number."""
    if "fps" not in held:
        return None
    own = np.asarray(held["fps"]).ravel()
    if len(own) != 1 or own.dtype.kind not in "fiu":
        raise InputError(f"{path}: fps must be one number, is {own.tolist()[:3]}", file=path, field="fps")
    fps = float(own[0])
    if not np.isfinite(fps) or fps <= 0.0:
        raise InputError(f"{path}: fps must be greater than zero, got {fps:g}", file=path, field="fps")
    return fps
