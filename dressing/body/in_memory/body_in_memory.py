"""Bodies that are arrays in memory, checked and repaired as those of files are."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from toile.dressing.body.animated_avatar import moving_avatar
from toile.dressing.body.avatar import Avatar, avatar_of, repaired_avatar
from toile.dressing.body.avatar_units import GIVEN_UNIT_SIZE
from toile.dressing.body.reading import Reading
from toile.dressing.files.corner_surface import Surface
from toile.dressing.files.moving_file import MovingSurface
from toile.geometry.errors import InputError
from toile.geometry.given_arrays import floats, indices
from toile.geometry.given_numbers import is_real, shown

TALLER = 1.25
"""A body whose extent along z is so many times that along y probably has Z up."""


def body(
    vertices: npt.ArrayLike, faces: npt.ArrayLike, *, name: str = "body", fps: float | None = None,
    units: str | None = None, up: str | None = None, front: str | None = None,
) -> Avatar:  # fmt: skip
    """Return a body made of arrays, repaired into one collision surface as `load_avatar` does.

    Parameters
    ----------
    vertices
        Positions, shape (v, 3), or (k, v, 3) of a body that moves, in any unit a body may have.
    faces
        Triangles, shape (f, 3).
    name
        Name of the body, used in messages and files.
    fps
        Frames per second of a body that moves; None is 24.
    units, up, front
        As of `load_avatar`; recognised where None.

    Raises
    ------
    InputError
        If an array is of a wrong shape, not finite, or names what does not exist, and as `load_avatar` does.
    """
    reading = Reading(units=units, up=up, front=front)
    reading.check(name)
    moves = np.ndim(vertices) == 3
    frames = floats(vertices, f"{name}: vertices", (None, None, 3) if moves else (None, 3), "vertices")
    if fps is not None and not (moves and is_real(fps) and fps > 0.0):
        why = f"fps must be greater than zero, got {shown(fps)}" if moves else "fps is for vertices over time"
        raise InputError(f"{name}: {why}", field="fps")
    first = frames[0] if moves and len(frames) else frames
    triangles = indices(faces, f"{name}: faces", (None, 3), first.shape[0], "faces")
    surface = Surface(
        positions=np.ascontiguousarray(first), faces=triangles, uv=np.empty((0, 2)),
        uv_faces=np.full(triangles.shape, -1, np.int32), panel=np.zeros(len(triangles), np.int32),
        panel_names=(name,), file_face=np.arange(len(triangles), dtype=np.int32),
    )  # fmt: skip
    path = Path(name)
    if not moves or len(frames) < 2:
        return replace(avatar_of(path, surface, reading), name=name)
    moving = MovingSurface(frames=frames, surface=surface)
    return replace(moving_avatar(path, moving, reading, fps), name=name)


def sound(avatar: Avatar) -> Avatar:
    """Return an avatar that stands still and that somebody made by hand, closed and turned outward.

    Its vertices are metres, unless no body is of that size, and Y is up.
    """
    if avatar.repaired or avatar.motion is not None:
        return avatar
    extents = np.ptp(avatar.vertices, axis=0)
    low, high = GIVEN_UNIT_SIZE
    units = "m" if low <= float(extents.max()) <= high else None
    made = repaired_avatar(
        Path(avatar.name or "avatar"), avatar.vertices, avatar.faces, Reading(units=units, up="y"), (),
        moves=False,
    )  # fmt: skip
    doubt: tuple[str, ...] = ()
    if extents[2] > TALLER * extents[1]:
        doubt = (
            "The body is taller along z than along y, which is up: if Z is up, make it with toile.body.",
        )
    return replace(
        made, name=avatar.name, placed=avatar.placed, notes=(*avatar.notes, *made.notes, *doubt),
        front=avatar.front or made.front,
    )  # fmt: skip
