"""Regions of a body: which part of it a point lies on."""

from typing import NamedTuple

import numpy as np

from toile.dressing.body.measurements import Measurements
from toile.geometry.arrays import Bool, Float, Int

BANDS = 10
"""Bands of equal height of a body that could not be measured."""
ELBOW, HAND = 0.47, 1.0
"""Where forearm and hand begin, in lengths of the arm from the shoulder point."""
ARM_REACH, NEAR_ARM = 0.16, 0.02
"""Farthest point from the axis of an arm, and where one begins beyond the shoulder point [m]."""
KNEE, ANKLE, CHIN = 0.285, 0.05, 0.05
"""Height of knee and ankle, and of the chin over the base of the neck, in heights of the body."""


class Regions(NamedTuple):
    """Names of regions, and the number of the region of every point, shape (n,)."""

    names: tuple[str, ...]
    of: Int


def regions_of(points: Float, measured: Measurements | None, height: tuple[float, float]) -> Regions:
    """Return the regions of points in the body's own frame [m], shape (n, 3).

    Left and right are the body's. `height` are the lowest and the highest point of a body that was not
    measured [m]: it has bands.
    """
    if measured is None:
        low, high = height
        up = (points[:, 1] - low) / max(high - low, 1e-9)
        bands = tuple(f"{10 * k} to {10 * k + 10} % of its height" for k in range(BANDS))
        return Regions(bands, np.clip(up * BANDS, 0, BANDS - 1).astype(np.int32))
    y, front = points[:, 1], points[:, 2] > 0.5 * sum(measured.torso_depth)
    labels = np.full(len(points), "", dtype=object)
    belt = 0.5 * (measured.hip_height + measured.waist_height)
    ribs = 0.5 * (measured.waist_height + measured.chest_height)
    neck = measured.neck_height
    levels: list[tuple[float, str]] = [
        (-np.inf, "hips"), (belt, "waist"), (ribs, "chest"), (measured.armpit_height, "shoulders"),
    ]  # fmt: skip
    for level, name in levels:
        above = y >= level
        labels[above & front], labels[above & ~front] = f"{name}, front", f"{name}, back"
    labels[y >= neck] = "neck"
    labels[y >= neck + CHIN * measured.height] = "head"
    legs = y < measured.crotch_height
    for side, sign in (("left", 1.0), ("right", -1.0)):
        own = legs & (sign * points[:, 0] >= 0.0)
        for share, part in ((np.inf, "thigh"), (KNEE, "calf"), (ANKLE, "foot")):
            labels[own & (y < share * measured.height)] = f"{side} {part}"
        along, arm = _on_arm(points, measured, sign)
        for share, part in ((0.0, "upper arm"), (ELBOW, "forearm"), (HAND, "hand")):
            labels[arm & (along >= share * measured.arm_length)] = f"{side} {part}"
    found, of = np.unique(labels.astype(str), return_inverse=True)
    return Regions(tuple(found.tolist()), of.astype(np.int32))


def _on_arm(points: Float, measured: Measurements, sign: float) -> tuple[Float, Bool]:
    """Return how far along an arm points lie [m], shape (n,), and whether they are on it."""
    shoulder = np.array(measured.shoulder_point) * [sign, 1.0, 1.0]
    axis = np.array([sign * np.cos(measured.arm_angle), -np.sin(measured.arm_angle), 0.0])
    offset = points - shoulder
    along = offset @ axis
    across = np.linalg.norm(offset - along[:, None] * axis, axis=1)
    # The trunk beside a hanging arm is nearer to the middle than its shoulder point.
    outer = sign * points[:, 0] > measured.shoulder_point[0] - NEAR_ARM
    return along, (along > NEAR_ARM) & (across < ARM_REACH) & outer
