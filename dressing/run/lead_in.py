"""A lead-in for clips in whose first frame garments cannot be sewn: from a pose of rest into the clip."""

import math

import numpy as np

from toile.dressing.body.animated_avatar import is_animated, led_in_avatars
from toile.dressing.body.avatar import Avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.files.gltf.gltf_lead_in import has_skeleton
from toile.dressing.files.read_surface import GLTF
from toile.dressing.run.scene import OFF, AvatarFile
from toile.geometry.errors import InputError, about

HANGING = np.radians(65.0)
"""Arms that are lower than this leave sleeves little room [rad]."""
SECONDS = 1.0
"""Length of a lead-in that nobody asked for [s]."""
LONGEST = 60.0
"""Lead-ins are no longer [s]."""


def arm_angle(form: DressForm) -> float:
    """Return how far the arms of a body hang below the horizontal [rad]; infinite if it is not known."""
    return math.inf if isinstance(form.measured, InputError) else float(form.measured.arm_angle)


def led_in(
    source: AvatarFile, avatar: Avatar, form: DressForm, sewn: bool
) -> tuple[Avatar, DressForm, str | None]:
    """Return an avatar that begins in a pose of rest, its form, and why; or the same where none is needed.

    Parameters
    ----------
    source
        Where the avatar is from. Its `lead_in` is a length [s], "off", or None: as needed.
    avatar, form
        As its clip begins.
    sewn
        Whether garments are sewn on it: else the first frame is good as it is, unless the user asks.

    Raises
    ------
    InputError
        If the user asks for a lead-in and there is no skeleton to make one with.
    """
    asked = _asked(source)
    if source.lead_in == OFF or source.time is not None or not (asked or sewn):
        return avatar, form, None
    if asked is None and (avatar.motion is None or arm_angle(form) <= HANGING):
        return avatar, form, None
    path = source.path
    if not (path.suffix.lower() in GLTF and is_animated(path) and has_skeleton(path)):
        if asked is None:
            return avatar, form, None
        raise InputError(
            f"{path}: lead_in needs an animated .glb, .gltf or .vrm with a skeleton; leave it out",
            file=path, field="lead_in",
        )  # fmt: skip
    best: tuple[Avatar, DressForm] | None = None
    for rest in led_in_avatars(
        path, reading=source.reading, fps=source.fps, clip=source.clip, seconds=asked or SECONDS,
        up=avatar.up_axis,
    ):  # fmt: skip
        candidate = rest, DressForm(rest, form.given)
        if best is None or arm_angle(candidate[1]) < arm_angle(best[1]):
            best = candidate
    if best is None or (asked is None and arm_angle(best[1]) > HANGING):
        return avatar, form, None
    return *best, _sentence(form, best[1], asked)


def _asked(source: AvatarFile) -> float | None:
    """Return the length that the user asks for [s], or None. Raises InputError if it is none."""
    value = source.lead_in
    if value is None or value == OFF:
        return None
    with about(file=source.path):
        if isinstance(value, str | bool) or not 0.0 < value <= LONGEST:
            raise InputError(
                f"{source.path}: lead_in must be '{OFF}' or lie between 0 and {LONGEST:g} s, got {value!r}",
                field="lead_in",
            )
        if source.time is not None:
            raise InputError(
                f"{source.path}: lead_in leads into a motion, but with time the body stands; leave one out",
                field="lead_in",
            )
    return float(value)


def _sentence(clip: DressForm, rest: DressForm, asked: float | None) -> str:
    """Say that a lead-in was made, and why."""
    motion = rest.avatar.motion
    assert motion is not None
    found, there = arm_angle(clip), arm_angle(rest)
    if asked is not None:
        why = "as asked"
    elif math.isinf(found):
        why = "it cannot be measured in its first frame"
    else:
        why = f"its arms hang in its first frame, {np.degrees(found):.0f} degrees below the horizontal"
    pose = "" if math.isinf(there) else f" (arms at {np.degrees(there):.0f} degrees)"
    return (
        f"{why}: garments are sewn in its rest pose{pose}, and {motion.lead / motion.fps:.2g} s lead from "
        "there into the clip, not among the frames; lead_in sets their length, or off"
    )
