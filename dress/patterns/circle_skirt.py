"""Full circle skirt: four quarter rings on a waistband."""

import math
from dataclasses import replace

from toile.dress.measurements import Measurements
from toile.dress.pattern import Arc, Pattern
from toile.dress.patterns.drafting import (
    DRAFT_HEIGHT,
    Draft,
    Side,
    mirrored_seams,
    require_levels,
    sew,
    waist_notes,
)
from toile.dress.patterns.waistband import band_sides

WAIST_EASE = 0.015
"""Girth of the waistband beyond the waist [m], for a body 1.70 m tall."""
BAND_HEIGHT = 0.035
"""Height of the waistband [m], for a body 1.70 m tall."""
FLATTEST, STEEPEST = 60, 30
"""Slopes at which a quarter can start, from the vertical [degrees]: the flatter, the nearer its seams are."""
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
    band = Draft(
        name="front_waistband",
        sides=band_sides((girth / 4.0,), band_height),
        translation=(0.0, top, z_front + gap),
        label="body",
    )
    band_back = Draft(
        name="back_waistband",
        sides=band.sides,
        translation=(0.0, top, z_back - gap),
        label="body",
    ).turned()
    quarters = _tent(body, top - gap, radius, length) or _flat(body, top - gap, radius, length)
    drafts = [band, band_back, *quarters, *(quarter.mirrored() for quarter in quarters)]
    if not quarters[0].tilt_degrees:
        # Where the flat ones overlap, one hangs a plane behind the other.
        drafts[-2:] = [_beyond(drafts[-2], gap), _beyond(drafts[-1], -gap)]
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
    return sew("circle_skirt", drafts, half + mirrored_seams(half) + middle, waist_notes(body))


def _tent(body: Measurements, top: float, radius: float, length: float) -> list[Draft]:
    """Return the left front and back quarters sloping, at most `top` high; none if arms are in the way.

    A quarter of a ring on a slope reaches beyond its quarter of the way around, the less the flatter it lies:
    the quarters are moved outward until they do not meet.
    """
    scale = body.height / DRAFT_HEIGHT
    across = math.sqrt(0.5)
    middle = 0.5 * sum(body.torso_depth)
    for tilt in range(FLATTEST, STEEPEST - 1, -1):
        out, down = math.sin(math.radians(tilt)), math.cos(math.radians(tilt))
        apart = 0.5 * (1.0 - out) * (radius + length) + 0.01 * scale
        apex = top + across * radius * down
        if _clears_arms(body, top, apex, apart, tilt):
            # The panel's origin is on the line between its upper corners.
            from_apex = across * radius
            outward, height = math.sqrt(2.0) * apart + from_apex * out, apex - from_apex * down
            return [
                Draft(
                    name=f"left_{name}",
                    sides=_quarter_ring(radius, length),
                    translation=(across * outward, height, middle + side * across * outward),
                    tilt_degrees=float(tilt),
                    azimuth_degrees=azimuth,
                    label="leg",
                )
                for name, side, azimuth in (("front", 1.0, 45.0), ("back", -1.0, 135.0))
            ]
    return []


def _clears_arms(body: Measurements, top: float, apex: float, apart: float, tilt: int) -> bool:
    """Whether straight arms and hands stay above quarters that slope from `apex`, moved out by `apart`."""
    scale = body.height / DRAFT_HEIGHT
    thickness = body.upper_arm / (2.0 * math.pi) + ARM_ROOM * scale
    # The hand is about a ninth of the height long.
    reach = body.arm_length + body.height / 9.0
    for step in range(ARM_STEPS + 1):
        along = reach * step / ARM_STEPS
        x = body.shoulder_point[0] + along * math.cos(body.arm_angle)
        y = body.shoulder_point[1] - along * math.sin(body.arm_angle)
        slope = apex - (x - 2.0 * apart) * math.sqrt(0.5) / math.tan(math.radians(tilt))
        if y - thickness / max(math.cos(body.arm_angle), 0.1) < min(top, slope):
            return False
    return True


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
        Draft(name="left_front", sides=sides, translation=(front, top, z_front + 2.0 * gap), label="leg"),
        Draft(
            name="left_back", sides=sides, translation=(back, top, z_back - 2.0 * gap), azimuth_degrees=180.0,
            label="leg",
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
    # The hand is about a ninth of the height long.
    lowest = body.shoulder_point[1] - (body.arm_length + body.height / 9.0) * down
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
