"""Full circle skirt: four quarter rings on a waistband."""

import math
from dataclasses import replace
from itertools import product

from toile.dressing.body.measurements import Measurements
from toile.dressing.pattern.drafts.drafting import (
    DRAFT_HEIGHT,
    Draft,
    Side,
    mirrored_seams,
    require_levels,
    sew,
    waist_notes,
)
from toile.dressing.pattern.drafts.waistband import band_sides
from toile.dressing.pattern.pattern import Arc, Pattern

WAIST_EASE = 0.015
"""Girth of the waistband beyond the waist [m], for a body 1.70 m tall."""
BAND_HEIGHT = 0.035
"""Height of the waistband [m], for a body 1.70 m tall."""
FLATTEST, STEEPEST = 60, 45
"""Slopes at which a quarter can start, from the vertical [degrees]: the flatter, the nearer its seams are."""
LOWERING, LOWERINGS = 0.04, 5
"""Steps by which it starts lower to clear the arms [m], for a body 1.70 m tall, and how many are tried."""
ARM_ROOM, ARM_STEPS = 0.05, 20
"""Room below an arm [m], for a body 1.70 m tall; points at which it is looked for."""


def draft_circle_skirt(body: Measurements) -> Pattern:
    """Return a full circle skirt that reaches the knee.

    The waistband is 1.5 cm longer than the waist (for a body 1.70 m tall, in proportion for others) and sits
    at the waist. The skirt is a whole ring whose inner girth is that of the band, cut in four. Where the arms
    leave room below them, the quarters start spread like a tent about the body, the edges of every seam close
    to each other; else as flat as they are, two in front and two behind, between the arms.

    Raises
    ------
    InputError
        If the measurements are not those of an upright body.
    """
    require_levels("circle_skirt", body, ("crotch_height", "hip_height", "waist_height"))
    scale = body.height / DRAFT_HEIGHT
    girth = body.waist + WAIST_EASE * scale
    band_height = BAND_HEIGHT * scale
    top = body.waist_height - band_height / 2.0
    # The knee is three fifths of the way up to the crotch.
    length = top - 0.6 * body.crotch_height
    radius = girth / (2.0 * math.pi)
    z_back, z_front = body.torso_depth
    gap = 0.02 * scale
    quarters = _tent(body, top - gap, radius, length) or _flat(body, top - gap, radius, length)
    drafts = [*quarters, *(quarter.mirrored() for quarter in quarters)]
    raised = 0.0
    if quarters[0].tilt_degrees:
        # The waist seam meets half-way, and that is where it shall sit.
        raised = top - quarters[0].translation[1]
    else:
        # Where the flat ones overlap, one hangs a plane behind the other.
        drafts[-2:] = [_beyond(drafts[-2], gap), _beyond(drafts[-1], -gap)]
    band = Draft(
        name="front_waistband",
        sides=band_sides((girth / 4.0,), band_height),
        translation=(0.0, top + raised, z_front + gap),
        label="body",
        role="torso",
    )
    band_back = Draft(
        name="back_waistband",
        sides=band.sides,
        translation=(0.0, top + raised, z_back - gap),
        label="body",
        role="torso",
    ).turned()
    half = [
        ("front_waistband", "left_end", "back_waistband", "left_end"),
        ("front_waistband", "left_lower_0", "left_front", "waist"),
        ("back_waistband", "left_lower_0", "left_back", "waist"),
        ("left_front", "left_seam", "left_back", "right_seam"),
    ]
    middle = [
        ("left_front", "right_seam", "right_front", "left_seam"),
        ("left_back", "left_seam", "right_back", "right_seam"),
    ]
    return sew(
        "circle_skirt", [band, band_back, *drafts], half + mirrored_seams(half) + middle, waist_notes(body)
    )


def _tent(body: Measurements, top: float, radius: float, length: float) -> list[Draft]:
    """Return the left front and back quarters sloping below the arms; none if those are in the way.

    They start as high as the arms let them lie flat enough, at most `top` [m].
    """
    scale = body.height / DRAFT_HEIGHT
    middle = 0.5 * sum(body.torso_depth)
    for lower, tilt in product(range(LOWERINGS), range(FLATTEST, STEEPEST - 1, -1)):
        height = top - LOWERING * scale * lower
        apart = _apart(body, radius, length, tilt)
        if _clears_arms(body, height, radius, apart, tilt):
            # The panel's origin lies between its upper corners.
            outward = math.sqrt(0.5) * (math.sqrt(2.0) * apart + math.sqrt(0.5) * radius * _sin(tilt))
            return [
                Draft(
                    name=f"left_{name}",
                    sides=_quarter_ring(radius, length),
                    translation=(outward, height, middle + side * outward),
                    tilt_degrees=float(tilt),
                    azimuth_degrees=azimuth,
                    label="leg",
                    role="leg",
                )
                for name, side, azimuth in (("front", 1.0, 45.0), ("back", -1.0, 135.0))
            ]
    return []


def _apart(body: Measurements, radius: float, length: float, tilt: int) -> float:
    """How far to the side and to the front quarters that slope by `tilt` are moved [m].

    A quarter of a ring on a slope reaches past its quarter of the way round, the less the flatter it lies:
    moved out by that much, quarters do not meet. Upper corners stay clear of the hips, about an ellipse.
    """
    scale = body.height / DRAFT_HEIGHT
    deep = 0.5 * (body.torso_depth[1] - body.torso_depth[0])
    wide = math.sqrt(max(2.0 * (body.hip / (2.0 * math.pi)) ** 2 - deep**2, 0.0))
    corner = 0.5 * (1.0 + _sin(tilt)) * radius
    beyond = 0.5 * (1.0 - _sin(tilt)) * (radius + length)
    return max(beyond, max(deep, wide) + 0.01 * scale - corner) + 0.01 * scale


def _clears_arms(body: Measurements, height: float, radius: float, apart: float, tilt: int) -> bool:
    """Whether straight arms and hands stay above quarters at `height`, moved out by `apart` [m]."""
    scale = body.height / DRAFT_HEIGHT
    thickness = body.upper_arm / (2.0 * math.pi) + ARM_ROOM * scale
    # The quarters are one cone's, moved apart.
    apex = height + math.sqrt(0.5) * radius * math.cos(math.radians(tilt))
    reach = _arm_with_hand(body)
    for step in range(ARM_STEPS + 1):
        along = reach * step / ARM_STEPS
        x = body.shoulder_point[0] + along * math.cos(body.arm_angle)
        y = body.shoulder_point[1] - along * math.sin(body.arm_angle)
        slope = apex - (x - 2.0 * apart) * math.sqrt(0.5) / math.tan(math.radians(tilt))
        if y - thickness / max(math.cos(body.arm_angle), 0.1) < min(height, slope):
            return False
    return True


def _arm_with_hand(body: Measurements) -> float:
    """Shoulder point to fingertips [m]: the hand is about a ninth of the height long."""
    return body.arm_length + body.height / 9.0


def _sin(degrees: float) -> float:
    return math.sin(math.radians(degrees))


def _flat(body: Measurements, top: float, radius: float, length: float) -> list[Draft]:
    """Return the left front and back quarters hanging flat between the arms, as far apart as those allow."""
    scale = body.height / DRAFT_HEIGHT
    z_back, z_front = body.torso_depth
    gap = 0.02 * scale
    # Hands held forward stand farther in than the straight arm that was measured.
    front = _offset(body, top, radius, length, 0.15 * scale)
    back = _offset(body, top, radius, length, 0.06 * scale)
    sides = _quarter_ring(radius, length)
    # The plane nearest to the body stays free for the band.
    return [
        Draft(
            name="left_front", sides=sides, translation=(front, top, z_front + 2.0 * gap),
            label="leg", role="leg",
        ),
        Draft(
            name="left_back", sides=sides, translation=(back, top, z_back - 2.0 * gap), azimuth_degrees=180.0,
            label="leg", role="leg",
        ),
    ]  # fmt: skip


def _beyond(quarter: Draft, distance: float) -> Draft:
    """Return a quarter `distance` [m] farther to the front."""
    x, y, z = quarter.translation
    return replace(quarter, translation=(x, y, z + distance))


def _offset(body: Measurements, top: float, radius: float, length: float, margin: float) -> float:
    """Distance [m] of a quarter from the middle: its 45 degree edge stays `margin` inside the arm."""
    across = math.sqrt(0.5)
    apart = across * (radius + length) + 0.01 * body.height / DRAFT_HEIGHT
    down, out = math.sin(body.arm_angle), math.cos(body.arm_angle)
    lowest = body.shoulder_point[1] - _arm_with_hand(body) * down
    if lowest >= top:
        return apart
    room = apart
    for y in (top, max(lowest, top - across * length)):
        arm = body.shoulder_point[0] + (body.shoulder_point[1] - y) * out / down
        room = min(room, arm - body.upper_arm / (2.0 * math.pi * down) - across * radius - (top - y) - margin)
    return max(room, across * radius / 2.0)


def _quarter_ring(radius: float, length: float) -> tuple[Side, ...]:
    """Quarter of a ring about the vertical, counter-clockwise; its upper corners lie at y = 0."""
    across = math.sqrt(0.5)
    outer = radius + length
    drop = across * radius
    upper_left, lower_left = (across * radius, 0.0), (across * outer, drop - across * outer)
    upper_right, lower_right = (-across * radius, 0.0), (-across * outer, drop - across * outer)
    return (
        Side(name="hem", start=lower_right, end=lower_left, arc=Arc(outer, False, True)),
        Side(name="left_seam", start=lower_left, end=upper_left),
        Side(name="waist", start=upper_left, end=upper_right, arc=Arc(radius, False, False)),
        Side(name="right_seam", start=upper_right, end=lower_right),
    )
