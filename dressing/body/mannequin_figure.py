"""The mannequin's shape as a smooth signed distance: lofted trunk, head, arms, legs and feet, blended.

All lengths here are fractions of the body height; y is the height above the floor, the figure faces +z
and is mirrored in x. Tables give cross-sections that were drafted for this project after the usual
proportions of adult figures; a loft interpolates them and a smooth minimum blends the parts.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from toile.geometry.arrays import Float

# level y, half width, back z, front z, superellipse exponent
TRUNK = np.array(
    [
        (0.455, 0.098, -0.068, 0.050, 2.2),
        (0.480, 0.108, -0.078, 0.056, 2.2),
        (0.505, 0.113, -0.082, 0.061, 2.2),
        (0.530, 0.110, -0.079, 0.066, 2.2),
        (0.560, 0.101, -0.068, 0.068, 2.2),
        (0.595, 0.091, -0.055, 0.066, 2.2),
        (0.632, 0.084, -0.048, 0.064, 2.2),
        (0.658, 0.087, -0.052, 0.067, 2.2),
        (0.682, 0.093, -0.058, 0.075, 2.2),
        (0.708, 0.098, -0.062, 0.081, 2.3),
        (0.740, 0.101, -0.065, 0.072, 2.3),
        (0.770, 0.105, -0.064, 0.058, 2.3),
        (0.790, 0.105, -0.060, 0.045, 2.3),
        (0.805, 0.098, -0.055, 0.036, 2.2),
        (0.818, 0.080, -0.049, 0.031, 2.1),
        (0.830, 0.058, -0.043, 0.029, 2.0),
        (0.843, 0.043, -0.039, 0.031, 2.0),
        (0.860, 0.036, -0.034, 0.036, 2.0),
        (0.885, 0.034, -0.029, 0.041, 2.0),
        (0.915, 0.034, -0.026, 0.044, 2.0),
    ]
)
# level y, centre x, half width, back z, front z
LEG = np.array(
    [
        (0.030, 0.0850, 0.0190, -0.046, 0.004),
        (0.060, 0.0835, 0.0175, -0.044, 0.002),
        (0.090, 0.0820, 0.0180, -0.042, 0.002),
        (0.130, 0.0800, 0.0235, -0.047, 0.004),
        (0.170, 0.0780, 0.0300, -0.053, 0.007),
        (0.210, 0.0760, 0.0330, -0.055, 0.010),
        (0.245, 0.0740, 0.0325, -0.050, 0.014),
        (0.280, 0.0715, 0.0330, -0.043, 0.024),
        (0.320, 0.0690, 0.0365, -0.042, 0.034),
        (0.370, 0.0660, 0.0430, -0.046, 0.044),
        (0.420, 0.0630, 0.0485, -0.051, 0.052),
        (0.460, 0.0610, 0.0510, -0.059, 0.055),
        (0.500, 0.0570, 0.0480, -0.062, 0.054),
        (0.540, 0.0520, 0.0350, -0.045, 0.040),
    ]
)
# distance from the shoulder joint along the arm, half thickness in the arm's plane, half width in z, centre z
ARM = np.array(
    [
        (-0.060, 0.0070, 0.0150, -0.006),
        (-0.040, 0.0130, 0.0220, -0.006),
        (-0.020, 0.0210, 0.0290, -0.006),
        (0.000, 0.0275, 0.0335, -0.006),
        (0.020, 0.0310, 0.0350, -0.006),
        (0.045, 0.0315, 0.0345, -0.006),
        (0.085, 0.0285, 0.0310, -0.006),
        (0.130, 0.0260, 0.0280, -0.006),
        (0.165, 0.0240, 0.0250, -0.006),
        (0.200, 0.0240, 0.0250, -0.003),
        (0.255, 0.0195, 0.0200, 0.002),
        (0.305, 0.0145, 0.0180, 0.006),
        (0.330, 0.0140, 0.0205, 0.008),
        (0.355, 0.0140, 0.0245, 0.010),
        (0.380, 0.0120, 0.0240, 0.010),
        (0.398, 0.0105, 0.0205, 0.010),
        (0.408, 0.0090, 0.0165, 0.010),
        (0.415, 0.0075, 0.0115, 0.010),
    ]
)
# distance from the ankle along the foot, half width, top y
FOOT = np.array(
    [
        (-0.048, 0.0130, 0.024),
        (-0.042, 0.0175, 0.038),
        (-0.025, 0.0205, 0.050),
        (0.000, 0.0220, 0.052),
        (0.030, 0.0260, 0.042),
        (0.060, 0.0300, 0.030),
        (0.080, 0.0290, 0.022),
        (0.090, 0.0240, 0.019),
        (0.097, 0.0160, 0.016),
    ]
)
CRANIUM = ((0.0, 0.934, 0.014), (0.0475, 0.066, 0.060))
"""Centre and half axes of the skull."""
JAW = ((0.0, 0.902, 0.033), (0.034, 0.034, 0.042))
"""Centre and half axes of the lower face."""
SHOULDER = (0.106, 0.777)
"""Shoulder joint: x, y."""
ARM_ANGLE = np.pi / 4.0
"""Arms hang this far below the horizontal [rad]."""
THUMB = ((0.322, 0.016), (0.362, 0.042), 0.0085)
"""Thumb: (along the arm, z) of root and tip, and its radius."""
TOE_OUT = np.radians(9.0)
"""Feet point outward by this angle [rad]."""
FOOT_ROUNDING, HAND_ROUNDING = 0.007, 0.005
"""Radii of the edges of soles, toes and fingertips: sharper ones would be meshed by slivers."""
CROTCH = 0.463
"""Level at which the trunk ends between the legs."""
LEG_GAP = 1.19
"""Smallest distance of the leg's centre from the middle, in half widths of the thigh."""

CHEST_LEVELS = (0.690, 0.700, 0.709, 0.717)
"""Levels among which the chest is largest."""
WAIST_LEVELS = (0.622, 0.632, 0.642)
"""Levels among which the waist is smallest."""
HIP_LEVELS = (0.475, 0.490, 0.505, 0.520, 0.535)
"""Levels among which the hip is largest."""


@dataclass(frozen=True, kw_only=True)
class Build:
    """Factors on the cross-sections at chest, waist and hip level; 1 is the drafted figure."""

    chest: float = 1.0
    waist: float = 1.0
    hip: float = 1.0


def figure_distance(points: Float, build: Build) -> Float:
    """Signed distance (approximate, negative inside) of points (n, 3) from the figure, shape (n,)."""
    x, y, z = np.abs(points[:, 0]), points[:, 1], points[:, 2]
    body = _trunk(x, y, z, build)
    body = _smooth_min(body, _leg(x, y, z, build), 0.020)
    body = _smooth_min(body, _foot(x, y, z, build), 0.020)
    body = _smooth_min(body, _arm(x, y, z, build), 0.030)
    head = _smooth_min(_ellipsoid(x, y, z, *CRANIUM), _ellipsoid(x, y, z, *JAW), 0.020)
    return _smooth_min(body, head, 0.014)


def trunk_factor(levels: Float, build: Build) -> Float:
    """Factor on the trunk's cross-sections at heights `levels`, shape (n,)."""
    knots = [0.45, 0.505, 0.632, 0.708, 0.79, 0.845, 0.92]
    neck = 1.0 + 0.25 * (build.chest - 1.0)
    # Shoulders follow a large chest more than a small one: narrow ones would fall too steeply.
    shoulder = 1.0 + (0.7 if build.chest > 1.0 else 0.4) * (build.chest - 1.0)
    factors = [build.hip, build.hip, build.waist, build.chest, shoulder, neck, neck]
    return np.asarray(PchipInterpolator(knots, factors)(np.clip(levels, knots[0], knots[-1])))


def _smooth_min(a: Float, b: Float, width: float) -> Float:
    """Minimum with a quadratic blend where the arguments differ by less than `width`."""
    overlap = np.maximum(width - np.abs(a - b), 0.0)
    return np.minimum(a, b) - overlap * overlap / (4.0 * width)


def _section_distance(u: Float, v: Float, half_u: Float, half_v: Float, exponent: Float | float) -> Float:
    """Distance along the ray from the centre to the superellipse with the given half axes."""
    radius = np.hypot(u, v) + 1e-12
    rho = ((np.abs(u) / half_u) ** exponent + (np.abs(v) / half_v) ** exponent) ** (1.0 / exponent) + 1e-12
    return np.where(rho > 1e-6, radius - radius / rho, -np.minimum(half_u, half_v))


def _lofted(radial: Float, radial_above: Float, beyond: Float, step: float) -> Float:
    """Distance from a loft: the in-section distance, divided by the slope of the surface along the loft."""
    slope = (radial_above - radial) / step
    distance = radial / np.sqrt(1.0 + slope * slope)
    # Past the ends of the loft the distance to its end face adds up.
    return np.where(beyond > 0.0, np.hypot(np.maximum(radial, 0.0), beyond), distance)


def _trunk(x: Float, y: Float, z: Float, build: Build) -> Float:
    """Trunk and neck."""
    profile = PchipInterpolator(TRUNK[:, 0], TRUNK[:, 1:])
    low, high = TRUNK[0, 0], TRUNK[-1, 0]

    def radial(level: Float) -> Float:
        # Contiguous, because numpy 1.26 takes powers of strided arrays in one of two ways, depending on
        # where memory lies: last digits would differ from run to run.
        width, back, front, exponent = np.ascontiguousarray(profile(level).T)
        factor = trunk_factor(level, build)
        # The widest place of the trunk lies a little behind the middle of its depth.
        centre = 0.55 * back + 0.45 * front
        depth = np.where(z > centre, front - centre, centre - back) * factor
        return _section_distance(x, z - centre, width * factor, depth, exponent)

    step = 1e-3
    level = np.clip(y, low, high - step)
    beyond = np.maximum(y - high, 0.0)
    distance = _lofted(radial(level), radial(level + step), beyond, step)
    return -_smooth_min(-distance, y - CROTCH, 0.030)


def _leg_spread(build: Build) -> float:
    """Return how far the legs stand further apart, so that heavy thighs keep their gap."""
    thigh_half_width = 0.051 * build.hip
    return max(LEG_GAP * thigh_half_width - 0.061, 0.0)


def _leg(x: Float, y: Float, z: Float, build: Build) -> Float:
    """Leg from the hip joint to the ankle."""
    profile = PchipInterpolator(LEG[:, 0], LEG[:, 1:])
    low, high = LEG[0, 0], LEG[-1, 0]
    spread = _leg_spread(build)

    def radial(level: Float) -> Float:
        centre_x, width, back, front = profile(level).T
        share = np.clip((level - 0.05) / 0.40, 0.0, 1.0)
        factor = 1.0 + (build.hip - 1.0) * (0.35 + 0.65 * share)
        centre = 0.5 * (back + front)
        depth = 0.5 * (front - back) * factor
        return _section_distance(x - centre_x - spread, z - centre, width * factor, depth, 2.1)

    step = 1e-3
    level = np.clip(y, low, high - step)
    beyond = np.maximum(np.maximum(low - y, y - high), 0.0)
    return _lofted(radial(level), radial(level + step), beyond, step)


def _foot(x: Float, y: Float, z: Float, build: Build) -> Float:
    """Foot, flat on the floor."""
    profile = PchipInterpolator(FOOT[:, 0], FOOT[:, 1:])
    sine, cosine = np.sin(TOE_OUT), np.cos(TOE_OUT)
    ankle_x, ankle_z = LEG[0, 1] + _leg_spread(build), -0.010
    along = (x - ankle_x) * sine + (z - ankle_z) * cosine
    across = (x - ankle_x) * cosine - (z - ankle_z) * sine
    low, high = FOOT[0, 0], FOOT[-1, 0]

    def radial(at: Float) -> Float:
        width, top = profile(at).T
        # Everything is smaller by the rounding, which is added again at the end.
        return _section_distance(
            across, y - 0.25 * top, width - FOOT_ROUNDING, 0.75 * top - FOOT_ROUNDING, 2.3
        )

    step = 1e-3
    at = np.clip(along, low, high - step)
    beyond = np.maximum(np.maximum(low - along, along - high), 0.0)
    distance = _lofted(radial(at), radial(at + step), beyond, step)
    return -_smooth_min(-distance, y - FOOT_ROUNDING, 0.010) - FOOT_ROUNDING


def _arm(x: Float, y: Float, z: Float, build: Build) -> Float:
    """Arm and hand, straight, with the thumb forward."""
    profile = PchipInterpolator(ARM[:, 0], ARM[:, 1:])
    # Arms stay clear of a larger chest.
    shoulder_x = SHOULDER[0] + 0.105 * (build.chest - 1.0)
    cosine, sine = np.cos(ARM_ANGLE), np.sin(ARM_ANGLE)
    along = (x - shoulder_x) * cosine - (y - SHOULDER[1]) * sine
    across = (x - shoulder_x) * sine + (y - SHOULDER[1]) * cosine
    low, high = ARM[0, 0], ARM[-1, 0]

    def radial(at: Float) -> Float:
        thick, wide, centre = profile(at).T
        share = np.clip(1.0 - at / 0.30, 0.0, 1.0)
        factor = 1.0 + (build.chest - 1.0) * (0.15 + 0.35 * share)
        return _section_distance(
            across, z - centre, thick * factor - HAND_ROUNDING, wide * factor - HAND_ROUNDING, 2.1
        )

    step = 1e-3
    at = np.clip(along, low, high - step)
    beyond = np.maximum(np.maximum(low - along, along - high), 0.0)
    arm = _lofted(radial(at), radial(at + step), beyond, step) - HAND_ROUNDING
    (root, root_z), (tip, tip_z), radius = THUMB
    share = np.clip(
        ((along - root) * (tip - root) + (z - root_z) * (tip_z - root_z))
        / ((tip - root) ** 2 + (tip_z - root_z) ** 2),
        0.0,
        1.0,
    )
    offset = np.hypot(along - root - share * (tip - root), z - root_z - share * (tip_z - root_z))
    return _smooth_min(arm, np.hypot(offset, across) - radius, 0.010)


def _ellipsoid(
    x: Float, y: Float, z: Float, centre: tuple[float, float, float], axes: tuple[float, float, float]
) -> Float:
    """Approximate distance from an ellipsoid: value over gradient."""
    u, v, w = (x - centre[0]) / axes[0], (y - centre[1]) / axes[1], (z - centre[2]) / axes[2]
    size = np.sqrt(u * u + v * v + w * w) + 1e-12
    slope = np.sqrt((u / axes[0]) ** 2 + (v / axes[1]) ** 2 + (w / axes[2]) ** 2) + 1e-12
    return size * (size - 1.0) / slope
