"""What measurements say of a fabric: values with uncertainties, and the curves behind them."""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields, replace
from typing import Any

import numpy as np

from toile.dressing.garment.fabrics import checked_fabric
from toile.engine.cloth.fabric import Fabric
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

PEIRCE_ERROR = 0.3
"""Relative uncertainty of the bias rigidity that follows from warp and weft."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """An SI value, its standard uncertainty, and where it comes from in words."""

    value: float
    error: float
    source: str


@dataclass(frozen=True, kw_only=True)
class MeasuredCurve:
    """A measured curve with the line fitted to it, in SI units, shape (k,) each.

    `line` are the values of the model at `x`.
    """

    title: str
    x_name: str
    y_name: str
    x: Float
    y: Float
    line: Float


@dataclass(frozen=True, kw_only=True)
class Measured:
    """Values by the names of the fields of Fabric, curves, and remarks."""

    values: Mapping[str, Estimate]
    curves: tuple[MeasuredCurve, ...] = ()
    notes: tuple[str, ...] = field(default=())

    def together(self, other: "Measured") -> "Measured":
        """Return both; the other's values win."""
        return Measured(
            values={**self.values, **other.values}, curves=self.curves + other.curves,
            notes=self.notes + other.notes,
        )  # fmt: skip


def with_bias(measured: Measured) -> Measured:
    """Return measurements with the bias rigidity that follows from warp and weft where it was not measured.

    Threads that turn freely at their crossings have B(45) = 4 / (B_warp^-1/2 + B_weft^-1/2)^2 (Peirce 1930).
    """
    values = dict(measured.values)
    if "bending_bias" in values or not {"bending_warp", "bending_weft"} <= values.keys():
        return measured
    warp, weft = (max(values[name].value, 1e-12) for name in ("bending_warp", "bending_weft"))
    bias = 4.0 / (warp**-0.5 + weft**-0.5) ** 2
    values["bending_bias"] = Estimate(
        value=bias, error=PEIRCE_ERROR * bias, source="from warp and weft (Peirce 1930), not measured"
    )
    return replace(measured, values=values)


def fabric_of(measured: Measured, name: str, like: Fabric | None) -> Fabric:
    """Return a fabric of what was measured, and of `like` in the rest. Raises InputError if values lack."""
    found: dict[str, Any] = {key: estimate.value for key, estimate in measured.values.items()}
    needed = [entry.name for entry in fields(Fabric) if entry.default is MISSING and entry.name != "name"]
    missing = [key for key in needed if key not in found]
    if like is None:
        if missing:
            raise InputError(
                f"the measurements lack {', '.join(missing)}; name a preset that is alike with --like",
                field="--like",
            )
        return checked_fabric(Fabric(name=name, **found))
    # A slope that was measured takes the place of a curve that was not.
    found |= {f"stretch_curve_{way}": () for way in ("warp", "weft") if f"stretch_{way}" in found}
    return checked_fabric(replace(like, name=name, **found))


def line_through_origin(x: Float, y: Float) -> tuple[float, float]:
    """Return the slope of y = k x, shape (k,) each, and its uncertainty.

    The latter covers scatter and bend: half the difference of the slopes of the lower and the upper half.
    """
    slope = float((x * y).sum() / max(float((x * x).sum()), 1e-300))
    order = np.argsort(np.abs(x), kind="stable")
    low, high = order[: len(order) // 2], order[len(order) // 2 :]
    halves = [
        float((x[part] * y[part]).sum() / max(float((x[part] ** 2).sum()), 1e-300)) for part in (low, high)
    ]
    scatter = _scatter(x, y - slope * x, float((x * x).sum()), 1)
    bend = 0.5 * abs(halves[1] - halves[0]) if len(order) > 3 else 0.0
    return slope, float(np.hypot(scatter, bend))


def line_with_friction(x: Float, y: Float) -> tuple[float, float, Float]:
    """Return slope and uncertainty of a loop of loading and unloading, and the fitted values, shape (k,).

    y = k x + h s, s the sign of the motion from one point to the next: its hysteresis drops out of k.
    """
    motion = np.sign(np.diff(x, prepend=x[:1]))
    motion[0] = motion[1] if len(motion) > 1 else 0.0
    columns = np.column_stack((x, motion, np.ones_like(x)))
    if abs(float(motion.sum())) == len(x):
        # One way only: friction is the offset.
        columns = columns[:, [0, 2]]
    shares, *_ = np.linalg.lstsq(columns, y, rcond=None)
    line = columns @ shares
    spread = float(((x - x.mean()) ** 2).sum())
    return float(shares[0]), _scatter(x, y - line, spread, columns.shape[1]), line


def _scatter(x: Float, rest: Float, spread: float, free: int) -> float:
    """Return the standard error of a slope from residuals."""
    count = max(len(x) - free, 1)
    return float(np.sqrt((rest**2).sum() / count / max(spread, 1e-300)))
