"""Bending from a Cusick drape coefficient: rigidities are scaled until a simulated drape has it."""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

from toile.dressing.fabric_fit.estimate import Estimate
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError

CLOSE = 0.5
"""Points of the drape coefficient within which a drape is as measured."""
MEASURED_ERROR = 2.0
"""Points by which measured coefficients of one fabric scatter."""
MOST_DRAPES = 7
WIDEST = 30.0
"""Farthest factor on the rigidities from which there is a way back."""
FIELDS = ("bending_warp", "bending_weft", "bending_bias")


def bending_from_drape(
    fabric: Fabric, wanted: float, drape: Callable[[Fabric], float], say: Callable[[str], None]
) -> dict[str, Estimate]:
    """Return the bending rigidities with which a fabric has a drape coefficient [%].

    `drape` simulates one, `say` is told each. Raises InputError for a coefficient that no bending gives.
    """
    if not 0.0 < wanted < 100.0:
        raise InputError(f"a drape coefficient lies between 0 and 100 %, got {wanted:g}", field="--cusick")
    known: list[tuple[float, float]] = []
    power = 0.0
    for _ in range(MOST_DRAPES):
        found = drape(_bent(fabric, math.exp(power)))
        say(f"bending times {math.exp(power):.3g}: drape coefficient {found:.1f} %")
        known.append((power, found))
        if abs(found - wanted) <= CLOSE:
            break
        power = _next(sorted(known), wanted)
        if abs(power) > math.log(WIDEST):
            raise InputError(
                f"no bending between 1/{WIDEST:g} and {WIDEST:g} times that of {fabric.name} drapes with "
                f"{wanted:g} %; take a preset that is more alike with --like", field="--cusick",
            )  # fmt: skip
    power, found = min(known, key=lambda pair: abs(pair[1] - wanted))
    slope = _slope(sorted(known))
    error = min(max(MEASURED_ERROR, abs(found - wanted)) / slope, 1.0)
    factor = math.exp(power)
    return {
        name: Estimate(
            value=factor * getattr(fabric, name), error=error * factor * getattr(fabric, name),
            source=f"drape coefficient of {wanted:g} % ({found:.1f} % simulated)",
        )
        for name in FIELDS
    }  # fmt: skip


def _bent(fabric: Fabric, factor: float) -> Fabric:
    """Return a fabric that bends so many times harder."""
    return replace(fabric, **{name: factor * getattr(fabric, name) for name in FIELDS})


def _slope(known: list[tuple[float, float]]) -> float:
    """Return the points of drape coefficient per logarithm of the factor, over all that is known."""
    if len(known) < 2:
        return 20.0
    return max((known[-1][1] - known[0][1]) / (known[-1][0] - known[0][0]), 3.0)


def _next(known: list[tuple[float, float]], wanted: float) -> float:
    """Return the next logarithm: between the two that have the coefficient between them, or beyond."""
    for (low, under), (high, over) in pairwise(known):
        if under <= wanted <= over:
            share = (wanted - under) / max(over - under, 1e-9)
            return low + (high - low) * min(max(share, 0.1), 0.9)
    power, found = known[0] if wanted < known[0][1] else known[-1]
    step = (wanted - found) / _slope(known)
    return power + math.copysign(min(max(abs(step), 0.2), 1.5), step)
