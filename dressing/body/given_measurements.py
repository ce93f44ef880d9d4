"""Measurements that a user gives, from a file or by name, and how the others are completed."""

import math
from collections.abc import Mapping
from dataclasses import asdict, fields, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.measurements import Measurements
from toile.dressing.files.parse_text import parse_json, parse_toml
from toile.dressing.files.suggestion import unknown_name
from toile.geometry.errors import InputError

Given = Mapping[str, float | tuple[float, ...]]
"""Names of Measurements to values in metres and radians."""

NAMES = tuple(field.name for field in fields(Measurements))
POINTS = {"shoulder_point": 3, "torso_depth": 2}
"""Measurements of several numbers, and how many."""
LARGEST_IN_METRES = 5.0
"""A number up to this is a length in metres, a larger one in centimetres: no body is 5 cm around."""
LARGEST = 1e6
"""Numbers above this are no measurement in any unit."""
LONGEST = 5.0
"""Lengths above this are none of a body [m]."""


def read_measurements(path: Path) -> dict[str, float | tuple[float, ...]]:
    """Return the measurements of a TOML or JSON file, in metres and radians.

    Lengths are given in centimetres or in metres, angles in degrees; a table `measurements` may hold them, as
    `toile measure --json` writes it. Raises InputError naming the file and what is wrong in it.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(
            f"{path}: there is no such file of measurements; check the path", file=path
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as a file of measurements ({error})", file=path) from None
    try:
        data = parse_json(text) if path.suffix.lower() == ".json" else parse_toml(text)
    except ValueError as error:
        raise InputError(f"{path}: not valid {path.suffix.lstrip('.').upper()}: {error}", file=path) from None
    if isinstance(data, dict):
        data = data.get("measurements", data)
    try:
        return measurements_of(data)
    except InputError as error:
        raise error.at(str(path), file=path) from None


def measurements_of(data: Any) -> dict[str, float | tuple[float, ...]]:
    """Return measurements in metres and radians, from a table of centimetres or metres, and degrees.

    Raises InputError naming what is no measurement.
    """
    if not isinstance(data, Mapping) or not data:
        raise InputError("holds no measurements; write lines such as chest = 96", field="measurements")
    return {name: _value(name, value) for name, value in data.items()}


def _value(name: str, value: Any) -> float | tuple[float, ...]:
    """Return one measurement in metres or radians. Raises InputError if it is none."""
    field = f"measurements.{name}"
    if name not in NAMES:
        raise InputError(unknown_name("measurement", name, NAMES), field=field)
    numbers = value if isinstance(value, list | tuple) else [value]
    if len(numbers) != POINTS.get(name, 1) or not all(
        # Not math.isfinite: some whole numbers are too large for a float.
        isinstance(number, int | float) and not isinstance(number, bool) and abs(number) <= LARGEST
        for number in numbers
    ):
        count = f"{POINTS[name]} numbers" if name in POINTS else "a number"
        raise InputError(f"measurement {name} is {count}, got {value!r}", field=field)
    if name == "arm_angle":
        return math.radians(float(numbers[0]))
    # One number decides for all of a point: its other coordinates may be small.
    scale = 1.0 if max(map(abs, numbers)) <= LARGEST_IN_METRES else 0.01
    metres = tuple(scale * float(number) for number in numbers)
    if name in POINTS:
        return metres
    if not 0.0 < metres[0] <= LONGEST:
        raise InputError(f"measurement {name} must be a length of a body, got {value!r}", field=field)
    return metres[0]


def completed(
    avatar: Avatar, measured: Measurements | InputError, given: Given
) -> tuple[Measurements, tuple[str, ...]]:
    """Return measurements with those that are given, and notes.

    Parameters
    ----------
    avatar
        The body in its own frame.
    measured
        What was measured on it, or why nothing was.
    given
        Measurements to be used instead. Where nothing was measured, the others are those of the built-in
        mannequin, in proportion to the height, and the depth of the torso is the body's.
    """
    if isinstance(measured, Measurements):
        return replace(measured, **given), ()  # type: ignore[arg-type]
    vertices = avatar.vertices
    height = given.get("height", float(np.ptp(vertices[:, 1])))
    assert isinstance(height, float)
    usual = _usual()
    scale = height / usual.height
    guessed: dict[str, Any] = {
        name: value
        if name == "arm_angle"
        else tuple(scale * number for number in value)
        if isinstance(value, tuple)
        else scale * value
        for name, value in asdict(usual).items()
    } | {"height": height}
    guess = Measurements(**(guessed | dict(given)))
    if "torso_depth" not in given:
        x, y, z = vertices.T
        trunk = (
            (y > guess.crotch_height) & (y < guess.shoulder_height) & (np.abs(x) < 0.5 * guess.shoulder_width)
        )
        if trunk.any():
            guess = replace(guess, torso_depth=(float(z[trunk].min()), float(z[trunk].max())))
    missing = [name for name in NAMES if name not in given and name not in ("height", "torso_depth")]
    note = f"Not given, so those of the mannequin in proportion to the height: {', '.join(missing)}."
    return guess, (note,) if missing else ()


@cache
def _usual() -> Measurements:
    """Measurements of the built-in mannequin."""
    from toile.dressing.body.measure import measure
    from toile.dressing.body.stored_mannequin import stored_mannequin

    return measure(stored_mannequin())
