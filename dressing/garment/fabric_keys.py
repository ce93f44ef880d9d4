"""Keys of a [fabric.NAME] table of scene files: the fields of `Fabric`."""

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.garment.fabrics import fabrics
from toile.dressing.garment.stretch_check import CURVES
from toile.dressing.weave.read_weave import read_weave
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError

FABRIC_KEYS: dict[str, tuple[Any, str]] = {
    "like": (str, "preset that supplies every value not set here"),
    "yarn": (dict, '{ warp = "cotton:20tex", ends_per_cm = 25, picks_per_cm = 25 }: see docs/weave.md'),
    **{
        entry.name: (list, f"[[strain, N/m], ...]: see toile.Fabric.{entry.name}")
        if entry.name in CURVES
        else ((int, float), f"see toile.Fabric.{entry.name}, SI units")
        for entry in fields(Fabric)
        if entry.name != "name"
    },
}
"""Key to (accepted types, meaning)."""


SUPPLIERS = ("like", "yarn")
"""Keys that supply values for others."""


def supplied_values(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that a preset supplies, or a weave, which goes before. Raises InputError."""
    values: dict[str, Any] = {}
    if "like" in table:
        if table["like"] not in fabrics():
            raise InputError(unknown_name("fabric", table["like"], fabrics()), field="like")
        values |= asdict(fabrics()[table["like"]])
    if "yarn" in table:
        values |= asdict(read_weave(table["yarn"]).fabric("woven"))
    return values
