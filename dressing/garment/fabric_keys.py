"""Keys of a [fabric.NAME] table of scene files: the fields of `Fabric`."""

from dataclasses import fields
from typing import Any

from toile.dressing.garment.stretch_check import CURVES
from toile.engine.cloth.fabric import Fabric

FABRIC_KEYS: dict[str, tuple[Any, str]] = {
    "like": (str, "preset that supplies every value not set here"),
    **{
        entry.name: (list, f"[[strain, N/m], ...]: see toile.Fabric.{entry.name}")
        if entry.name in CURVES
        else ((int, float), f"see toile.Fabric.{entry.name}, SI units")
        for entry in fields(Fabric)
        if entry.name != "name"
    },
}
"""Key to (accepted types, meaning)."""
