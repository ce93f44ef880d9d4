"""Drape: every fabric preset hangs over a disc as its fabric does, whatever the mesh.

Cloth clamped flat around a disc cannot bend without stretch: how it hangs depends on how it resists shear and
compression, and not on how little its threads give in tension (docs/theory.md, Drape over a disc). So tension
may be much stiffer and change little, and on a membrane that is stiffer in all it does the mesh may change
little. What such a membrane itself changes is compared as well, with the same bar, but is no error.
"""

from collections.abc import Iterator

from toile.dressing.garment.fabrics import drape_bands, fabric
from toile.engine.cloth.fabric import Fabric
from toile.studies.validation.cusick import drape_coefficient, hung, stiffer, tauter
from toile.studies.validation.validation_row import ValidationRow, absolute_row

EDGE = 0.006
"""Of the triangles [m]."""
ROBUST = ("cotton-poplin", "wool-coating")
"""Presets that also hang on a finer mesh and with a stiffer membrane."""
STIFFER = 20.0
BAR = 2.0
"""Points that the coefficient may move then."""


def validate_drape() -> Iterator[ValidationRow]:
    """Hang all presets that have a band, some of them also on half the edges and 20 times as stiff."""
    for name, band in drape_bands().items():
        found = _percent(fabric(name), EDGE)
        variant = f"{name}, band estimated" if band.estimated else name
        middle, half = 0.5 * (band.low + band.high), 0.5 * (band.high - band.low)
        yield absolute_row("drape", variant, "DC, %", found, middle, half)
        if name in ROBUST:
            yield from _robust(name, found)


def _robust(name: str, found: float) -> Iterator[ValidationRow]:
    """Compare the coefficient found [%] with that of other meshes and membranes."""
    material, finer = fabric(name), 0.5 * EDGE
    half = _percent(material, finer)
    yield absolute_row("drape", f"{name}, half the edges", "DC, %", half, found, BAR)
    taut = _percent(tauter(material, STIFFER), EDGE)
    yield absolute_row("drape", f"{name}, {STIFFER:g}x in tension", "DC, %", taut, found, BAR)
    stiff = _percent(stiffer(material, STIFFER), EDGE)
    variant = f"{name}, {STIFFER:g}x membrane"
    yield absolute_row("drape", variant, "DC, %", stiff, found, BAR)
    stiff_half = _percent(stiffer(material, STIFFER), finer)
    yield absolute_row("drape", f"{variant}, half the edges", "DC, %", stiff_half, stiff, BAR)


def _percent(material: Fabric, edge: float) -> float:
    """Drape coefficient [%] of a fabric."""
    cloth, _ = hung(material, edge)
    return 100.0 * drape_coefficient(cloth)
