"""A measured fabric as a table for people and as a table of a scene file."""

import json
from dataclasses import fields

from toile.dressing.fabric_fit.estimate import Measured
from toile.engine.cloth.fabric import Fabric

SHOWN = {
    "areal_density": (1e3, "g/m2"), "thickness": (1e3, "mm"), "bending_warp": (1e6, "uN.m"),
    "bending_weft": (1e6, "uN.m"), "bending_bias": (1e6, "uN.m"), "stretch_warp": (1.0, "N/m"),
    "stretch_weft": (1.0, "N/m"), "shear": (1.0, "N/m"),
}  # fmt: skip
"""Factor and unit in which people read properties."""


def measured_table(measured: Measured, fabric: Fabric, like: str | None) -> str:
    """Return the properties of a fabric with their uncertainties and sources, a line each."""
    lines = []
    for name, (times, unit) in SHOWN.items():
        estimate = measured.values.get(name)
        if estimate is None:
            said = f"{times * getattr(fabric, name):.4g} {unit}  (that of {like})"
        else:
            said = f"{times * estimate.value:.4g} +- {times * estimate.error:.2g} {unit}  ({estimate.source})"
        lines.append(f"{name:<15}{said}")
    return "\n".join([*lines, *(f"note: {note}" for note in measured.notes)])


def fabric_toml(measured: Measured, fabric: Fabric) -> str:
    """Return the [fabric.NAME] table of a scene file, in SI units, with uncertainties as remarks."""
    quoted = fabric.name.replace("\\", "\\\\").replace('"', '\\"')
    lines = [f'[fabric."{quoted}"]']
    for entry in fields(Fabric):
        value = getattr(fabric, entry.name)
        if entry.name == "name" or value == entry.default:
            continue
        estimate = measured.values.get(entry.name)
        remark = "" if estimate is None else f"  # +- {estimate.error:.2g}; {estimate.source}"
        lines.append(f"{entry.name} = {json.dumps(value)}{remark}")
    return "\n".join([*lines, *(f"# {note}" for note in measured.notes)]) + "\n"
