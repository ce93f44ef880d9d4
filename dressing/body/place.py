"""The place of a body in the room of its file, and the way between the room and the body's own frame.

Garments are drafted, sewn and simulated in the body's own frame: it stands on y = 0, its trunk above
x = z = 0, facing +Z. So a body gives the same drape wherever its file has it.
"""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from toile.dressing.body.avatar import Avatar
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float

TRUNK_LEVEL, TRUNK_BAND = 0.62, 0.02
"""Where the trunk is looked for: a band of this half width about this level, in body heights."""

GRID = 7.310585786300049e-7
"""Coordinates in the body's frame are multiples of this [m], so that the rounding of sums with its distance
from the origin leaves no trace. No decimal or binary fractions of files lie half-way between two of them."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where a body stands in its room [m], Y up, and where it faces; None of it is the body's own frame.

    Attributes
    ----------
    origin
        The point of the room that is the origin of the body's frame: on the floor below its trunk.
    turn
        Angle about Y from +Z towards +X that the body faces [degrees].
    """

    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turn: float = 0.0

    @staticmethod
    def of(avatar: Avatar) -> "Place":
        """Return where an avatar stands, by its lowest point and its trunk."""
        if avatar.placed:
            return Place()
        vertices = avatar.vertices
        floor, top = float(vertices[:, 1].min()), float(vertices[:, 1].max())
        share = (vertices[:, 1] - floor) / max(top - floor, 1e-12)
        trunk = vertices[np.abs(share - TRUNK_LEVEL) < TRUNK_BAND]
        turned = Place(turn=avatar.front).turned_in(trunk if len(trunk) else vertices)
        middle = 0.5 * (turned.min(axis=0) + turned.max(axis=0))
        x, _, z = Place(turn=avatar.front).turned_out(middle[None])[0].tolist()
        return Place(origin=(x, floor, z), turn=avatar.front)

    @property
    def is_own(self) -> bool:
        """Whether room and frame are one and the same."""
        return self == Place()

    def turned_in(self, directions: Float) -> Float:
        """Return directions of the room, (..., 3), in the body's frame."""
        return self._turned(directions, -1.0)

    def turned_out(self, directions: Float) -> Float:
        """Return directions of the body's frame, (..., 3), in the room."""
        return self._turned(directions, 1.0)

    def inward(self, points: npt.NDArray[np.floating]) -> Float:
        """Return points of the room [m], (..., 3), in the body's frame, on its grid."""
        if self.is_own:
            return np.asarray(points, np.float64)
        return np.asarray(np.rint(self.turned_in(points - np.array(self.origin)) / GRID) * GRID)

    def outward(self, points: Float) -> Float:
        """Return points of the body's frame [m], (..., 3), in the room."""
        return points if self.is_own else np.asarray(self.turned_out(points) + np.array(self.origin))

    def moved_in(self, motion: VertexMotion | None) -> VertexMotion | None:
        """Return a motion in the room, if there is one, in the body's frame."""
        if motion is None or self.is_own:
            return motion
        # Frame by frame: a film of long clips in double precision would take twice its memory.
        frames = np.empty(motion.frames.shape, np.float32)
        for index, frame in enumerate(motion.frames):
            frames[index] = self.inward(frame)
        return replace(motion, frames=frames)

    def own(self, avatar: Avatar) -> Avatar:
        """Return an avatar in its own frame, to which no file's units and axes belong."""
        if self.is_own:
            return avatar
        solid = avatar.solid
        return replace(
            avatar, vertices=self.inward(avatar.vertices), motion=self.moved_in(avatar.motion), front=0.0,
            solid=None if solid is None else (self.inward(solid[0]), solid[1]), placed=True,
        )  # fmt: skip

    def _turned(self, directions: Float, sign: float) -> Float:
        """Turn directions about Y by the angle that the body faces; quarter turns are exact."""
        quarters = self.turn / 90.0
        if quarters == round(quarters):
            cosine, sine = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarters) % 4]
        else:
            cosine, sine = float(np.cos(np.radians(self.turn))), float(np.sin(np.radians(self.turn)))
        x, y, z = directions[..., 0], directions[..., 1], directions[..., 2]
        sine *= sign
        return np.stack([cosine * x + sine * z, y, cosine * z - sine * x], axis=-1)


ROOM = Place()
"""The frame of a body that is the room itself."""
