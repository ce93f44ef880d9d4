"""A lead-in for bodies on which garments cannot be sewn as they are: from a pose of rest or a made one."""

import math
from dataclasses import replace

import numpy as np

from toile.dressing.body.animated_avatar import DEFAULT_FPS, led_in_avatars
from toile.dressing.body.avatar import Avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.posing.opened_arms import opened_arms
from toile.dressing.files.leading.standing import eased
from toile.dressing.run.scene import OFF, AvatarFile
from toile.engine.cloth.vertex_motion import VertexMotion
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

    The pose is that of a skeleton at rest, or one with open arms that is made of the first frame. A body that
    stands still stays as it is; only its form begins with open arms, with a motion that closes them.

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
        If the user asks for a lead-in and there is neither a skeleton nor arms to make one with.
    """
    asked = _asked(source)
    if source.lead_in == OFF or not (asked or sewn) or (asked is None and arm_angle(form) <= HANGING):
        return avatar, form, None
    best: tuple[Avatar, DressForm] | None = None
    path, how = source.path, "in its rest pose"
    if avatar.motion is not None:
        for rest in led_in_avatars(
            path, reading=source.reading, fps=source.fps, clip=source.clip, seconds=asked or SECONDS,
            up=avatar.up_axis,
        ):  # fmt: skip
            candidate = rest, DressForm(rest, form.given)
            if best is None or arm_angle(candidate[1]) < arm_angle(best[1]):
                best = candidate
    if best is None or (asked is None and arm_angle(best[1]) > HANGING):
        best, how = _opened(avatar, form, asked or SECONDS), "with its arms opened"
    if best is None and asked is not None:
        raise InputError(
            f"{path}: lead_in needs a skeleton (glTF or USD), or arms that no other surface "
            "is part of down to the hands; leave it out",
            file=path, field="lead_in",
        )  # fmt: skip
    if best is None:
        return avatar, form, None
    return *best, _sentence(form, best[1], asked, how)


def _opened(avatar: Avatar, form: DressForm, seconds: float) -> tuple[Avatar, DressForm] | None:
    """Return an avatar and its form that begin with open arms; None where its arms are not found or not free.

    An avatar that stands still remains as it is.
    """
    own, place = form.avatar, form.place
    if own.solid is not None:
        return None
    fps = DEFAULT_FPS if own.motion is None else own.motion.fps
    count = max(round(seconds * fps), 1)
    lead = opened_arms(own.vertices, own.faces, 1.0 - eased(count))
    if lead is None:
        return None
    rest = own.vertices[None] if own.motion is None else own.motion.frames
    moving = VertexMotion(frames=np.concatenate([lead, rest]), fps=fps, lead=count)
    opened = form.in_pose(lead[0], moving)
    if arm_angle(opened) > HANGING:
        return None
    if avatar.motion is None:
        return avatar, opened
    shown = np.concatenate([place.outward(lead), avatar.motion.frames])
    return replace(avatar, vertices=place.outward(lead[0]), motion=replace(moving, frames=shown)), opened


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


def _sentence(clip: DressForm, rest: DressForm, asked: float | None, how: str) -> str:
    """Say that a lead-in was made, and why."""
    motion = rest.avatar.motion
    assert motion is not None
    found, there = arm_angle(clip), arm_angle(rest)
    stands = clip.avatar.motion is None
    if asked is not None:
        why = "as asked"
    elif math.isinf(found):
        why = "it cannot be measured" + ("" if stands else " in its first frame")
    else:
        frame = "" if stands else " in its first frame"
        why = f"its arms hang{frame}, {np.degrees(found):.0f} degrees below the horizontal"
    pose = "" if math.isinf(there) else f" (arms at {np.degrees(there):.0f} degrees)"
    sewn = f"{why}: garments are sewn {how}{pose}, and"
    length = f"{motion.lead / motion.fps:.2g} s"
    if stands:
        return f"{sewn} the arms close again in {length}; lead_in = off leaves them as they are"
    return (
        f"{sewn} {length} lead from there into the clip, not among the frames; lead_in sets their length, or "
        "off"
    )
