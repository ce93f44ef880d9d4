"""What lead-ins of all formats share: how they ease, and where the body stands on its way."""

import numpy as np

from toile.geometry.arrays import Float


def eased(count: int) -> Float:
    """Return shares of the way at `count` equal times, the first 0; the end, 1, would be the next."""
    s = np.arange(count) / count
    return np.asarray(s * s * (3.0 - 2.0 * s))


def standing(frames: Float, up: int) -> Float:
    """Return frames of a body, (k, v, 3), each put where the last stands, and faced as it faces.

    The lowest vertices are at one height, the middles above one place, and the turn about the vertical is the
    one that brings vertices nearest to those of the last frame (Kabsch 1976, in the plane).
    """
    # Axes that make a right-handed frame with the vertical.
    across, ahead = (up + 1) % 3, (up + 2) % 3
    last = frames[-1]
    middle = last.mean(axis=0)
    a, b = last[:, across] - middle[across], last[:, ahead] - middle[ahead]
    placed = np.empty_like(frames)
    for index, frame in enumerate(frames):
        own = frame.mean(axis=0)
        x, y = frame[:, across] - own[across], frame[:, ahead] - own[ahead]
        angle = np.arctan2((x * b - y * a).sum(), (x * a + y * b).sum())
        cosine, sine = np.cos(angle), np.sin(angle)
        placed[index, :, across] = middle[across] + cosine * x - sine * y
        placed[index, :, ahead] = middle[ahead] + sine * x + cosine * y
        placed[index, :, up] = frame[:, up] - frame[:, up].min() + last[:, up].min()
    return placed
