"""Motion of an avatar's vertices, or of points that pins follow: frames at equal times, interpolated."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from toile.geometry.arrays import Float
from toile.geometry.by_value import ByValue
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, shown


@dataclass(frozen=True, kw_only=True, eq=False)
class VertexMotion(ByValue):
    """Vertices over time.

    Attributes
    ----------
    frames
        Positions [m], shape (k, v, 3), k at least 2.
    fps
        Frames per second.
    lead
        Frames of a lead-in: the film begins after them, at its frame 0.

    Raises InputError if frames are not finite numbers of that shape, or fps is none.
    """

    frames: npt.NDArray[np.floating]
    fps: float
    lead: int = 0

    def __post_init__(self) -> None:
        """Check frames and rate."""
        frames = np.asarray(self.frames)
        if frames.ndim != 3 or frames.shape[2] != 3 or len(frames) < 2 or frames.dtype.kind not in "fiu":
            raise InputError(
                f"frames must be numbers of shape (k, v, 3), k at least 2, got {frames.dtype} of shape "
                f"{frames.shape}",
                field="frames",
            )
        if not np.isfinite(frames).all():
            raise InputError(
                "frames have NaN or infinite coordinates; export the motion again", field="frames"
            )
        if not is_real(self.fps) or not self.fps > 0.0:
            raise InputError(f"fps must be greater than zero, got {shown(self.fps)}", field="fps")
        object.__setattr__(self, "frames", frames if frames.dtype.kind == "f" else frames.astype(np.float64))

    @property
    def seconds(self) -> float:
        """Time from the first frame to the last [s]."""
        return (len(self.frames) - 1) / self.fps

    def name(self, index: int) -> str:
        """Return what messages call a frame: its number in the film, or in the lead-in, in words."""
        return f"frame {index - self.lead}" if index >= self.lead else f"frame {index} of the lead-in"

    def pose(self, index: int) -> Float:
        """Positions at a frame [m], shape (v, 3)."""
        return np.asarray(self.frames[index], np.float64)

    def at(self, seconds: float, pose: Callable[[int], Float] | None = None) -> Float:
        """Positions at a time [m], shape (v, 3): cubic through the frames, so that velocities do not jump.

        Tangents are central differences (Catmull-Rom), but at most three times the shorter of the two ways
        beside them: no vertex swings back before it leaves or past where it stops (Fritsch and Carlson 1980).
        Before the first and after the last frame they stay. `pose` gives the frames instead.
        """
        pose = pose or self.pose
        index, s = self.place(seconds)
        if s <= 1e-9 or s >= 1.0 - 1e-9:
            # Frames themselves come out as they are.
            return pose(index + round(s))
        return self.between(index, pose).at(s)

    def place(self, seconds: float) -> tuple[int, float]:
        """Return the frame before a time [s] that is not the last, and the share of the way to the next."""
        place = min(max(seconds * self.fps, 0.0), len(self.frames) - 1.0)
        index = min(int(place), len(self.frames) - 2)
        return index, place - index

    def between(self, index: int, pose: Callable[[int], Float]) -> "Between":
        """Return the way from a frame to the next; `pose` gives the frames."""
        start, end = pose(index), pose(index + 1)
        leave = _tangent(start - pose(max(index - 1, 0)), end - start)
        arrive = _tangent(end - start, pose(min(index + 2, len(self.frames) - 1)) - end)
        return Between(start, end - start, leave, arrive)

    def speed(self, seconds: float, span: float) -> tuple[float, int]:
        """Fastest vertex between a time and `span` [s] later: mean speed [m/s] and number of the vertex."""
        away = np.linalg.norm(self.at(seconds + span) - self.at(seconds), axis=1)
        fastest = int(away.argmax())
        return float(away[fastest]) / span, fastest


class Between(NamedTuple):
    """The way from one frame to the next: its start, its chord, the tangents at both ends [m], (v, 3)."""

    start: Float
    chord: Float
    leave: Float
    arrive: Float

    def at(self, s: float) -> Float:
        """Positions after a share of the way [m], shape (v, 3)."""
        ease = s * s * (3.0 - 2.0 * s)
        return np.asarray(
            self.start + ease * self.chord + s * (s - 1.0) ** 2 * self.leave + s * s * (s - 1.0) * self.arrive
        )


def _tangent(before: Float, after: Float) -> Float:
    """Tangents between two ways [m], shape (v, 3): their mean, at most three times the shorter one."""
    mean = 0.5 * (before + after)
    length = np.linalg.norm(mean, axis=1)
    longest = 3.0 * np.minimum(np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1))
    return np.asarray(mean * np.minimum(1.0, longest / np.maximum(length, 1e-300))[:, None])
