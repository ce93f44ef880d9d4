"""One channel of a glTF animation: keys over time, and the interpolation between them.

Khronos Group, glTF 2.0 specification, section 3.11 and appendix C.
"""

from dataclasses import dataclass

import numpy as np

from toile.geometry.arrays import Float

SAME_TIME = 1e-6
"""Times this close, relative to themselves, are the same: keys are single precision."""


@dataclass(frozen=True, kw_only=True)
class Channel:
    """Keys of a translation, rotation, scale or of morph weights.

    Attributes
    ----------
    times
        Times of the keys [s], rising, shape (n,).
    values
        Values at the keys, shape (n, c).
    tangents
        Slopes before and after the keys [1/s], shape (2, n, c), or None where nothing is cubic.
    is_step
        Whether a value holds until the next key.
    is_rotation
        Whether values are quaternions (x, y, z, w).
    """

    times: Float
    values: Float
    tangents: Float | None
    is_step: bool
    is_rotation: bool

    def at(self, times: Float) -> Float:
        """Values at times [s], shape (k, c); before the first and after the last key, theirs.

        Quaternions come out with length 1, or NaN where keys leave no direction.
        """
        last = len(self.times) - 1
        here = times + SAME_TIME * np.maximum(1.0, np.abs(times))
        before = np.clip(np.searchsorted(self.times, here, side="right") - 1, 0, last)
        if self.is_step or last == 0:
            found = self.values[before]
            return unit_quaternions(found) if self.is_rotation else found
        before = np.minimum(before, last - 1)
        start, end = self.values[before], self.values[before + 1]
        span = (self.times[before + 1] - self.times[before])[:, None]
        s = np.clip((times - self.times[before])[:, None] / span, 0.0, 1.0)
        if self.tangents is not None:
            leave, arrive = span * self.tangents[1, before], span * self.tangents[0, before + 1]
            ease = s * s * (3.0 - 2.0 * s)
            found = start + ease * (end - start) + s * (s - 1.0) ** 2 * leave + s * s * (s - 1.0) * arrive
            return unit_quaternions(found) if self.is_rotation else np.asarray(found)
        if self.is_rotation:
            return _turned(unit_quaternions(start), unit_quaternions(end), s)
        return np.asarray(start + s * (end - start))


def unit_quaternions(quaternions: Float) -> Float:
    """Quaternions of length 1, shape (k, 4); NaN where they have none."""
    length = np.sqrt((quaternions * quaternions).sum(axis=1, keepdims=True))
    return np.asarray(quaternions / np.where(length > 0.0, length, np.nan))


def _turned(start: Float, end: Float, share: Float) -> Float:
    """Quaternions a share of the shorter way from one to another, shape (k, 4) (Shoemake 1985)."""
    cosine = (start * end).sum(axis=1, keepdims=True)
    end = np.where(cosine < 0.0, -end, end)
    angle = np.arccos(np.minimum(np.abs(cosine), 1.0))
    # Below this angle the chord is the arc.
    sine = np.where(angle < 1e-6, 1.0, np.sin(angle))
    first = np.where(angle < 1e-6, 1.0 - share, np.sin((1.0 - share) * angle) / sine)
    second = np.where(angle < 1e-6, share, np.sin(share * angle) / sine)
    return unit_quaternions(first * start + second * end)
