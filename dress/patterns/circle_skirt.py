"""Full circle skirt: four quarter rings on a waistband."""

import math

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


def draft_circle_skirt(body: Measurements) -> Pattern:
    """Return a full circle skirt that reaches the knee.

    The waistband is 1.5 cm longer than the waist (for a body 1.70 m tall, in proportion for others) and sits
    at the waist. The skirt is a whole ring whose inner girth is that of the band, cut in four: a half ring
    would be over a metre wide at the waist and cut the arms, a quarter hangs between them. Front and back
    quarters start as far apart as the arms allow; where they overlap, one hangs a plane behind the other.

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
    z_back, z_front = body.torso_depth
    gap = 0.02 * scale

    def quarter(name: str, x: float, z: float) -> Draft:
        sides = _quarter_ring(radius, length)
        return Draft(name=name, sides=sides, translation=(x, top - gap, z), label="leg")

    radius = girth / (2.0 * math.pi)
    # Hands held forward stand farther in than the straight arm that was measured.
    front = _offset(body, top - gap, radius, length, 0.15 * scale)
    back = _offset(body, top - gap, radius, length, 0.06 * scale)
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
    # The plane nearest to the body stays free for the band.
    drafts = [
        band,
        band_back,
        quarter("left_front", front, z_front + 2.0 * gap),
        quarter("right_front", -front, z_front + 3.0 * gap),
        quarter("left_back", back, z_back - 2.0 * gap).turned(),
        quarter("right_back", -back, z_back - 3.0 * gap).turned(),
    ]
    half = [
        ("front_waistband", "left_end", "back_waistband", "left_end"),
        ("front_waistband", "left_lower_0", "left_front", "waist"),
        ("back_waistband", "left_lower_0", "left_back", "waist"),
        ("left_front", "left_seam", "left_back", "left_seam"),
    ]
    middle = [
        ("left_front", "right_seam", "right_front", "left_seam"),
        ("left_back", "right_seam", "right_back", "left_seam"),
    ]
    return sew("circle_skirt", drafts, half + mirrored_seams(half) + middle, waist_notes(body))


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
