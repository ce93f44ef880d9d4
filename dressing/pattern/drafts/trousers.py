"""Straight trousers: front and back of each leg with waist darts, on a waistband."""

import math
from dataclasses import dataclass

from toile.dressing.body.measurements import Measurements
from toile.dressing.pattern.drafts.drafting import (
    DRAFT_HEIGHT,
    Draft,
    Side,
    find_root,
    mirrored_seams,
    require_levels,
    sew,
    waist_notes,
)
from toile.dressing.pattern.drafts.waistband import band_sides
from toile.dressing.pattern.pattern import Pattern, Point

WAIST_EASE = 0.015
"""Girth of the waistband beyond the waist [m], for a body 1.70 m tall."""
HIP_EASE = 0.06
"""Girth of the trousers at the hip beyond that of the body [m]."""
THIGH_EASE = 0.05
"""Least girth of a leg at the crotch beyond the thigh [m]."""
CROTCH_EASE = 0.02
"""How far the crotch of the trousers lies below that of the body [m]."""
BAND_HEIGHT = 0.035
"""Height of the waistband [m]."""

_BACK_SHARE = 0.01
"""The back is this much wider, the front this much narrower than a quarter of the hip [m]."""
_SMALLEST_DART = 0.008
"""A dart narrower than this [m] is left to the side seam."""


@dataclass(frozen=True, kw_only=True)
class _Levels:
    """Heights above the floor [m]."""

    waist: float
    hip: float
    crotch: float
    knee: float
    hem: float


@dataclass(frozen=True, kw_only=True)
class _Part:
    """Front or back of the left leg: what the draft is made from [m].

    `hip` is the width at the hip, `extension` that of the crotch beyond it; `slant` the shift of the centre
    seam at the waist towards the side, `side` that of the side seam towards the centre, `dart` the width of
    the dart; `raised` the height of the centre above the side at the waist; `knee` and `hem` the widths of
    the leg there.
    """

    hip: float
    extension: float
    slant: float
    side: float
    dart: float
    raised: float
    dart_length: float
    knee: float
    hem: float


def draft_trousers(body: Measurements) -> Pattern:
    """Return straight trousers that reach the ankle.

    Ease (for a body 1.70 m tall, in proportion to the height for others): waistband + 1.5 cm; hip + 6 cm; leg
    at the crotch at least thigh + 5 cm; crotch 2 cm below that of the body. The crotch extends by hip/16 in
    front and hip/8 behind (more where the thigh asks for it): with hip/20 and hip/10 the crotch seam came out
    1 to 3 cm shorter than the way from waist to waist on four of five bodies, now it is 2 to 8 cm longer.
    What the hip is wider than the waist goes into side seams, centre seams and one dart per panel. The knee
    is 0.78, the hem 0.70 of the thigh.

    Raises
    ------
    InputError
        If the measurements are not those of an upright body.
    """
    require_levels("trousers", body, ("crotch_height", "hip_height", "waist_height"))
    scale = body.height / DRAFT_HEIGHT
    band_height = BAND_HEIGHT * scale
    waist_girth = body.waist + WAIST_EASE * scale
    crotch = body.crotch_height - CROTCH_EASE * scale
    levels = _Levels(
        waist=body.waist_height - band_height / 2.0,
        # Some bodies are widest right at the crotch; the draft needs room for the crotch curve above it.
        hip=max(body.hip_height, crotch + 0.05 * scale),
        crotch=crotch,
        knee=0.6 * body.crotch_height,
        hem=0.055 * body.height,
    )
    front_part, back_part = _parts(body, scale, waist_girth)
    front_sides = _leg(front_part, levels, levels.crotch)
    inseam = _side(front_sides, "inseam").length
    # The back inseam starts farther in, and lower by as much as makes the two equally long.
    lowest = levels.crotch - 0.06 * scale
    back_crotch = find_root(
        lambda y: _side(_leg(back_part, levels, y), "inseam").length - inseam, lowest, levels.crotch
    )
    back_sides = _leg(back_part, levels, back_crotch)

    z_back, z_front = body.torso_depth
    gap = 0.02 * scale
    # Beside the other leg's panel, not across it; and the legs hang below the band that holds them.
    front = Draft(
        name="left_front",
        sides=front_sides,
        translation=(front_part.extension + gap / 2.0, -gap, z_front + 2.0 * gap),
        label="leg",
        role="leg",
    )
    back = Draft(
        name="left_back",
        sides=back_sides,
        translation=(back_part.extension + gap / 2.0, -gap, z_back - 2.0 * gap),
        label="leg",
        role="leg",
    ).turned()
    bands = [
        Draft(
            name="front_waistband",
            sides=band_sides(_waist_pieces(front_sides), band_height),
            translation=(0.0, levels.waist, z_front + gap),
            label="body",
            role="torso",
        ),
        Draft(
            name="back_waistband",
            sides=band_sides(_waist_pieces(back_sides), band_height),
            translation=(0.0, levels.waist, z_back - gap),
            label="body",
            role="torso",
        ).turned(),
    ]
    drafts = [*bands, front, back, front.mirrored(), back.mirrored()]
    return sew("trousers", drafts, _seams(front, back), waist_notes(body))


def _seams(front: Draft, back: Draft) -> list[tuple[str, str, str, str]]:
    """Return all seams, those of the left leg first."""
    half = [("front_waistband", "left_end", "back_waistband", "left_end")]
    for draft in (front, back):
        band = draft.name.replace("left_", "") + "_waistband"
        count = len(_waist_pieces(draft.sides))
        half += [(draft.name, f"waist_{i}", band, f"left_lower_{i}") for i in range(count)]
        if count == 2:
            half.append((draft.name, "dart_centre", draft.name, "dart_side"))
    half += [
        ("left_front", name, "left_back", name)
        for name in ("upper_outseam", "outseam", "inseam", "lower_inseam")
    ]
    middle = [
        (f"left_{part}", name, f"right_{part}", name)
        for part in ("front", "back")
        for name in ("centre", "crotch")
    ]
    return half + mirrored_seams(half) + middle


def _parts(body: Measurements, scale: float, waist_girth: float) -> tuple[_Part, _Part]:
    """Front and back of a leg."""
    quarter = (body.hip + HIP_EASE * scale) / 4.0
    front_extension, back_extension = body.hip / 16.0, body.hip / 8.0
    missing = body.thigh + THIGH_EASE * scale - (2.0 * quarter + front_extension + back_extension)
    if missing > 0.0:
        front_extension += missing / 3.0
        back_extension += 2.0 * missing / 3.0
    share = _BACK_SHARE * scale
    suppression = quarter - waist_girth / 4.0
    knee, hem = 0.78 * body.thigh / 2.0, 0.70 * body.thigh / 2.0

    def part(*, back: bool) -> _Part:
        sign = 1.0 if back else -1.0
        longest = (0.035 if back else 0.012) * scale
        slant = min(max(0.3 * suppression, 0.005 * scale if back else 0.0), longest)
        # Not more than 3 cm at the side, or the seam stands out from the hip.
        side = min(0.4 * suppression, 0.03 * scale)
        hip, raised = quarter + sign * share, 0.03 * scale if back else 0.0
        sewn = waist_girth / 4.0 + sign * share
        dart = math.hypot(hip - slant - side, raised) - sewn
        if dart < _SMALLEST_DART * scale:
            side, dart = hip - slant - math.sqrt(sewn * sewn - raised * raised), 0.0
        return _Part(
            hip=hip,
            extension=back_extension if back else front_extension,
            slant=slant,
            side=side,
            dart=dart,
            raised=raised,
            dart_length=min((0.11 if back else 0.08) * scale, 0.7 * (body.waist_height - body.hip_height)),
            knee=knee + sign * share,
            hem=hem + sign * share,
        )

    return part(back=False), part(back=True)


def _leg(part: _Part, levels: _Levels, crotch: float) -> tuple[Side, ...]:
    """Left leg, counter-clockwise from the hem; x = 0 is the centre seam at the hip, the side at x = hip."""
    point = (-part.extension, crotch)
    crease = (part.hip - part.extension) / 2.0
    hem_in, hem_out = (crease - part.hem / 2.0, levels.hem), (crease + part.hem / 2.0, levels.hem)
    knee_in, knee_out = (crease - part.knee / 2.0, levels.knee), (crease + part.knee / 2.0, levels.knee)
    hip, waist_side = (part.hip, levels.hip), (part.hip - part.side, levels.waist)
    centre, waist_centre = (0.0, levels.hip), (part.slant, levels.waist + part.raised)
    third = (levels.waist - levels.hip) / 3.0
    # The crotch curve leaves along the centre seam and arrives level.
    fall = 0.55 * (levels.hip - crotch)
    crotch_controls = (
        (-fall * part.slant / (waist_centre[1] - levels.hip), levels.hip - fall),
        (0.25 * point[0], crotch),
    )
    thigh = levels.hip - levels.knee
    outseam_controls = (knee_out, (part.hip, levels.hip - 0.5 * thigh))
    inseam_control = (point[0] + 0.8 * (knee_in[0] - point[0]), crotch - 0.4 * (crotch - levels.knee))
    return (
        Side(name="hem", start=hem_in, end=hem_out),
        Side(name="outseam", start=hem_out, end=hip, controls=outseam_controls),
        Side(
            name="upper_outseam",
            start=hip,
            end=waist_side,
            controls=(
                (part.hip, levels.hip + third),
                (waist_side[0] + 0.3 * part.side, levels.waist - third),
            ),
        ),
        *_waist(part, waist_side, waist_centre),
        Side(name="centre", start=waist_centre, end=centre),
        Side(name="crotch", start=centre, end=point, controls=crotch_controls),
        Side(name="inseam", start=point, end=knee_in, controls=(inseam_control,)),
        Side(name="lower_inseam", start=knee_in, end=hem_in),
    )


def _waist(part: _Part, side: Point, centre: Point) -> tuple[Side, ...]:
    """Waist edge from the side to the centre, with a dart in its middle if the part has one."""
    if part.dart == 0.0:
        return (Side(name="waist_0", start=side, end=centre),)
    length = math.dist(side, centre)
    along = ((centre[0] - side[0]) / length, (centre[1] - side[1]) / length)

    def at(distance: float, below: float) -> Point:
        return side[0] + distance * along[0] - below * along[1], side[1] + distance * along[
            1
        ] + below * along[0]

    before, after = at((length - part.dart) / 2.0, 0.0), at((length + part.dart) / 2.0, 0.0)
    tip = at(length / 2.0, part.dart_length)
    return (
        Side(name="waist_1", start=side, end=before),
        Side(name="dart_side", start=before, end=tip),
        Side(name="dart_centre", start=tip, end=after),
        Side(name="waist_0", start=after, end=centre),
    )


def _side(sides: tuple[Side, ...], name: str) -> Side:
    """Return the side of that name."""
    return next(side for side in sides if side.name == name)


def _waist_pieces(sides: tuple[Side, ...]) -> tuple[float, ...]:
    """Lengths of the waist edge [m] from the middle outwards, darts left out."""
    pieces = sorted((side for side in sides if side.name.startswith("waist_")), key=lambda side: side.name)
    return tuple(side.length for side in pieces)
