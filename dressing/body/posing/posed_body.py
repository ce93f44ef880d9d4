"""A body that moves from its own pose to others, each given by a file of the same faces."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from toile.dressing.body.animated_avatar import DEFAULT_FPS, moving_avatar
from toile.dressing.body.avatar import Avatar
from toile.dressing.body.posing.way_to_pose import way_to_pose
from toile.dressing.body.reading import Reading
from toile.dressing.files.corner_surface import Surface
from toile.dressing.files.gltf.still_gltf import read_still_gltf
from toile.dressing.files.leading.standing import eased
from toile.dressing.files.moving_file import MovingSurface
from toile.dressing.files.read_surface import FORMATS, GLTF, read_surface
from toile.dressing.files.unknown_format import unknown_format
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError, about

SLOWEST = 1.0
"""Least time from pose to pose [s]."""
FARTHEST = 0.025
"""Most that a vertex moves from frame to frame, in sizes of the body: 1 m/s at 24 frames a second."""
REST = 0.5
"""Time that the body stands in its last pose [s]."""


def given_poses(given: object) -> tuple[str, ...]:
    """Return the files of poses, as texts. Raises InputError for what is no file name."""
    poses = (given,) if isinstance(given, str | Path) else given
    if not isinstance(poses, Sequence) or not all(isinstance(one, str | Path) for one in poses):
        raise InputError(f"pose must be file names, got {given!r}", field="pose")
    return tuple(str(one) for one in poses)


def file_of(pose: str) -> tuple[Path, str]:
    """Return the file of a pose, and what follows it: @SECONDS, or nothing."""
    file, at, seconds = pose.rpartition("@")
    if at and Path(file).suffix.lower() in GLTF:
        return Path(file), at + seconds
    return Path(pose), ""


def moved_poses(given: object, move: Callable[[Path], Path]) -> tuple[str, ...]:
    """Return poses whose files are elsewhere. Raises InputError for what is no file name."""
    return tuple(f"{move(path)}{at}" for path, at in map(file_of, given_poses(given)))


def load_posed_body(path: Path, poses: Sequence[str], *, reading: Reading, fps: float | None) -> Avatar:
    """Read a body and move it through poses.

    Parameters
    ----------
    path
        The body as it is dressed: a file that stands still.
    poses
        Files of the same vertices and faces, or FILE@SECONDS for a glTF file as its clip stands then.
    reading
        What is known of `path`; poses are in the same frame.
    fps
        Frames per second; None: 24.

    Raises
    ------
    InputError
        Naming the file that is missing, or has other vertices or faces.
    """
    reading.check(path.name)
    start, notes = _surface(str(path))
    rate = fps or DEFAULT_FPS
    if not 0.0 < rate < np.inf:
        raise InputError(f"{path}: fps must be greater than zero, got {rate:g}", file=path, field="fps")
    frames, here = [], start.positions
    for pose in poses:
        with about(field="pose"):
            there = _same(path, start, pose)
        frames.append(_way(here, there, start, rate))
        here = there
    frames.append(np.repeat(here[None], max(round(REST * rate), 1) + 1, axis=0))
    moving = MovingSurface(frames=np.concatenate(frames), surface=start, fps=rate, notes=tuple(notes))
    avatar = moving_avatar(path, moving, reading, fps)
    count = "a pose" if len(poses) == 1 else f"{len(poses)} poses"
    return replace(avatar, notes=(*avatar.notes, f"the body moves to {count} in {len(moving.frames)} frames"))


def _way(here: Float, there: Float, body: Surface, rate: float) -> Float:
    """Return the frames from one pose to just before another, shape (k, n, 3)."""
    size = float(np.ptp(here, axis=0).max())
    # Rigid parts swing on arcs: at most half again as long as straight.
    longest = 1.5 * float(np.linalg.norm(there - here, axis=1).max())
    # Eased motion is at its fastest half again as fast as in the mean.
    count = max(round(SLOWEST * rate), int(np.ceil(1.5 * longest / (FARTHEST * size))), 1)
    return way_to_pose(here, there, body.faces, eased(count))


def _same(path: Path, body: Surface, pose: str) -> Float:
    """Return the vertices of a pose. Raises InputError if it is another body."""
    surface, _ = _surface(pose)
    if surface.positions.shape != body.positions.shape:
        raise InputError(
            f"{pose}: has {len(surface.positions)} vertices, and {path.name} {len(body.positions)}: a pose "
            "needs the same body; export both from one mesh",
            file=file_of(pose)[0],
        )
    if not np.array_equal(surface.faces, body.faces):
        raise InputError(
            f"{pose}: its faces are not those of {path.name}; export both from one mesh",
            file=file_of(pose)[0],
        )
    return surface.positions


def _surface(name: str) -> tuple[Surface, Sequence[str]]:
    """Return what a file, or a glTF clip at a time, shows."""
    path, at = file_of(name)
    if at:
        try:
            time = float(at[1:])
        except ValueError:
            raise InputError(f"{name}: after @ stands the time of a clip in seconds", file=path) from None
        return read_still_gltf(path, time=time)
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"{path}: {unknown_format(path)}", file=path)
    return read_surface(path, "the body")
