"""How an avatar moves: its vertices at frames of equal distance in time, interpolated in between."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from toile.geometry.arrays import Float


@dataclass(frozen=True, kw_only=True)
class AvatarMotion:
    """Vertices of an avatar over time.

    Attributes
    ----------
    frames
        Positions [m], shape (k, v, 3), k at least 2.
    fps
        Frames per second.
    """

    frames: npt.NDArray[np.floating]
    fps: float

    @property
    def seconds(self) -> float:
        """Time from the first frame to the last [s]."""
        return (len(self.frames) - 1) / self.fps

    def pose(self, index: int) -> Float:
        """Positions at a frame [m], shape (v, 3); before the first and after the last, theirs."""
        return np.asarray(self.frames[min(max(index, 0), len(self.frames) - 1)], np.float64)

    def at(self, seconds: float, pose: Callable[[int], Float] | None = None) -> Float:
        """Positions at a time [m], shape (v, 3): cubic through the frames, so that velocities do not jump.

        Tangents are central differences (Catmull-Rom); before the first and after the last frame it stays.
        `pose` gives the frames instead, by number.
        """
        pose = pose or self.pose
        place = min(max(seconds * self.fps, 0.0), len(self.frames) - 1.0)
        index = min(int(place), len(self.frames) - 2)
        s = place - index
        if s <= 1e-9 or s >= 1.0 - 1e-9:
            # Frames themselves come out as they are.
            return pose(index + round(s))
        start, end = pose(index), pose(index + 1)
        leave = 0.5 * (end - pose(max(index - 1, 0)))
        arrive = 0.5 * (pose(min(index + 2, len(self.frames) - 1)) - start)
        ease = s * s * (3.0 - 2.0 * s)
        return np.asarray(
            start + ease * (end - start) + s * (s - 1.0) ** 2 * leave + s * s * (s - 1.0) * arrive
        )

    def speed(self, seconds: float, span: float) -> tuple[float, int]:
        """Fastest vertex between a time and `span` [s] later: mean speed [m/s] and number of the vertex."""
        away = np.linalg.norm(self.at(seconds + span) - self.at(seconds), axis=1)
        fastest = int(away.argmax())
        return float(away[fastest]) / span, fastest
