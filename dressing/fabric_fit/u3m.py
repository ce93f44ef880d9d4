"""U3M 1.1 materials: weight, thickness, and the raw measurements of a FAB device in a file beside it.

The schema (github.com/vizoogmbh/u3m) gives weight in g/m2 and thickness in mm. Raw runs are pairs of the
distance of two clamps and a force on a strip of a width; their units are not in the schema. Distances are
centimetres by its descriptions ("at 8 cm distance"); forces are taken as gram-force, in which the stiffness
of the schema's own example is that of a knit. Its bending runs are not used: what they mean is not published.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.fabric_fit.estimate import Estimate, Measured, MeasuredCurve, line_through_origin
from toile.dressing.fabric_fit.units import GF
from toile.geometry.errors import InputError

STRIPS = {"L": "warp", "W": "weft", "B": "bias"}
"""Directions of strips: along the length of the fabric, its width, and the bias."""
RUN = "S2"
"""Stretch of strips of 8 cm."""
FORCE_ERROR = 0.2
"""Relative uncertainty of forces: their unit is not in the schema."""


def read_u3m(path: Path) -> Measured:
    """Return what a .u3m file, or its file of physics (.json), says. Raises InputError."""
    data = _json(path)
    values: dict[str, Estimate] = {}
    physics: Any = data
    if "material" in data:
        said = (data["material"] or {}).get("physics") or {}
        for key, name, unit in (("weight", "areal_density", 1e-3), ("thickness", "thickness", 1e-3)):
            if isinstance(said.get(key), int | float) and said[key] > 0.0:
                value = unit * float(said[key])
                values[name] = Estimate(value=value, error=0.02 * value, source=f"U3M {key}")
        beside = (said.get("devices") or {}).get("fab")
        physics = _json(path.parent / beside) if isinstance(beside, str) else {}
    raw = physics.get("raw_data") or {}
    try:
        curves = _runs(raw, values)
    except (KeyError, TypeError, ValueError, IndexError):
        raise InputError(f"{path}: its raw measurements are not those of U3M 1.1", file=path) from None
    if not values:
        raise InputError(f"{path}: holds no weight, thickness or raw measurements", file=path)
    notes = ("forces of the raw measurements are taken as gram-force, distances as centimetres",)
    return Measured(values=values, curves=curves, notes=notes if curves else ())


def _json(path: Path) -> dict[str, Any]:
    """Return the content of a JSON file."""
    try:
        data = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as U3M ({error})", file=path) from None
    if not isinstance(data, dict):
        raise InputError(f"{path}: is no U3M file", file=path)
    return data


def _runs(raw: dict[str, Any], values: dict[str, Estimate]) -> tuple[MeasuredCurve, ...]:
    """Take mass, thickness and the first stretch of every strip."""
    if isinstance(raw.get("M"), int | float):
        value = 1e-3 * float(raw["M"])
        values["areal_density"] = Estimate(value=value, error=0.02 * value, source="U3M raw mass")
    if "T" in raw:
        value = 1e-2 * float(raw["T"]["samplesTree"][0][0])
        values["thickness"] = Estimate(value=value, error=0.1 * value, source="U3M raw thickness, first load")
    curves, slopes = [], {}
    for key, direction in STRIPS.items():
        if key not in raw:
            continue
        part = raw[key][RUN]
        run = np.array(part["samplesTree"][0], np.float64).reshape(-1, 2)
        x = run[:, 0] / run[0, 0] - 1.0
        y = (run[:, 1] - run[0, 1]) * GF / (1e-2 * float(part["width"]))
        slope, error = line_through_origin(x, y)
        slopes[direction] = slope, float(np.hypot(error, FORCE_ERROR * slope)), len(x)
        curves.append(
            MeasuredCurve(
                title=f"stretch, {direction}", x_name="strain", y_name="force per width, N/m", x=x, y=y,
                line=slope * x,
            )
        )  # fmt: skip
    for direction in ("warp", "weft"):
        if direction in slopes:
            slope, error, count = slopes[direction]
            values[f"stretch_{direction}"] = Estimate(
                value=slope, error=error, source=f"U3M {RUN}, {direction}: {count} points"
            )
    if slopes.keys() >= {"warp", "weft", "bias"}:
        values["shear"] = _shear(*(slopes[name][:2] for name in ("warp", "weft", "bias")))
    return tuple(curves)


def _shear(warp: tuple[float, float], weft: tuple[float, float], bias: tuple[float, float]) -> Estimate:
    """Return the shear stiffness from strips along warp, weft and bias, each (slope, error) [N/m].

    A strip in bias gives by 4 / k_bias = 1 / k_warp + 1 / k_weft + 1 / k_shear.
    """
    give = 4.0 / bias[0] - 1.0 / warp[0] - 1.0 / weft[0]
    value = 1.0 / max(give, 0.25 / bias[0])
    return Estimate(value=value, error=0.5 * value, source=f"U3M {RUN} in bias, less warp and weft")
