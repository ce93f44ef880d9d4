"""What a user's stretch curves, strain limit and Poisson's ratio must be like."""

import math
from itertools import pairwise
from typing import Any

import numpy as np

from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.fabric_curves import curve_tables
from toile.engine.cloth.stretch_curve import tension_at

CURVES = ("stretch_curve_warp", "stretch_curve_weft")
SAMPLES = 400
"""Of a curve, to find where it is least steep."""


def wrong_curve(points: Any) -> str | None:
    """Return what is wrong with the points (strain, tension) of a curve, or None."""
    if not isinstance(points, tuple):
        return f"must be points [[strain, N/m], ...], got {points!r}"
    for point in points:
        if not isinstance(point, tuple) or len(point) != 2 or not all(_is_number(value) for value in point):
            return f"must be points [[strain, N/m], ...], got {point!r} among them"
    for (strain, tension), (next_strain, next_tension) in pairwise(((0.0, 0.0), *points)):
        if next_strain <= strain or next_tension <= tension:
            return (
                f"must rise from zero in strain and in tension from point to point, but after ({strain:g}, "
                f"{tension:g}) comes ({next_strain:g}, {next_tension:g}); leave that point out"
            )
    return None


def unlike_cloth(fabric: Fabric) -> tuple[str, str] | None:
    """Return the field of a fabric that does not go with its others and what is wrong, or None."""
    if fabric.strain_limit and fabric.stretch_curve_warp and fabric.stretch_curve_weft:
        return "strain_limit", "has no effect beside curves of warp and weft; leave it out"
    least = fabric.poisson / (1.0 + fabric.poisson)
    for name, table in zip(CURVES, curve_tables(fabric), strict=True):
        strains = np.linspace(0.0, table[-1, 0], SAMPLES + 1)
        tensions = [tension_at(table, strain) for strain in strains]
        slope = min(np.diff(tensions) / max(strains[1], 1e-300), default=0.0) / table[0, 3]
        if table[-1, 0] > 0.0 and slope < least:
            return name, (
                f"falls to {slope:.2g} of its first slope: with a poisson of {fabric.poisson:g} it must keep "
                f"{least:.2g}, or cloth would stretch in one place only; lower poisson"
            )
    return None


def _is_number(value: Any) -> bool:
    return isinstance(value, float) and math.isfinite(value)
