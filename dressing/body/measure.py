"""Body measurements by plane cuts, for standing bodies with the arms away from the trunk."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.avatar_sections import Section, cut, level_cut
from toile.dressing.body.measurements import Measurements
from toile.dressing.body.place import Place
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

BY_HAND = "give the measurements by hand (measurements = FILE)"
"""What to do about a body that cannot be measured."""

STEP = 0.005
"""Distance between neighbouring cuts, in body heights."""

PALM, WRIST = 6, (11, 18)
"""Where the palm begins and the wrist lies: distance from the fingertip along the mesh's edges, in hundredths
of the height (a hand is 0.105 heights long; paths along edges are about a tenth longer)."""

BUST, BUST_BELOW = 0.724, 0.025
"""Level of the bust, and how far it is below the armpit, in body heights: 0.721, 0.724 and 0.727, and 0.0253,
0.0240 and 0.0263, on three mean bodies."""

THIGH = 0.0045
"""How far below the crotch the thigh is measured, in body heights: above, flesh between the thighs counts."""

LOWEST_CROTCH = 0.35
"""Legs that part below this are in a skirt or sit, in body heights: a baby's part at 0.37."""

NECK_BASE_SLOPE = float(np.tan(np.radians(32.0)))
"""Slope of the outline at the base of the neck; shoulders fall at about 20 degrees."""

WIDEST_NECK = 1.7
"""The base of the neck is at most this much wider than its narrowest place, however steep the shoulders."""


@dataclass(frozen=True, kw_only=True)
class MeasuredBody:
    """A body on the floor: positions [m], faces, height [m] and the x of its middle plane [m]."""

    name: str
    vertices: Float
    faces: Int
    height: float
    middle: float

    def error(self, reason: str) -> InputError:
        """Return the error that says why it cannot be measured."""
        return InputError(f"{self.name}: cannot be measured: {reason}; {BY_HAND}", field="avatar")

    def levels(self, low: float, high: float) -> Float:
        """Heights of cuts between two heights [m]."""
        count = max(int(np.ceil((high - low) / (STEP * self.height))), 2)
        return np.linspace(low, high, count + 1)

    def trunk(self, level: float) -> Section | None:
        """Outline at a height that lies on both sides of the middle plane, or None."""
        margin = 0.01 * self.height
        for section in level_cut(self.vertices, self.faces, level):
            wide = section.low[0] < self.middle - margin and section.high[0] > self.middle + margin
            if wide and section.girth > 0.15 * self.height:
                return section
        return None

    def trunk_girth(self, level: float) -> float:
        """Girth of the trunk at a height [m]."""
        section = self.trunk(level)
        return section.girth if section is not None else 0.0


def measure(avatar: Avatar) -> Measurements:
    """Measure a standing body in A- or T-pose, wherever it stands and whichever way it faces.

    Girths are convex (a tape measure bridges hollows), arms and hands left out; of the limbs, the left
    (+X) ones are measured. Raises InputError if the body sits, lies, or holds its arms up or at its sides
    without a gap.
    """
    body = measured_body(avatar)
    height, middle = body.height, body.middle

    crotch = _crotch_level(body)
    armpit, armpit_x = _armpit(body, crotch)
    waist_level, waist = _waist(body, crotch, armpit)
    hip_level, hip = _largest(body, crotch + 0.01 * height, crotch + 0.075 * height)
    chest_level, chest = _chest(body, waist_level, armpit)
    silhouette = _silhouette(body, armpit)
    neck_x, neck_level = _neck_base(body, silhouette)
    shoulder_x = float(np.clip(armpit_x, middle + 1.5 * (neck_x - middle), middle + 0.135 * height))
    shoulder_y = _silhouette_height(silhouette, shoulder_x)
    hips = body.trunk(hip_level)
    hip_edge = float(hips.high[0]) if hips is not None else armpit_x
    arm = _arm(body, crotch, armpit_x, hip_edge, (shoulder_x, shoulder_y))
    shoulder_z = arm.shoulder_z
    return Measurements(
        height=height,
        neck=_neck_girth(body, neck_level),
        chest=chest,
        waist=waist,
        hip=hip,
        upper_arm=arm.upper_arm,
        wrist=arm.wrist,
        thigh=_thigh(body, crotch),
        shoulder_width=2.0 * (shoulder_x - middle),
        neck_width=2.0 * (neck_x - middle),
        arm_length=arm.length,
        inseam=crotch,
        neck_height=neck_level,
        shoulder_height=shoulder_y,
        armpit_height=armpit,
        chest_height=chest_level,
        waist_height=waist_level,
        hip_height=hip_level,
        crotch_height=crotch,
        arm_angle=arm.angle,
        shoulder_point=(shoulder_x, shoulder_y, shoulder_z),
        torso_depth=_torso_depth(body, crotch, armpit, shoulder_x, shoulder_y),
    )


def measured_body(avatar: Avatar) -> MeasuredBody:
    """Return an avatar in its own frame, as one surface. Raises InputError without a trunk."""
    avatar = Place.of(avatar).own(avatar)
    vertices, faces = avatar.solid or (avatar.vertices, avatar.faces)
    vertices = vertices - (0.0, vertices[:, 1].min(), 0.0)
    height = float(vertices[:, 1].max())
    band = vertices[np.abs(vertices[:, 1] - 0.62 * height) < 0.02 * height]
    if not len(band):
        raise InputError(
            f"{avatar.name}: cannot be measured: it has no trunk; {BY_HAND}",
            field="avatar",
        )
    middle = 0.5 * float(band[:, 0].min() + band[:, 0].max())
    return MeasuredBody(name=avatar.name, vertices=vertices, faces=faces, height=height, middle=middle)


def _crotch_level(body: MeasuredBody) -> float:
    """Height where the legs part [m]. Raises InputError if the body does not stand."""
    levels = body.levels(0.25 * body.height, 0.62 * body.height)
    split = [level for level in levels if body.trunk(level) is None]
    if not split:
        raise body.error("its legs do not part (a skirt, or legs fused together)")
    below = max(split)
    above = below + (levels[1] - levels[0])
    for _ in range(8):
        half = 0.5 * (below + above)
        if body.trunk(half) is None:
            below = half
        else:
            above = half
    crotch = float(0.5 * (below + above))
    # Standing legs go down from the hips; sitting thighs go forward.
    hips = body.trunk(crotch + 0.05 * body.height)
    if hips is None or not LOWEST_CROTCH * body.height < crotch < 0.58 * body.height:
        raise body.error(f"its legs part at {crotch / body.height:.0%} of its height, so it does not stand")
    for share in (0.75, 0.5):
        legs = [
            s for s in level_cut(body.vertices, body.faces, share * crotch) if s.girth > 0.1 * body.height
        ]
        depth = [
            abs(leg.centre[2] - hips.centre[2]) for leg in legs if abs(leg.centre[0] - body.middle) < 0.3
        ]
        if not depth or min(depth) > 0.12 * body.height:
            raise body.error("its legs do not go down from the hips, so it does not stand")
    return crotch


def _armpit(body: MeasuredBody, crotch: float) -> tuple[float, float]:
    """Height of the lower armpit and x of the left (+X) one [m]."""
    levels = body.levels(crotch + 0.15 * body.height, crotch + 0.42 * body.height)
    previous: Section | None = None
    jump = 0.02 * body.height
    for level in levels:
        section = body.trunk(level)
        if section is None:
            raise body.error("the trunk ends below the arms")
        if previous is not None:
            out_left = section.high[0] - previous.high[0]
            out_right = previous.low[0] - section.low[0]
            if max(out_left, out_right) > jump:
                half_width = 0.5 * float(previous.high[0] - previous.low[0])
                return float(level - (levels[1] - levels[0])), body.middle + half_width
        previous = section
    raise body.error("no armpit found (arms raised, or fused with the trunk)")


def _largest(body: MeasuredBody, low: float, high: float) -> tuple[float, float]:
    """Level and size of the largest trunk girth between two heights [m]."""
    levels = body.levels(low, max(high, low + 0.01 * body.height))
    girths = [body.trunk_girth(level) for level in levels]
    best = int(np.argmax(girths))
    return float(levels[best]), girths[best]


def _chest(body: MeasuredBody, waist: float, armpit: float) -> tuple[float, float]:
    """Level and girth of the chest: where it is largest below the armpit, or at the usual level of the bust.

    Where the girth grows all the way up to the armpit, it takes in the muscles of the arms.
    """
    low, high = waist + 0.06 * body.height, armpit - 0.004 * body.height
    level, girth = _largest(body, low, high)
    if level < high - 1.5 * STEP * body.height:
        return level, girth
    level = min(high, max(armpit - BUST_BELOW * body.height, BUST * body.height))
    return level, body.trunk_girth(level)


def _waist(body: MeasuredBody, crotch: float, armpit: float) -> tuple[float, float]:
    """Level and size of the smallest trunk girth between hip and chest.

    A belly has no smallest girth there; then the usual level of a waist is taken.
    """
    low, high = crotch + 0.12 * body.height, min(crotch + 0.215 * body.height, armpit - 0.06 * body.height)
    levels = body.levels(low, max(high, low + 0.02 * body.height))
    girths = [body.trunk_girth(level) for level in levels]
    best = int(np.argmin(girths))
    if best in (0, len(levels) - 1):
        best = int(np.argmin(np.abs(levels - (crotch + 0.173 * body.height))))
    return float(levels[best]), girths[best]


def _silhouette(body: MeasuredBody, armpit: float) -> Float:
    """Left half of the front outline above the armpit: (x, y) [m] from the top down, shape (n, 2)."""
    points = []
    for level in body.levels(armpit, 0.93 * body.height)[::-1]:
        section = body.trunk(level)
        if section is not None:
            points.append((float(section.high[0]), float(level)))
    if len(points) < 5:
        raise body.error("it has no neck and shoulders")
    return np.array(points)


def _neck_base(body: MeasuredBody, silhouette: Float) -> tuple[float, float]:
    """X and height of the side of the neck's base: where the outline has turned from neck to shoulder."""
    x, y = silhouette.T
    # Below the narrowest place of the neck, y falls along the neck and x grows along the shoulder: the sum
    # is smallest where the outline falls at the angle below, a little steeper than shoulders do.
    upper = y > 0.78 * body.height
    narrowest = int(np.argmin(np.where(upper, x, np.inf)))
    # An arm in A-pose falls at 45 degrees again: stay near the neck.
    near = (y[narrowest:] > y[narrowest] - 0.055 * body.height) & (
        x[narrowest:] - body.middle < WIDEST_NECK * (x[narrowest] - body.middle)
    )
    best = narrowest + int(np.argmin(np.where(near, NECK_BASE_SLOPE * x[narrowest:] + y[narrowest:], np.inf)))
    return float(x[best]), float(y[best])


def _silhouette_height(silhouette: Float, x: float) -> float:
    """Height of the shoulder line at x [m]."""
    along, level = silhouette.T
    start = int(np.argmin(along[: len(along)]))
    below = np.flatnonzero(along[start:] >= x)
    if not len(below) or below[0] == 0:
        return float(level[-1] if not len(below) else level[start])
    k = start + int(below[0])
    share = (x - along[k - 1]) / (along[k] - along[k - 1])
    return float(level[k - 1] + share * (level[k] - level[k - 1]))


def _neck_girth(body: MeasuredBody, neck_level: float) -> float:
    """Smallest girth just above the neck's base, in planes that fall to the front like a collar."""
    tilt = np.radians(20.0)
    normal = np.array([0.0, np.cos(tilt), np.sin(tilt)])
    base = body.trunk(neck_level + 0.01 * body.height)
    depth = float(base.centre[2]) if base is not None else 0.0
    girths = []
    for level in body.levels(neck_level, neck_level + 0.04 * body.height):
        sections = cut(body.vertices, body.faces, np.array([body.middle, level, depth]), normal)
        around = [
            s.girth
            for s in sections
            if s.low[0] < body.middle < s.high[0] and abs(s.centre[1] - level) < 0.05 * body.height
        ]
        girths += [max(around)] if around else []
    if not girths:
        raise body.error("it has no neck")
    return min(girths)


def _thigh(body: MeasuredBody, crotch: float) -> float:
    """Largest girth of the left thigh just below the crotch [m]."""
    girths = [
        section.girth
        for level in body.levels(crotch - 0.03 * body.height, crotch - THIGH * body.height)
        for section in level_cut(body.vertices, body.faces, level)
        if body.middle - 0.01 < section.centre[0] < body.middle + 0.14 * body.height
    ]
    if not girths:
        raise body.error("it has no left thigh")
    return max(girths)


@dataclass(frozen=True, kw_only=True)
class _Arm:
    """Arm measurements: lengths and girths [m], angle below the horizontal [rad], z of the shoulder [m]."""

    length: float
    wrist: float
    upper_arm: float
    angle: float
    shoulder_z: float


def _arm(
    body: MeasuredBody, crotch: float, armpit_x: float, hip_edge: float, shoulder: tuple[float, float]
) -> _Arm:
    """Follow the left arm from the fingertip to the shoulder by distance along the surface."""
    distance = _surface_distance(body, int(np.argmax(body.vertices[:, 1])))
    # Beside hips and thighs there are only hands, whatever the angle of the arms.
    beside = max(armpit_x, hip_edge)
    for level in np.linspace(crotch - 0.16 * body.height, crotch - 0.01 * body.height, 6):
        left = [s for s in level_cut(body.vertices, body.faces, level) if s.centre[0] > body.middle]
        beside = max(beside, float(left[0].high[0]) if left else beside)
    beside += 0.005 * body.height
    hand = (body.vertices[:, 0] > beside) & (body.vertices[:, 1] > crotch - 0.16 * body.height)
    outward = np.where(hand, distance, -np.inf)
    tip = int(np.argmax(outward))
    if not np.isfinite(outward[tip]) or body.vertices[tip, 0] < armpit_x + 0.02 * body.height:
        raise body.error("no left arm found beside the trunk")
    from_tip = _surface_distance(body, tip)
    # Centres of rings at equal distance from the fingertip, 0.01 heights apart, from the palm up.
    ring_step = 0.01 * body.height
    path = []
    for k in range(PALM, 60):
        ring = np.abs(from_tip - k * ring_step) < ring_step
        points = body.vertices[ring & (body.vertices[:, 0] > body.middle)]
        # Where a ring reaches the armpit, the arm ends.
        if len(points) < 4 or points[:, 0].min() < armpit_x + 0.01 * body.height:
            break
        path.append(0.5 * (points.min(axis=0) + points.max(axis=0)))
    if len(path) < 20:
        raise body.error("the left arm is not free of the trunk")
    centres = np.array(path)

    girths = np.array([_limb_girth(body, centres, k) for k in range(len(centres))])
    wrist = WRIST[0] - PALM + int(np.argmin(girths[WRIST[0] - PALM : WRIST[1] - PALM]))
    upper = girths[wrist + 14 :]
    near_shoulder = upper[np.isfinite(upper)]
    if not len(near_shoulder):
        raise body.error("the left arm is too short")
    top = centres[-1]
    along = centres[wrist] - top
    start = np.array([shoulder[0], shoulder[1], top[2]])
    elbow = centres[(wrist + len(centres) - 1) // 2]
    return _Arm(
        length=float(np.linalg.norm(centres[wrist] - elbow) + np.linalg.norm(elbow - start)),
        wrist=float(girths[wrist]),
        upper_arm=float(near_shoulder.max()),
        angle=float(np.arctan2(-along[1], along[0])),
        shoulder_z=float(top[2]),
    )


def _limb_girth(body: MeasuredBody, centres: Float, k: int) -> float:
    """Girth across a limb at its centre line's point k [m]; infinite where the cut takes in the trunk."""
    low, high = max(k - 2, 0), min(k + 2, len(centres) - 1)
    normal = centres[high] - centres[low]
    normal = normal / np.linalg.norm(normal)
    sections = cut(body.vertices, body.faces, centres[k], normal)
    if not sections:
        return float("inf")
    nearest = min(sections, key=lambda s: float(np.linalg.norm(s.centre - centres[k])))
    return nearest.girth if nearest.girth < 0.35 * body.height else float("inf")


def _surface_distance(body: MeasuredBody, source: int) -> Float:
    """Distance from one vertex along the edges of the mesh [m], shape (v,)."""
    a, b = body.faces.ravel(), body.faces[:, [1, 2, 0]].ravel()
    lengths = np.linalg.norm(body.vertices[a] - body.vertices[b], axis=1)
    # Minimum, not sum, where both faces of an edge list it: each direction occurs once.
    graph = coo_matrix((lengths, (a, b)), shape=(len(body.vertices),) * 2).tocsr()
    return np.asarray(dijkstra(graph, directed=True, indices=np.array([source]))[0])


def _torso_depth(
    body: MeasuredBody, crotch: float, armpit: float, shoulder_x: float, shoulder_y: float
) -> tuple[float, float]:
    """Smallest and largest z of the trunk between crotch and shoulder [m]."""
    lows, highs = [], []
    for level in body.levels(crotch + 0.005 * body.height, armpit):
        section = body.trunk(level)
        if section is not None:
            lows.append(float(section.low[2]))
            highs.append(float(section.high[2]))
    x, y, z = body.vertices.T
    chest = (y > armpit) & (y < shoulder_y) & (np.abs(x - body.middle) < shoulder_x - body.middle)
    if chest.any():
        lows.append(float(z[chest].min()))
        highs.append(float(z[chest].max()))
    return min(lows), max(highs)
