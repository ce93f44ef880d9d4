"""T-shirt: front and back in one piece each, set-in short sleeves of a front and a back half."""

import math
from dataclasses import dataclass

from toile.dressing.body.measurements import Measurements
from toile.dressing.pattern.drafts.drafting import (
    DRAFT_HEIGHT,
    QUARTER_ELLIPSE,
    Draft,
    Side,
    closed_loop,
    find_root,
    mirrored_seams,
    require_levels,
    sew,
)
from toile.dressing.pattern.pattern import Pattern, Point

CHEST_EASE = 0.08
"""Chest girth of the shirt less that of a 1.70 m body [m]."""
HIP_EASE = 0.05
"""Least girth of the hem beyond the hip [m]."""
SLEEVE_EASE = 0.07
"""Girth of the sleeve at its widest beyond the upper arm [m]; at least this."""
CAP_EASE = 0.01
"""Length of the sleeve cap beyond the armhole, as a fraction."""
NECK_EASE = 1.15
"""Least girth of the neck hole over that of the neck."""

_FRONT_ARMHOLE_DEPTH = 0.75
_BACK_ARMHOLE_DEPTH = 0.55
"""How far the armhole runs level from the underarm towards the shoulder's plumb line, as a fraction."""


@dataclass(frozen=True, kw_only=True)
class _Frame:
    """Points of the left half in world (x, y) [m]."""

    neck: Point
    shoulder: Point
    underarm: Point
    hem: Point
    front_neck: Point
    back_neck: Point


@dataclass(frozen=True, kw_only=True)
class _Sleeve:
    """Half a sleeve: cap height and half girth [m], length of the top fold, half girth of the cuff [m]."""

    cap_height: float
    half_girth: float
    length: float
    cuff: float


def draft_tshirt(body: Measurements) -> Pattern:
    """Return a T-shirt, drafted to the body.

    Ease (for a body 1.70 m tall, in proportion to the height for others): chest + 8 cm; hem, at the hip,
    at least hip + 5 cm; sleeve at least upper arm + 7 cm; sleeve cap 1 % longer than the armhole; neck
    hole at least 15 % wider than the neck. The armhole reaches 2.5 cm below the armpit, or more for a strong
    arm.

    Raises
    ------
    InputError
        If the measurements are not those of an upright body.
    """
    require_levels("tshirt", body, ("hip_height", "armpit_height", "shoulder_height"))
    scale = body.height / DRAFT_HEIGHT
    frame, sleeve = _fitted(body, scale)
    z_back, z_front = body.torso_depth
    # Sleeves next to the body, torso panels outside of them: four planes that cannot meet.
    front = Draft(
        name="front",
        sides=_torso(frame, front=True),
        translation=(0, 0, z_front + 0.05 * scale),
        label="body",
        role="torso",
    )
    back = Draft(
        name="back",
        sides=_torso(frame, front=False),
        translation=(0, 0, z_back - 0.05 * scale),
        label="body",
        role="torso",
    ).turned()
    x, y = _sleeve_place(body, sleeve, scale)
    turn = -math.degrees(body.arm_angle)
    sleeve_front = Draft(
        name="left_sleeve_front",
        sides=_sleeve_half(sleeve, _armhole(frame, front=True).length),
        translation=(x, y, z_front + 0.02 * scale),
        turn_degrees=turn,
        label="arm",
        role="sleeve",
    )
    sleeve_back = Draft(
        name="left_sleeve_back",
        sides=_sleeve_half(sleeve, _armhole(frame, front=False).length),
        translation=(x, y, z_back - 0.02 * scale),
        turn_degrees=turn,
        label="arm",
        role="sleeve",
    ).turned()
    seams = [
        ("front", "left_shoulder", "back", "left_shoulder"),
        ("front", "left_side", "back", "left_side"),
        ("left_sleeve_front", "top", "left_sleeve_back", "top"),
        ("left_sleeve_front", "bottom", "left_sleeve_back", "bottom"),
        ("left_sleeve_front", "cap", "front", "left_armhole"),
        ("left_sleeve_back", "cap", "back", "left_armhole"),
    ]
    drafts = [front, back, sleeve_front, sleeve_back, sleeve_front.mirrored(), sleeve_back.mirrored()]
    return sew("tshirt", drafts, seams + mirrored_seams(seams))


def _fitted(body: Measurements, scale: float) -> tuple[_Frame, _Sleeve]:
    """Torso and sleeve; the armhole is deepened until the sleeve is wide enough for the arm."""
    drop = body.shoulder_point[1] - body.armpit_height + 0.025 * scale
    drop = max(drop, 0.55 * body.upper_arm)
    for _ in range(20):
        frame = _frame(body, scale, drop)
        sleeve = _sleeve(body, scale, frame)
        if 2.0 * sleeve.half_girth >= body.upper_arm + SLEEVE_EASE * scale - 1e-9:
            break
        drop += 0.01 * scale
    return frame, sleeve


def _frame(body: Measurements, scale: float, armhole_drop: float) -> _Frame:
    chest = (body.chest + CHEST_EASE * scale) / 4.0
    hem = max(chest, (body.hip + HIP_EASE * scale) / 4.0)
    shoulder_x = min(body.shoulder_width / 2.0, chest - 0.03 * scale)
    shoulder_y = body.shoulder_point[1] + 0.005 * scale
    neck_x = min(body.neck_width / 2.0 + 0.015 * scale, shoulder_x - 0.04 * scale)
    # A slope of 12 to 30 degrees: the two levels are the least certain of the measurements.
    run = shoulder_x - neck_x
    rise = min(max(body.neck_height - shoulder_y, 0.21 * run), 0.58 * run)
    neck_y = shoulder_y + rise
    back_depth = 0.025 * scale

    def girth(front_depth: float) -> float:
        halves = (_neckline((neck_x, neck_y), neck_y - depth).length for depth in (front_depth, back_depth))
        return 2.0 * sum(halves)

    least = NECK_EASE * body.neck
    front_depth = find_root(lambda depth: girth(depth) - least, 0.085 * scale, 0.2 * scale)
    return _Frame(
        neck=(neck_x, neck_y),
        shoulder=(shoulder_x, shoulder_y),
        underarm=(chest, shoulder_y - armhole_drop),
        hem=(hem, body.hip_height),
        front_neck=(0.0, neck_y - front_depth),
        back_neck=(0.0, neck_y - back_depth),
    )


def _torso(frame: _Frame, *, front: bool) -> tuple[Side, ...]:
    """Outline of front or back, counter-clockwise from the hem, both halves."""
    left = [
        Side(name="left_side", start=frame.hem, end=frame.underarm),
        _armhole(frame, front=front),
        Side(name="left_shoulder", start=frame.shoulder, end=frame.neck),
        _neckline(frame.neck, (frame.front_neck if front else frame.back_neck)[1]),
    ]
    right = [side.mirrored().backwards() for side in reversed(left)]
    hem = Side(name="hem", start=right[-1].end, end=left[0].start)
    return (hem, *left, *right)


def _armhole(frame: _Frame, *, front: bool) -> Side:
    """Left armhole from the underarm up: level at the side seam, square to the shoulder seam at the top."""
    (x_u, y_u), (x_s, y_s), (x_n, y_n) = frame.underarm, frame.shoulder, frame.neck
    reach = (_FRONT_ARMHOLE_DEPTH if front else _BACK_ARMHOLE_DEPTH) * (x_u - x_s)
    seam = math.hypot(x_s - x_n, y_n - y_s)
    down = 0.45 * (y_s - y_u)
    handle = (x_s - down * (y_n - y_s) / seam, y_s - down * (x_s - x_n) / seam)
    return Side(
        name="left_armhole",
        start=frame.underarm,
        end=frame.shoulder,
        controls=((x_u - reach, y_u), handle),
    )


def _neckline(neck: Point, bottom: float) -> Side:
    """Left half of a neckline, from the shoulder to the middle: a quarter of an ellipse."""
    x, y = neck
    controls = ((x, y - QUARTER_ELLIPSE * (y - bottom)), (QUARTER_ELLIPSE * x, bottom))
    return Side(
        name="left_collar",
        start=neck,
        end=(0.0, bottom),
        controls=controls,
        label="left_collar",
        role="collar",
    )


def _sleeve(body: Measurements, scale: float, frame: _Frame) -> _Sleeve:
    """Cap height and girth from the armholes: a wide arm gets a flat cap, a thin one a high cap."""
    shorter = (1.0 + CAP_EASE) * min(_armhole(frame, front=True).length, _armhole(frame, front=False).length)
    # An S-shaped cap is 2 to 10 % longer than its chord, most if it is high; 4 % leaves room both ways.
    chord = shorter / 1.04
    wanted = (body.upper_arm + (SLEEVE_EASE + 0.02 * scale) * scale) / 2.0
    cap_height = math.sqrt(max(chord * chord - wanted * wanted, 0.0))
    cap_height = min(max(cap_height, 0.35 * chord), 0.6 * chord)
    half_girth = math.sqrt(chord * chord - cap_height * cap_height)
    length = max(0.4 * body.arm_length, cap_height + 0.06 * scale)
    cuff = max(0.92 * half_girth, (body.upper_arm + 0.04 * scale) / 2.0)
    return _Sleeve(cap_height=cap_height, half_girth=half_girth, length=length, cuff=min(cuff, half_girth))


def _sleeve_half(sleeve: _Sleeve, armhole: float) -> tuple[Side, ...]:
    """Left sleeve half; x runs down the arm, y up from the top of the cap, which fits `armhole`."""
    underarm = (sleeve.cap_height, -sleeve.half_girth)

    def cap(handle: float) -> Side:
        reach = handle * sleeve.half_girth
        # Square to the top fold and to the underarm seam, so that the halves meet without a corner.
        controls = ((0.0, -reach), (sleeve.cap_height, reach - sleeve.half_girth))
        return Side(name="cap", start=(0.0, 0.0), end=underarm, controls=controls)

    wanted = (1.0 + CAP_EASE) * armhole
    handle = find_root(lambda h: cap(h).length - wanted, 0.05, 0.95)
    cuff = sleeve.length, -sleeve.cuff
    rest = closed_loop(
        [(underarm, "bottom", (), ""), (cuff, "cuff", (), ""), ((sleeve.length, 0.0), "top", (), "")]
    )
    top = Side(name="top", start=(sleeve.length, 0.0), end=(0.0, 0.0))
    return (cap(handle), *rest[:2], top)


def _sleeve_place(body: Measurements, sleeve: _Sleeve, scale: float) -> Point:
    """World (x, y) of the top of the left cap: along the arm, the underarm seam outside the torso.

    Otherwise the underarm stitches, which run straight from front to back, would start through the chest.
    """
    outward = (math.cos(body.arm_angle), -math.sin(body.arm_angle))
    upward = (math.sin(body.arm_angle), math.cos(body.arm_angle))
    radius = body.upper_arm / (2.0 * math.pi)
    # Half of the width stands above the axis of the arm, half below.
    lift = sleeve.half_girth / 2.0 - radius
    x = body.shoulder_point[0] + lift * upward[0]
    y = body.shoulder_point[1] + lift * upward[1]
    underarm_x = x + sleeve.cap_height * outward[0] - sleeve.half_girth * upward[0]
    # A chest is about 0.19 of its girth wide on each side of the middle.
    missing = 0.19 * body.chest + 0.02 * scale - underarm_x
    shift = 0.01 * scale
    if missing > 0.0:
        shift = min(missing / max(outward[0], 0.1), 0.35 * body.arm_length)
    return x + shift * outward[0], y + shift * outward[1]
