"""Measurements beyond those that the built-in drafts need: arcs, lengths over the surface, knee and ankle."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.avatar_sections import Section, cut, level_cut
from toile.dressing.body.measure import MeasuredBody, measured_body
from toile.dressing.body.measurements import Measurements
from toile.geometry.arrays import Float

HIP_BONE = 0.4
"""Where the hip bones lie on the way from the waist down to the hip."""
KNEE = 0.6
"""Level of the knee, in heights of the crotch, as trousers are drafted."""
ANKLES = 0.03, 0.10
"""Levels between which the ankle is narrowest, in body heights."""
UNDERBUST = 0.35, 0.6
"""Where the ribs are narrowest on the way from the bust down to the waist: 0.57, 0.60 and 0.52 on three mean
bodies."""
HEEL_RISES = np.linspace(45.0, 60.0, 4)
"""How steeply a tape from the heel to the instep may rise [degrees]."""
INSIDE = np.array([0.0, 0.003, 0.003])
"""From the corner of the heel into the foot [m]: a cut through a corner may miss it."""
BUST_POINTS = 0.03, 0.075
"""Between which distances from the middle a bust point lies, in body heights."""
HEAD = 0.88
"""Level above which the head is widest, in body heights."""


@dataclass(frozen=True, kw_only=True)
class TailorMeasurements:
    """Lengths and heights above the floor [m], the angle in radians; all are those of a taut tape.

    Attributes
    ----------
    hip_bone, knee, ankle, heel, head, high_bust, underbust
        Circumferences; high_bust just below the armpit, heel over heel and instep.
    hip_bone_height, knee_height, ankle_height
        Levels above the floor.
    bust_span
        Between the bust points.
    chest_back, waist_back, hip_back
        From side to side over the back, at chest, waist and hip.
    neck_to_waist_front, neck_to_waist_back, neck_to_bust
        From the side of the neck's base over bust and back.
    crotch_seam, crotch_seam_front
        From the waist in front between the legs to the waist behind, and its part in front.
    shoulder_slope
        Fall of the shoulders from the neck [rad].
    """

    hip_bone: float
    knee: float
    ankle: float
    heel: float
    head: float
    high_bust: float
    underbust: float
    hip_bone_height: float
    knee_height: float
    ankle_height: float
    bust_span: float
    chest_back: float
    waist_back: float
    hip_back: float
    neck_to_waist_front: float
    neck_to_waist_back: float
    neck_to_bust: float
    crotch_seam: float
    crotch_seam_front: float
    shoulder_slope: float


def tailor_measurements(avatar: Avatar, measured: Measurements) -> TailorMeasurements:
    """Measure what tailors need on a body whose measurements are known. Raises InputError without a trunk."""
    body, height = measured_body(avatar), measured.height
    hip_bone = measured.waist_height - HIP_BONE * (measured.waist_height - measured.hip_height)
    knee = KNEE * measured.crotch_height
    ankles = body.levels(ANKLES[0] * height, ANKLES[1] * height)
    ankle = min(ankles.tolist(), key=lambda level: _leg(body, level))
    chest, waist = measured.chest_height, measured.waist_height
    lowest, highest = (chest - share * (chest - waist) for share in reversed(UNDERBUST))
    ribs = body.levels(lowest, highest)
    neck = 0.5 * measured.neck_width
    bust = _bust_point(body, measured.chest_height)
    front, back = (
        _over(body, neck, measured.neck_height, measured.waist_height, sign) for sign in (1.0, -1.0)
    )
    crotch, crotch_front = _crotch(body, measured.waist_height)
    return TailorMeasurements(
        hip_bone=body.trunk_girth(hip_bone),
        knee=_leg(body, knee),
        ankle=_leg(body, ankle),
        heel=_heel(body, ankle),
        head=max(body.trunk_girth(level) for level in body.levels(HEAD * height, 0.985 * height)),
        high_bust=body.trunk_girth(measured.armpit_height - 0.004 * height),
        underbust=min(body.trunk_girth(level) for level in ribs),
        hip_bone_height=hip_bone,
        knee_height=knee,
        ankle_height=ankle,
        bust_span=2.0 * bust,
        chest_back=_back_arc(body, measured.chest_height),
        waist_back=_back_arc(body, measured.waist_height),
        hip_back=_back_arc(body, measured.hip_height),
        neck_to_waist_front=front,
        neck_to_waist_back=back,
        neck_to_bust=_over(body, neck, measured.neck_height, measured.chest_height, 1.0),
        crotch_seam=crotch,
        crotch_seam_front=crotch_front,
        shoulder_slope=float(
            np.arctan2(
                measured.neck_height - measured.shoulder_height,
                0.5 * (measured.shoulder_width - measured.neck_width),
            )
        ),
    )


def _leg(body: MeasuredBody, level: float) -> float:
    """Girth of the left leg at a height [m]; infinite where there is none."""
    girths = [
        section.girth for section in level_cut(body.vertices, body.faces, level) if _is_left(body, section)
    ]
    return max(girths, default=float("inf"))


def _heel(body: MeasuredBody, ankle: float) -> float:
    """Girth of the left foot over the heel and the instep: the shortest around the heel, infinite without."""
    foot = body.vertices[(body.vertices[:, 1] < ankle) & (body.vertices[:, 0] > body.middle)]
    if not len(foot):
        return float("inf")
    # The corner of the heel: farthest down and back.
    back = foot[int((foot[:, 1] + foot[:, 2]).argmin())]
    girths = [
        section.girth
        for rise in np.radians(HEEL_RISES)
        for section in cut(
            body.vertices, body.faces, back + INSIDE, np.array([0.0, np.cos(rise), -np.sin(rise)])
        )
        if _is_left(body, section)
    ]
    return min(girths, default=float("inf"))


def _is_left(body: MeasuredBody, section: Section) -> bool:
    """Whether an outline is one of a left limb, and no crumb."""
    return bool(section.centre[0] > body.middle and section.girth > 0.05 * body.height)


def _hull(points: Float) -> Float:
    """Corners of the convex hull of points (n, 2), counter-clockwise; the points where it has no area."""
    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except (QhullError, ValueError):
        return points


def _chain(hull: Float, start: int, end: int) -> float:
    """Length of a hull counter-clockwise from one corner to another [m]."""
    around = np.roll(hull, -start, axis=0)[: (end - start) % len(hull) + 1]
    return float(np.linalg.norm(np.diff(around, axis=0), axis=1).sum())


def _back_arc(body: MeasuredBody, level: float) -> float:
    """Length of a tape from side to side over the back at a height [m]."""
    section = body.trunk(level)
    if section is None:
        return 0.0
    # Counter-clockwise in (x, -z) the back runs from the left side to the right.
    hull = _hull(section.points[:, [0, 2]] * (1.0, -1.0))
    return _chain(hull, int(hull[:, 0].argmax()), int(hull[:, 0].argmin()))


def _bust_point(body: MeasuredBody, level: float) -> float:
    """Distance of a bust point from the middle [m]: where the body stands out farthest beside it."""
    section = body.trunk(level)
    if section is None:
        return 0.0
    x = np.abs(section.points[:, 0] - body.middle)
    beside = (x > BUST_POINTS[0] * body.height) & (x < BUST_POINTS[1] * body.height)
    if not beside.any():
        return BUST_POINTS[0] * body.height
    return float(x[beside][section.points[beside, 2].argmax()])


def _upright(body: MeasuredBody, x: float) -> Section | None:
    """Largest outline of the cut that stands upright at a distance to the left of the middle [m]."""
    point = np.array([body.middle + x, 0.0, 0.0])
    sections = cut(body.vertices, body.faces, point, np.array([1.0, 0.0, 0.0]))
    return sections[0] if sections else None


def _over(body: MeasuredBody, x: float, high: float, low: float, sign: float) -> float:
    """Length of a tape from the neck's side down to a level, in front (1) or behind (-1) [m]."""
    section = _upright(body, x)
    if section is None:
        return 0.0
    y, z = section.points[:, 1], sign * section.points[:, 2]
    between = (y > low) & (y < high)
    if between.sum() < 3:
        return high - low
    inside = 0.5 * float(z[between].min() + z[between].max())
    top = np.array([[inside, high], [inside, low]])
    outer = np.column_stack([z, y])[between & (z > inside)]
    if len(outer) < 3:
        return high - low
    begin = outer[outer[:, 1].argmax()]
    hull = _hull(np.concatenate([outer, top]))
    # Counter-clockwise in (outwards, up) the outer side runs from below upwards.
    end = int(np.linalg.norm(hull - begin, axis=1).argmin())
    start = int((hull[:, 0] - hull[:, 1]).argmax())
    return _chain(hull, start, end) + float(high - hull[end, 1] + hull[start, 1] - low)


def _crotch(body: MeasuredBody, waist: float) -> tuple[float, float]:
    """Length of a tape from the waist between the legs to the waist behind, and its front part [m]."""
    section = _upright(body, 0.0)
    if section is None:
        return 0.0, 0.0
    points = section.points[section.points[:, 1] < waist][:, [2, 1]]
    if len(points) < 3:
        return 0.0, 0.0
    hull = _hull(points)
    top = hull[hull[:, 1] > waist - 0.03 * body.height]
    front, behind = (
        int(np.linalg.norm(hull - corner, axis=1).argmin())
        for corner in (top[top[:, 0].argmax()], top[top[:, 0].argmin()])
    )
    lowest = int(hull[:, 1].argmin())
    # Counter-clockwise in (ahead, up) the tape runs from behind below the body to the front.
    ahead = _chain(hull, lowest, front) + float(waist - hull[front, 1])
    return _chain(hull, behind, lowest) + float(waist - hull[behind, 1]) + ahead, ahead
