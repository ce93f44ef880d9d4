"""KES-F: curves of tension, shear and bending from a CSV file, or their figures from a TOML file.

A CSV file has the columns test, direction, x, y, and perhaps x_unit and y_unit; lines that begin with # say
`weight = 150` [g/m2] and `thickness = 0.4` [mm]::

    # weight = 150 g/m2
    # thickness = 0.42 mm
    test,direction,x,y
    tensile,warp,0.5,20.1
    shear,warp,0.5,0.31
    bending,weft,0.5,0.021

Without units they are those of the instruments: strain in %, angles in degrees, curvature in 1/cm, forces in
gf/cm, moments in gf.cm/cm. Kawabata 1980.
"""

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from toile.dressing.fabric_fit.estimate import (
    Estimate,
    Measured,
    MeasuredCurve,
    line_through_origin,
    line_with_friction,
)
from toile.dressing.fabric_fit.units import GF, factor, quantity
from toile.dressing.files.parse_text import parse_toml
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError, about


class Test(NamedTuple):
    """Kinds and default units of the two columns of a test, and their names in pictures."""

    x: str
    x_unit: str
    y: str
    y_unit: str
    labels: tuple[str, str]


TESTS = {
    "tensile": Test("strain", "%", "force per width", "gf/cm", ("strain", "force per width, N/m")),
    "shear": Test("angle", "deg", "force per width", "gf/cm", ("tan of the angle", "force per width, N/m")),
    "bending": Test(
        "curvature", "1/cm", "moment per width", "gf.cm/cm", ("curvature, 1/m", "moment per width, N")
    ),
}  # fmt: skip
DIRECTIONS = {"tensile": ("warp", "weft"), "shear": ("warp", "weft"), "bending": ("warp", "weft", "bias")}
LEAST_POINTS = 4
FULL_LOAD = 500.0 * GF / 1e-2
"""Force per width at which tension is turned back [N/m]: 500 gf/cm."""
FIGURE_ERROR = 0.05
"""Relative uncertainty of figures that come without their curves."""


def read_kes(path: Path) -> Measured:
    """Return what a KES file says. Raises InputError naming line and unit."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read ({error}); check the path", file=path) from None
    if path.suffix.lower() == ".toml":
        try:
            data = parse_toml(text)
        except ValueError as error:
            raise InputError(f"{path}: not valid TOML: {error}", file=path) from None
        return kes_figures(data, path)
    return _kes_curves(text, path)


def _kes_curves(text: str, path: Path) -> Measured:
    """Return what curves say."""
    heads = [line[1:] for line in text.splitlines() if line.startswith("#") and "=" in line]
    values: dict[str, Estimate] = {}
    for line in heads:
        key, _, said = line.partition("=")
        _common(values, key.strip().lower(), said, path)
    body = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line and line[0] != "#"]
    rows = list(csv.DictReader([line for _, line in body], skipinitialspace=True))
    points: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for (number, _), row in zip(body[1:], rows, strict=False):
        with about(file=path):
            try:
                point = _point(row)
            except InputError as error:
                raise InputError(f"{path}, line {number}: {error}", file=path) from None
        points.setdefault((row["test"].strip(), row["direction"].strip()), []).append(point)
    curves = []
    for (test, direction), found in points.items():
        if len(found) < LEAST_POINTS:
            raise InputError(
                f"{path}: {test}, {direction} has {len(found)} points; give {LEAST_POINTS} or more", file=path
            )
        name, estimate, curve = _fitted(test, direction, np.array(found))
        curves.append(curve)
        # Shear is measured along both threads: the mean of the two.
        before = values.get(name)
        values[name] = estimate if before is None else _mean(before, estimate)
    if not curves:
        raise InputError(f"{path}: holds no points; give the columns test,direction,x,y", file=path)
    return Measured(values=values, curves=tuple(curves))


def _common(values: dict[str, Estimate], key: str, said: str, path: Path) -> None:
    """Take weight and thickness."""
    for word, name, kind, unit, error in (
        ("weight", "areal_density", "mass per area", "g/m2", 0.01),
        ("thickness", "thickness", "length", "mm", 0.05),
    ):
        if key == word:
            with about(file=path):
                value = quantity(said, kind, unit)
            values[name] = Estimate(value=value, error=error * value, source=f"{word} {said.strip()}")


def _point(row: Mapping[str, Any]) -> tuple[float, float]:
    """Return a point in SI units. Raises InputError."""
    test, direction = (str(row.get(key) or "").strip() for key in ("test", "direction"))
    if test not in TESTS:
        raise InputError(f"test is one of {', '.join(TESTS)}, got '{test}'")
    if direction not in DIRECTIONS[test]:
        raise InputError(f"direction of {test} is one of {', '.join(DIRECTIONS[test])}, got '{direction}'")
    kind = TESTS[test]
    numbers = []
    for column, of, unit in (("x", kind.x, kind.x_unit), ("y", kind.y, kind.y_unit)):
        try:
            number = float(row.get(column) or "")
        except ValueError:
            raise InputError(f"{column} must be a number, got '{row.get(column)}'") from None
        numbers.append(number * factor(str(row.get(f"{column}_unit") or unit), of))
    return numbers[0], numbers[1]


def _fitted(test: str, direction: str, points: Float) -> tuple[str, Estimate, MeasuredCurve]:
    """Return the property that a curve measures, its estimate, and the curve with its line."""
    x, y = points.T
    count = f"KES {test}, {direction}: {len(x)} points"
    if test == "tensile":
        name = f"stretch_{direction}"
        slope, error = line_through_origin(x, y)
        line = slope * x
    elif test == "shear":
        name, x = "shear", np.tan(x)
        slope, error, line = line_with_friction(x, y)
    else:
        name = f"bending_{direction}"
        slope, error, line = line_with_friction(x, y)
    labels = TESTS[test].labels
    curve = MeasuredCurve(
        title=f"{test}, {direction}", x_name=labels[0], y_name=labels[1], x=x, y=y, line=line
    )
    return name, Estimate(value=slope, error=error, source=count), curve


def _mean(one: Estimate, other: Estimate) -> Estimate:
    """Return the mean of two measurements of a property; half their difference is an uncertainty too."""
    return Estimate(
        value=0.5 * (one.value + other.value),
        error=float(np.hypot(0.5 * np.hypot(one.error, other.error), 0.5 * (one.value - other.value))),
        source=f"{one.source}; {other.source}",
    )


def kes_figures(data: Mapping[str, Any], path: Path) -> Measured:
    """Return what figures say: tables warp and weft with EMT [%], WT [gf.cm/cm2], B and G, and weight.

    Tension becomes linear with the same work up to the same strain, 2 WT / EMT^2; without WT, the force of
    500 gf/cm over EMT.
    """
    values: dict[str, Estimate] = {}
    for key in ("weight", "thickness"):
        if key in data:
            _common(values, key, str(data[key]), path)
    for direction in ("warp", "weft", "bias"):
        table = data.get(direction, {})
        unknown = [key for key in table if key not in ("EMT", "WT", "LT", "RT", "B", "G")]
        if unknown:
            raise InputError(f"{path}: [{direction}] has EMT, WT, B and G, not '{unknown[0]}'", file=path)
        with about(file=path):
            _figures_of(values, direction, table)
    if not values:
        raise InputError(f"{path}: holds no figures; give [warp] and [weft] with EMT, B and G", file=path)
    return Measured(values=values, notes=("tension is taken as linear, with the same work up to EMT",))


def _figures_of(values: dict[str, Estimate], direction: str, table: Mapping[str, Any]) -> None:
    """Take the figures of one direction."""
    said = {key: str(value) for key, value in table.items()}
    if "EMT" in said and direction != "bias":
        strain = quantity(said["EMT"], "strain", "%")
        force = 2.0 * quantity(said["WT"], "force per width", "gf/cm") / strain if "WT" in said else FULL_LOAD
        slope = force / strain
        # A linear law between its work and its end.
        error = max(0.5 * abs(FULL_LOAD / strain - slope), FIGURE_ERROR * slope)
        values[f"stretch_{direction}"] = Estimate(value=slope, error=error, source=f"KES EMT {said['EMT']}")
    if "B" in said:
        rigidity = quantity(said["B"], "bending rigidity", "gf.cm2/cm")
        values[f"bending_{direction}"] = Estimate(
            value=rigidity, error=FIGURE_ERROR * rigidity, source=f"KES B {said['B']}"
        )
    if "G" in said and direction != "bias":
        stiffness = quantity(said["G"], "shear stiffness", "gf/(cm.deg)")
        own = Estimate(value=stiffness, error=FIGURE_ERROR * stiffness, source=f"KES G {said['G']}")
        values["shear"] = own if "shear" not in values else _mean(values["shear"], own)
