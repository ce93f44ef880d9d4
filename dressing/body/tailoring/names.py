"""Measurements under the names of programs that draft patterns, and as JSON."""

from collections.abc import Callable
from dataclasses import asdict
from math import degrees
from typing import Any

from toile.dressing.body.measurements import Measurements
from toile.dressing.body.tailoring.tailor_measurements import TailorMeasurements

Source = str | Callable[[Measurements, TailorMeasurements], float]

ANGLES = ("arm_angle", "shoulder_slope")
"""Measurements that are angles: radians inside, degrees in files."""

FREESEWING: dict[str, Source] = {
    "chest": "chest", "waist": "waist", "hips": "hip_bone", "seat": "hip", "neck": "neck",
    "biceps": "upper_arm", "wrist": "wrist", "upperLeg": "thigh", "knee": "knee", "ankle": "ankle",
    "heel": "heel", "head": "head",
    "highBust": "high_bust", "underbust": "underbust", "bustSpan": "bust_span",
    "shoulderToShoulder": "shoulder_width", "shoulderToWrist": "arm_length", "inseam": "inseam",
    "shoulderSlope": "shoulder_slope", "waistBack": "waist_back", "seatBack": "hip_back",
    "bustFront": lambda m, t: m.chest - t.chest_back, "hpsToWaistBack": "neck_to_waist_back",
    "hpsToWaistFront": "neck_to_waist_front", "hpsToBust": "neck_to_bust", "crossSeam": "crotch_seam",
    "crossSeamFront": "crotch_seam_front", "waistToHips": lambda m, t: m.waist_height - t.hip_bone_height,
    "waistToSeat": lambda m, _: m.waist_height - m.hip_height,
    "waistToUpperLeg": lambda m, _: m.waist_height - m.crotch_height,
    "waistToKnee": lambda m, t: m.waist_height - t.knee_height, "waistToFloor": "waist_height",
    "waistToArmpit": lambda m, _: m.armpit_height - m.waist_height,
}  # fmt: skip
"""Names of FreeSewing; it takes millimetres and degrees."""

GARMENTCODE: dict[str, Source] = {
    "height": "height", "bust": "chest", "waist": "waist", "hips": "hip", "underbust": "underbust",
    "wrist": "wrist", "leg_circ": "thigh", "arm_length": "arm_length", "shoulder_w": "shoulder_width",
    "bust_points": "bust_span", "back_width": "chest_back", "waist_back_width": "waist_back",
    "hip_back_width": "hip_back", "waist_line": "neck_to_waist_back", "bust_line": "neck_to_bust",
    "waist_over_bust_line": "neck_to_waist_front",
    "vert_bust_line": lambda m, _: m.neck_height - m.chest_height,
    "hips_line": lambda m, _: m.waist_height - m.hip_height,
    "crotch_hip_diff": lambda m, _: m.hip_height - m.crotch_height,
    "head_l": lambda m, _: m.height - m.neck_height, "arm_pose_angle": "arm_angle",
    "shoulder_incl": "shoulder_slope",
}  # fmt: skip
"""Names of GarmentCode; it takes centimetres and degrees."""

SEAMLY: dict[str, Source] = {
    "height": "height", "bust_circ": "chest", "waist_circ": "waist", "hip_circ": "hip",
    "highhip_circ": "hip_bone", "neck_circ": "neck", "arm_upper_circ": "upper_arm", "arm_wrist_circ": "wrist",
    "leg_thigh_upper_circ": "thigh", "leg_knee_circ": "knee", "leg_ankle_circ": "ankle",
    "leg_ankle_diag_circ": "heel", "head_circ": "head",
    "highbust_circ": "high_bust", "lowbust_circ": "underbust", "bustpoint_to_bustpoint": "bust_span",
    "shoulder_tip_to_shoulder_tip_f": "shoulder_width", "arm_shoulder_tip_to_wrist": "arm_length",
    "leg_crotch_to_floor": "inseam", "bust_arc_f": lambda m, t: m.chest - t.chest_back,
    "bust_arc_b": "chest_back", "waist_arc_f": lambda m, t: m.waist - t.waist_back,
    "waist_arc_b": "waist_back",
    "hip_arc_f": lambda m, t: m.hip - t.hip_back, "hip_arc_b": "hip_back",
    "neck_side_to_waist_f": "neck_to_waist_front", "neck_side_to_waist_b": "neck_to_waist_back",
    "neck_side_to_bust_f": "neck_to_bust", "crotch_length": "crotch_seam",
    "crotch_length_f": "crotch_seam_front", "height_waist_side": "waist_height", "height_hip": "hip_height",
    "height_knee": "knee_height", "height_ankle": "ankle_height", "height_armpit": "armpit_height",
    "height_neck_side": "neck_height", "height_shoulder_tip": "shoulder_height",
    "height_bustpoint": "chest_height",
    "shoulder_slope_neck_side_angle": "shoulder_slope",
}  # fmt: skip
"""Names of Seamly and Valentina; they take centimetres and degrees."""

SYSTEMS = {"freesewing": (FREESEWING, 1000.0), "garmentcode": (GARMENTCODE, 100.0), "seamly": (SEAMLY, 100.0)}
"""Names and numbers of units in a metre."""


def measurements_json(measured: Measurements, tailored: TailorMeasurements) -> dict[str, Any]:
    """Return all measurements for JSON: toile's in centimetres and degrees, then those of other programs."""
    return {
        "units": {"length": "cm", "angle": "degrees"},
        "measurements": _scaled(asdict(measured)),
        "more": _scaled(asdict(tailored)),
        "names": {
            system: {
                "units": {"length": "mm" if scale == 1000.0 else "cm", "angle": "degrees"},
                **{name: _named(source, measured, tailored, scale) for name, source in names.items()},
            }
            for system, (names, scale) in SYSTEMS.items()
        },
    }


def _scaled(values: dict[str, Any]) -> dict[str, Any]:
    """Return values in centimetres and degrees."""
    return {
        name: round(degrees(value), 2)
        if name in ANGLES
        else [round(100.0 * number, 2) for number in value]
        if isinstance(value, tuple)
        else round(100.0 * value, 2)
        for name, value in values.items()
    }


def _named(source: Source, measured: Measurements, tailored: TailorMeasurements, scale: float) -> float:
    """Return one measurement of another program."""
    if not isinstance(source, str):
        return round(scale * source(measured, tailored), 2)
    value = float(getattr(measured if hasattr(measured, source) else tailored, source))
    return round(degrees(value) if source in ANGLES else scale * value, 2)
