"""The path of a moving avatar: its motion, with skins held apart where cloth is near."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from toile.collide.skins.skin_slots import SkinSlots
from toile.engine.cloth.vertex_motion import Between, VertexMotion
from toile.geometry.arrays import Bool, Float, Int

ALL = slice(None)
NEAR = 0.1
"""Skin this far from cloth is held apart [m]: what comes near within two frames."""


class _Known(NamedTuple):
    """The way of some vertices, shape (k,), or all, from a frame to the next."""

    frame: int
    part: Int | slice
    way: Between


class AvatarPath:
    """A motion whose skins are held apart where cloth is near: see SkinSlots.

    A pose is worked out when it is first asked for, with the cloth as it was seen last. `poses` are those at
    hand, by frame.
    """

    KEPT = 6
    """Poses kept: interpolation needs four at a time."""

    def __init__(self, motion: VertexMotion, faces: Int) -> None:
        self.motion = motion
        self._slots = SkinSlots(motion.pose(0), faces)
        self.poses: dict[int, Float] = {}
        self._between: _Known | None = None
        self._near: Bool = np.zeros(len(motion.pose(0)), bool)

    def see(self, avatar: Float, cloth: Float) -> None:
        """Look where cloth is near: avatar vertices, shape (v, 3), and nodes, shape (n, 3), now [m]."""
        distance, _ = cKDTree(cloth).query(avatar, distance_upper_bound=NEAR)
        self._near = np.asarray(distance) < NEAR

    def at(self, seconds: float, part: Int | slice = ALL) -> Float:
        """Positions at a time [m], shape (v, 3), or those of some vertices, shape (k,)."""
        index, s = self.motion.place(seconds)
        if s <= 1e-9 or s >= 1.0 - 1e-9:
            return self._pose(index + round(s))[part]
        known = self._between
        if known is None or known.frame != index or known.part is not part:
            # Stages of steps ask for several places on the same way.
            way = self.motion.between(index, lambda frame: self._pose(frame)[part])
            known = self._between = _Known(index, part, way)
        return known.way.at(s)

    def _pose(self, index: int) -> Float:
        """Positions at a frame, skins apart [m], shape (v, 3)."""
        if index not in self.poses:
            self.poses[index] = self._slots.held_apart(self.motion.pose(index), self._near)
            for old in sorted(self.poses)[: -self.KEPT]:
                del self.poses[old]
        return self.poses[index]
