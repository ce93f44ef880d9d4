"""Drape: every fabric preset hangs over a disc as its fabric does, whatever the mesh and the membrane."""

from collections.abc import Iterator

from toile.dress.benchmarks.cusick import drape_coefficient, hung, stiffer
from toile.dress.benchmarks.validation_row import ValidationRow, absolute_row
from toile.dress.fabrics import drape_bands, fabric
from toile.engine.fabric import Fabric

EDGE = 0.006
"""Of the triangles [m]."""
ROBUST = ("cotton-poplin", "wool-coating")
"""Presets that also hang on a finer mesh and with a stiffer membrane."""
STIFFER = 20.0
BAR = 2.0
"""Points that the coefficient may move then."""


def validate_drape() -> Iterator[ValidationRow]:
    """Hang all presets that were measured, some of them also on half the edges and 20 times as stiff."""
    for name, (low, high) in drape_bands().items():
        found = _percent(fabric(name), EDGE)
        yield absolute_row("drape", name, "DC, %", found, 0.5 * (low + high), 0.5 * (high - low))
        if name in ROBUST:
            finer = _percent(fabric(name), 0.5 * EDGE)
            yield absolute_row("drape", f"{name}, half the edges", "DC, %", finer, found, BAR)
            stiff = _percent(stiffer(fabric(name), STIFFER), EDGE)
            yield absolute_row("drape", f"{name}, {STIFFER:g}x membrane", "DC, %", stiff, found, BAR)


def _percent(material: Fabric, edge: float) -> float:
    """Drape coefficient [%] of a fabric."""
    cloth, _ = hung(material, edge)
    return 100.0 * drape_coefficient(cloth)
