"""An obstacle read from its file: a closed surface in the room, and how it moves."""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import manifold3d
import numpy as np
from scipy.spatial.transform import Rotation

from toile.dressing.body.animated_avatar import DEFAULT_FPS, followed, is_animated, read_motion
from toile.dressing.body.avatar import Avatar, used_triangles
from toile.dressing.body.avatar_repair import closed_parts, side_by_side, united
from toile.dressing.body.avatar_units import METRES_PER_UNIT, upright
from toile.dressing.body.obstacles.obstacle import Obstacle, ObstacleKey
from toile.dressing.files.moving_file import MovingSurface
from toile.dressing.files.read_surface import GLTF, read_surface
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError, about

EDGE = 0.05
"""Edges of solids that do not deform are split into pieces of this length [m]: contact counts the area of
their vertices."""


@dataclass(frozen=True, kw_only=True)
class Solid:
    """A closed surface in the room.

    Attributes
    ----------
    name, friction
        As of `Obstacle`.
    vertices
        Positions where a film begins [m], Y up, shape (v, 3).
    faces
        Triangles, counter-clockwise seen from outside, shape (f, 3).
    at
        Positions at a time of the film [m], shape (v, 3); None: it stands still.
    seconds
        How long it moves [s].
    fps
        Frames per second of its file, or given; None: any will do.
    notes
        What was repaired, one sentence each.
    """

    name: str
    friction: float | None
    vertices: Float
    faces: Int
    at: Callable[[float], Float] | None = None
    seconds: float = 0.0
    fps: float | None = None
    notes: tuple[str, ...] = ()


def read_obstacle(obstacle: Obstacle, avatar: Avatar) -> Solid:
    """Return an obstacle as it is in the room of an avatar.

    Raises InputError if its file is missing, holds no closed solid, or moves in a way that cannot be read.
    """
    with about(field="obstacle"):
        vertices, faces, motion, notes, fps = _surface(obstacle, avatar)
    at: Callable[[float], Float] | None = None if motion is None else motion.at
    seconds = 0.0 if motion is None else motion.seconds
    keys = tuple(obstacle.keys)
    if keys:
        shape, middle = at, 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))

        def keyed(time: float) -> Float:
            return placed(vertices if shape is None else shape(time), keys, middle, time)

        at, seconds = keyed, max(seconds, keys[-1].time)
    start = vertices if at is None else at(0.0)
    if motion is None and len(keys) < 2:
        # One key puts it somewhere, where it stays.
        at, seconds = None, 0.0
    return Solid(
        name=obstacle.called, friction=obstacle.friction, vertices=start, faces=faces, at=at, seconds=seconds,
        fps=obstacle.fps or fps, notes=notes,
    )  # fmt: skip


def placed(vertices: Float, keys: Sequence[ObstacleKey], middle: Float, time: float) -> Float:
    """Return vertices [m], shape (v, 3), where keys have them at a time [s], turned about a point."""
    times = [key.time for key in keys]
    after = min(max(bisect_right(times, time), 1), len(keys) - 1) if len(keys) > 1 else 0
    before = max(after - 1, 0)
    span = times[after] - times[before]
    share = min(max((time - times[before]) / span, 0.0), 1.0) if span > 0.0 else 0.0
    one, other = keys[before], keys[after]
    start = Rotation.from_rotvec(np.radians(one.turn))
    # Straight in the rotation vector where both turn about one axis, so that it may turn by more than half.
    if np.linalg.norm(np.cross(one.turn, other.turn)) < 1e-9:
        vector = (1.0 - share) * np.array(one.turn) + share * np.array(other.turn)
        rotation = Rotation.from_rotvec(np.radians(vector))
    else:
        way = (start.inv() * Rotation.from_rotvec(np.radians(other.turn))).as_rotvec()
        rotation = start * Rotation.from_rotvec(share * way)
    move = (1.0 - share) * np.array(one.move) + share * np.array(other.move)
    return np.ascontiguousarray((vertices - middle) @ rotation.as_matrix().T + middle + move)


def _surface(
    obstacle: Obstacle, avatar: Avatar
) -> tuple[Float, Int, VertexMotion | None, tuple[str, ...], float | None]:
    """Return vertices [m], faces, motion, notes and frame rate of an obstacle."""
    source, name = obstacle.source, obstacle.called
    if isinstance(source, Avatar):
        if source.motion is not None:
            return source.vertices, source.faces, source.motion, (), source.motion.fps
        vertices, faces, notes = _closed(name, source.vertices, source.faces)
        return vertices, faces, None, notes, None
    path = Path(source)
    with about(file=path):
        if not is_animated(path):
            found, notes = read_surface(path, "the obstacle")
            metres, faces = used_triangles(path, found.positions, found.faces)
            metres = _in_metres(metres, obstacle, avatar, path)
            vertices, faces, said = _closed(name, metres, faces)
            return vertices, faces, None, (*notes, *said), None
        moving = read_motion(path, obstacle.fps, obstacle.clip)
        return _moving(moving, obstacle, avatar, path)


def _moving(
    moving: MovingSurface, obstacle: Obstacle, avatar: Avatar, path: Path
) -> tuple[Float, Int, VertexMotion | None, tuple[str, ...], float | None]:
    """Return what `_surface` does of a file that deforms."""
    surface = moving.surface
    used = np.unique(surface.faces)
    metres, faces = used_triangles(path, surface.positions, surface.faces)
    metres = _in_metres(metres, obstacle, avatar, path, moving)
    if len(moving.frames) < 2:
        vertices, faces, notes = _closed(obstacle.called, metres, faces)
        return vertices, faces, None, (*moving.notes, *notes), None
    parts, repairs = closed_parts(obstacle.called, metres, faces)
    (vertices, faces), said = side_by_side(obstacle.called, parts)
    frames = np.stack([_in_metres(frame[used], obstacle, avatar, path, moving) for frame in moving.frames])
    fps = obstacle.fps or moving.fps
    motion = VertexMotion(frames=followed(vertices, frames), fps=fps or DEFAULT_FPS)
    return vertices, faces, motion, (*moving.notes, *repairs, *said), motion.fps


def _closed(name: str, vertices: Float, faces: Int) -> tuple[Float, Int, tuple[str, ...]]:
    """Return a soup [m] as one closed surface of short edges, and notes."""
    parts, repairs = closed_parts(name, vertices, faces)
    (vertices, faces), said = united(name, parts)
    corners = vertices[faces]
    longest = float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())
    if longest > EDGE:
        mesh = manifold3d.Mesh64(
            vert_properties=np.ascontiguousarray(vertices), tri_verts=faces.astype(np.uint64)
        )
        solid = manifold3d.Manifold(mesh).refine_to_length(EDGE)
        if solid.status() != manifold3d.Error.NoError or solid.is_empty():
            raise InputError(f"{name}: is no closed solid ({solid.status().name}); repair the mesh")
        fine = solid.to_mesh64()
        vertices = np.ascontiguousarray(fine.vert_properties[:, :3], np.float64)
        faces = np.ascontiguousarray(fine.tri_verts, np.int32)
    return vertices, faces, (*repairs, *said)


def _in_metres(
    positions: Float, obstacle: Obstacle, avatar: Avatar, path: Path, moving: MovingSurface | None = None
) -> Float:
    """Return positions of a file, shape (v, 3), in metres, Y up: as told, as it says, or as the avatar's."""
    is_gltf = path.suffix.lower() in GLTF
    units = obstacle.units or (None if moving is None else moving.units)
    scale = METRES_PER_UNIT[units] if units else 1.0 if is_gltf else avatar.metres_per_unit
    told = obstacle.up or (None if moving is None else moving.up)
    return upright(positions, told or ("y" if is_gltf else avatar.up_axis)) * scale
