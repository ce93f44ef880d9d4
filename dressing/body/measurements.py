"""Measurements of a body that patterns are drafted from."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Measurements:
    """Lengths [m], heights above the floor [m], angles [rad] of a standing body.

    Points are in the body's own frame: Y up, the floor at y = 0, the trunk above x = z = 0, facing +Z.

    Attributes
    ----------
    height
        Floor to crown.
    neck, chest, waist, hip, upper_arm, wrist, thigh
        Circumferences (convex girth).
    shoulder_width
        Between the outer shoulder points.
    neck_width
        Width of the neck at its base.
    arm_length
        Shoulder point to wrist.
    inseam
        Floor to crotch.
    neck_height, shoulder_height, armpit_height, chest_height, waist_height, hip_height, crotch_height
        Levels above the floor; neck_height is the base of the neck at the side.
    arm_angle
        Angle of the (straight) arm below the horizontal: 0 is a T-pose, pi/2 hangs down.
    shoulder_point
        (x, y, z) of the left (+X) shoulder point.
    torso_depth
        (z_min, z_max) of the torso between crotch and shoulder, arms left out.
    """

    height: float
    neck: float
    chest: float
    waist: float
    hip: float
    upper_arm: float
    wrist: float
    thigh: float
    shoulder_width: float
    neck_width: float
    arm_length: float
    inseam: float
    neck_height: float
    shoulder_height: float
    armpit_height: float
    chest_height: float
    waist_height: float
    hip_height: float
    crotch_height: float
    arm_angle: float
    shoulder_point: tuple[float, float, float]
    torso_depth: tuple[float, float]
