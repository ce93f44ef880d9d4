"""The fabric that several layers of cloth are together: docs/theory.md, "Layers"."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from toile.dressing.garment.fields.layer import Layer
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.fabric_curves import curve_tables
from toile.engine.cloth.stretch_curve import tension_at
from toile.geometry.arrays import Float

PIECES = 4
"""Points per piece of a curve at which tensions are added up."""


class _Plate(NamedTuple):
    """What is stacked up: stiffness along warp, weft and in shear [N/m], its height [m]."""

    stiffness: Float
    height: float


def layered(shell: Fabric, layers: Sequence[Layer]) -> Fabric:
    """Return what a fabric is together with layers on its wrong side, under its own name.

    Its friction against the body is that of the last layer, against cloth that of the outer fabric, and so is
    the curvature at which it creases.
    """
    together, plate, below = shell, _Plate(_stiffness(shell), 0.0), 0.5 * shell.thickness
    for layer in layers:
        own = layer.fabric if isinstance(layer.fabric, Fabric) else shell
        added = _Plate(_stiffness(own), -(below + 0.5 * own.thickness))
        below += own.thickness
        together, plate = _joined(together, own, plate, added, layer.bond)
    return together


def _joined(one: Fabric, other: Fabric, plate: _Plate, added: _Plate, bond: float) -> tuple[Fabric, _Plate]:
    """Return a fabric with one layer more, and what is stacked up."""
    total = plate.stiffness + added.stiffness
    apart = plate.height - added.height
    # Warp, weft and shear: k1 k2/(k1 + k2) d^2.
    warp, weft, shear = bond * apart**2 * plate.stiffness * added.stiffness / np.maximum(total, 1e-300)
    stretch = one.stretch_warp + one.stretch_weft
    more_stretch = other.stretch_warp + other.stretch_weft
    bending, more_bending = (fabric.bending_warp + fabric.bending_weft for fabric in (one, other))

    def mean(name: str, first: float, second: float) -> float:
        a, b = getattr(one, name), getattr(other, name)
        # The mean of what is alike is that, without rounding.
        return float(a if a == b or not first + second else (first * a + second * b) / (first + second))

    curves = _added_curves(one, other)
    fabric = replace(
        one,
        areal_density=one.areal_density + other.areal_density,
        thickness=one.thickness + other.thickness,
        bending_warp=one.bending_warp + other.bending_warp + warp,
        bending_weft=one.bending_weft + other.bending_weft + weft,
        bending_bias=one.bending_bias + other.bending_bias + 0.25 * (warp + weft) + shear,
        stretch_warp=one.stretch_warp + other.stretch_warp,
        stretch_weft=one.stretch_weft + other.stretch_weft,
        shear=one.shear + other.shear,
        compression=mean("compression", stretch, more_stretch),
        poisson=mean("poisson", stretch, more_stretch),
        damping=mean("damping", stretch, more_stretch),
        bending_damping=mean("bending_damping", bending, more_bending),
        friction_body=other.friction_body,
        stretch_curve_warp=curves[0],
        stretch_curve_weft=curves[1],
        strain_limit=0.0,
    )
    share = bond * float(added.stiffness[:2].sum())
    before = float(plate.stiffness[:2].sum())
    height = (before * plate.height + share * added.height) / (before + share)
    return fabric, _Plate(total, height)


def _stiffness(fabric: Fabric) -> Float:
    """First stiffness along warp, weft and in shear [N/m], shape (3,)."""
    warp, weft = (table[0, 3] for table in curve_tables(fabric))
    return np.array([warp, weft, fabric.shear])


def _added_curves(one: Fabric, other: Fabric) -> list[tuple[tuple[float, float], ...]]:
    """Return the curves of tension along warp and weft of two layers; none where both are straight."""
    curves: list[tuple[tuple[float, float], ...]] = []
    for tables in zip(curve_tables(one), curve_tables(other), strict=True):
        knots = np.unique(np.concatenate([table[:, 0] for table in tables]))
        if len(knots) == 1:
            curves.append(())
            continue
        # One piece more, as long as the last, carries the slope on.
        knots = np.append(knots, 2.0 * knots[-1] - knots[-2])
        strains = np.unique(np.concatenate([np.linspace(a, b, PIECES + 1) for a, b in pairwise(knots)]))[1:]
        tensions = (sum(tension_at(table, strain) for table in tables) for strain in strains.tolist())
        curves.append(tuple(zip(strains.tolist(), tensions, strict=True)))
    return curves
