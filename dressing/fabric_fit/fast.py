"""FAST: figures of the four instruments from a TOML file (de Boos and Tester 1994).

``weight`` [g/m2], ``T2`` [mm]; in the tables warp and weft bending length ``C`` [mm], extension ``E5``,
``E20`` and ``E100`` [%] at 5, 20 and 100 gf/cm; ``EB5`` [%], extension in bias at 5 gf/cm::

    weight = 168
    T2 = 0.40
    EB5 = 3.5
    [warp]
    C = 16.2
    E5 = 0.3
    E20 = 0.9
    E100 = 2.9
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.fabric_fit.cantilever import rigidity
from toile.dressing.fabric_fit.estimate import Estimate, Measured, MeasuredCurve, line_through_origin
from toile.dressing.fabric_fit.units import GF, quantity
from toile.dressing.files.parse_text import parse_toml
from toile.geometry.errors import InputError, about

LOADS = {"E5": 5.0, "E20": 20.0, "E100": 100.0}
"""Force per width of the extensions [gf/cm]."""
SHEAR = 1.23
"""FAST's shear rigidity is 123 over EB5 in %: this over EB5 as a strain [N/m]."""
KEYS = ("weight", "T2", "T100", "EB5", "warp", "weft")
OF_DIRECTION = ("C", *LOADS)
LENGTH_ERROR, FIGURE_ERROR = 0.02, 0.05
"""Relative uncertainties of a bending length and of other figures."""


def read_fast(path: Path) -> Measured:
    """Return what a file of FAST figures says. Raises InputError naming the key."""
    try:
        data = parse_toml(path.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read ({error}); check the path", file=path) from None
    except ValueError as error:
        raise InputError(f"{path}: not valid TOML: {error}", file=path) from None
    for key in data:
        if key not in KEYS:
            raise InputError(f"{path}: the keys are {', '.join(KEYS)}, not '{key}'", file=path)
    with about(file=path):
        return _measured(data, path)


def _measured(data: Mapping[str, Any], path: Path) -> Measured:
    """Return what figures say."""
    if "weight" not in data:
        raise InputError(
            f"{path}: give weight [g/m2]; rigidities follow from bending lengths by it", file=path
        )
    density = quantity(str(data["weight"]), "mass per area", "g/m2")
    values = {"areal_density": Estimate(value=density, error=0.01 * density, source="FAST weight")}
    if "T2" in data:
        thickness = quantity(str(data["T2"]), "length", "mm")
        values["thickness"] = Estimate(value=thickness, error=0.05 * thickness, source="FAST T2")
    if "EB5" in data:
        bias = quantity(str(data["EB5"]), "strain", "%")
        values["shear"] = Estimate(value=SHEAR / bias, error=FIGURE_ERROR * SHEAR / bias, source="FAST EB5")
    curves = []
    for direction in ("warp", "weft"):
        table = data.get(direction, {})
        for key in table:
            if key not in OF_DIRECTION:
                raise InputError(
                    f"{path}: [{direction}] has {', '.join(OF_DIRECTION)}, not '{key}'", file=path
                )
        if "C" in table:
            length = quantity(str(table["C"]), "length", "mm")
            values[f"bending_{direction}"] = rigidity(density, length, LENGTH_ERROR, "FAST C")
        loads = [key for key in LOADS if key in table]
        if loads:
            x = np.array([quantity(str(table[key]), "strain", "%") for key in loads])
            y = np.array([LOADS[key] * GF / 1e-2 for key in loads])
            slope, error = line_through_origin(x, y)
            # A line through three points: how far the first is from it tells more than their scatter.
            bend = abs(float(y[0] / max(x[0], 1e-9)) - slope)
            estimate = Estimate(
                value=slope, error=max(error, min(bend, slope)), source=f"FAST {', '.join(loads)}"
            )
            values[f"stretch_{direction}"] = estimate
            curves.append(
                MeasuredCurve(
                    title=f"extension, {direction}", x_name="strain", y_name="force per width, N/m", x=x, y=y,
                    line=slope * x,
                )
            )  # fmt: skip
    return Measured(values=values, curves=tuple(curves))
