"""Fabric presets, and the check that a user's own fabric is physical."""

import csv
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import NamedTuple

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.garment.fabric_limits import wrong_number
from toile.dressing.garment.stretch_check import CURVES, unlike_cloth, wrong_curve
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError

DEFAULT_FABRIC = "cotton-poplin"


class DrapeBand(NamedTuple):
    """Range of a fabric's Cusick drape coefficient [%], and whether it was estimated, not measured."""

    low: float
    high: float
    estimated: bool


def fabrics() -> dict[str, Fabric]:
    """Return all presets by name, in the order of fabrics.csv (where the sources are)."""
    return dict(_presets())


@cache
def _presets() -> dict[str, Fabric]:
    return {row["name"]: _from_row(row) for row in _rows()}


def drape_bands() -> dict[str, DrapeBand]:
    """Return the range of the drape coefficient of the presets that have one, by name."""
    return {
        row["name"]: DrapeBand(float(row["DC_low"]), float(row["DC_high"]), "est(DC)" in row["source"])
        for row in _rows()
        if row["DC_low"] and row["DC_high"]
    }


def fabric(name: str) -> Fabric:
    """Return the preset of that name. Raises InputError with the nearest names."""
    presets = fabrics()
    if name not in presets:
        raise InputError(unknown_name("fabric", name, presets), field="fabric")
    return presets[name]


def invalid_field(fabric: Fabric) -> tuple[str, str] | None:
    """Return the first field that no cloth has and what is wrong with it, or None if the fabric is fine."""
    for entry in fields(fabric):
        if entry.name != "name":
            value = getattr(fabric, entry.name)
            is_curve = entry.name in CURVES
            wrong = wrong_curve(value) if is_curve else wrong_number(entry.name, value)
            if wrong is not None:
                return entry.name, wrong
    return unlike_cloth(fabric)


def checked_fabric(fabric: Fabric) -> Fabric:
    """Return the fabric unchanged. Raises InputError naming its first unphysical field."""
    invalid = invalid_field(fabric)
    if invalid is not None:
        raise InputError(f"fabric '{fabric.name}': {invalid[0]} {invalid[1]}", field=f"fabric.{invalid[0]}")
    return fabric


def fabric_table() -> str:
    """Return the presets as a text table for people."""
    head = ("name", "g/m2", "thickness", "stretch warp/weft", "shear", "bending warp/weft/bias")
    units = ("", "", "mm", "N/m", "N/m", "uN m")
    rows = [head, units]
    for preset in fabrics().values():
        bending = (preset.bending_warp, preset.bending_weft, preset.bending_bias)
        rows.append(
            (
                preset.name + (" *" if preset.name == DEFAULT_FABRIC else ""),
                f"{preset.areal_density * 1e3:.0f}",
                f"{preset.thickness * 1e3:.2f}",
                f"{preset.stretch_warp:g} / {preset.stretch_weft:g}",
                f"{preset.shear:g}",
                " / ".join(f"{rigidity * 1e6:.3g}" for rigidity in bending),
            )
        )
    widths = [max(len(row[column]) for row in rows) for column in range(len(head))]
    lines = [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    ]
    return "\n".join([*lines, "", "* used where no fabric is named; own fabrics go into a scene file"])


def _rows() -> list[dict[str, str]]:
    """Return the lines of fabrics.csv by column."""
    lines = (Path(__file__).resolve().parent / "fabrics.csv").read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def _from_row(row: dict[str, str]) -> Fabric:
    """Return the fabric of one line of the table, converted to SI."""
    calibrated = float(row["D_factor"]) * 1e-6
    return Fabric(
        name=row["name"],
        areal_density=float(row["areal_density_kg_m2"]),
        thickness=float(row["thickness_mm"]) * 1e-3,
        bending_warp=float(row["D_warp_uNm"]) * calibrated,
        bending_weft=float(row["D_weft_uNm"]) * calibrated,
        bending_bias=float(row["D_bias_uNm"]) * calibrated,
        stretch_warp=float(row["C11_N_m"]),
        stretch_weft=float(row["C22_N_m"]),
        shear=float(row["G_N_m"]),
    )
