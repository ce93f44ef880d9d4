"""An avatar together with the obstacles beside it, as one surface that cloth meets."""

from collections.abc import Sequence
from dataclasses import replace
from math import ceil

import numpy as np

from toile.dressing.body.animated_avatar import DEFAULT_FPS
from toile.dressing.body.avatar import Avatar
from toile.dressing.body.obstacles.solid import Solid
from toile.dressing.body.place import Place
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.forces.contact_pairs import SkinPart
from toile.geometry.arrays import Float, Int


def beside(avatar: Avatar, solids: Sequence[Solid], place: Place, *, still: bool = False) -> Avatar:
    """Return an avatar with obstacles beside it.

    Parameters
    ----------
    avatar
        The body, in the room or in its own frame; its vertices and faces come first.
    solids
        The obstacles, in the room; none returns the avatar itself.
    place
        Where the avatar's frame is in the room: `Place()` for an avatar in the room.
    still
        Leaves all obstacles where the film begins.

    Where the body moves, the film has its frames and rate, and time 0 of the obstacles is its first frame
    after a lead-in. Where it stands, the film lasts until the last of them stands still.
    """
    if not solids:
        return avatar
    if still:
        solids = [replace(solid, at=None) for solid in solids]
    count = len(avatar.vertices)
    vertices, faces, parts = [avatar.vertices], [avatar.faces], []
    for solid in solids:
        vertices.append(place.inward(solid.vertices))
        faces.append(solid.faces + np.int32(count))
        parts.append(SkinPart(solid.name, count, count + len(solid.vertices), solid.friction))
        count += len(solid.vertices)
    motion = avatar.motion
    if motion is not None or any(solid.at is not None for solid in solids):
        motion = _motion(avatar, solids, place)
    return replace(
        avatar, vertices=np.concatenate(vertices),
        faces=np.ascontiguousarray(np.concatenate(faces), np.int32), motion=motion, obstacles=tuple(parts),
    )  # fmt: skip


def _motion(avatar: Avatar, solids: Sequence[Solid], place: Place) -> VertexMotion:
    """Return how an avatar and obstacles move together, where one of them does."""
    own = avatar.motion
    lead = 0 if own is None else own.lead
    if own is None:
        moving = [solid for solid in solids if solid.at is not None]
        fps = next((solid.fps for solid in moving if solid.fps is not None), DEFAULT_FPS)
        count = 1 + max(ceil(max(solid.seconds for solid in moving) * fps - 1e-9), 1)
    else:
        fps, count = own.fps, len(own.frames)
    total = len(avatar.vertices) + sum(len(solid.vertices) for solid in solids)
    frames = np.empty((count, total, 3), np.float64 if own is None else own.frames.dtype)
    for index in range(count):
        frames[index, : len(avatar.vertices)] = avatar.vertices if own is None else own.frames[index]
        begin = len(avatar.vertices)
        for solid in solids:
            shape = solid.vertices if solid.at is None else solid.at(max(index - lead, 0) / fps)
            frames[index, begin : begin + len(shape)] = place.inward(shape)
            begin += len(shape)
    return VertexMotion(frames=frames, fps=fps, lead=lead)


def without_obstacles(vertices: Float, faces: Int, parts: Sequence[SkinPart]) -> tuple[Float, Int]:
    """Return a surface, vertices (v, 3) and faces (t, 3), without the vertices of obstacles in it."""
    if not parts:
        return vertices, faces
    begin, end = parts[0].begin, parts[-1].end
    kept = faces[~((faces >= begin) & (faces < end)).any(axis=1)]
    renumbered = np.where(kept >= end, kept - (end - begin), kept)
    return np.delete(vertices, np.s_[begin:end], axis=0), np.ascontiguousarray(renumbered, np.int32)
