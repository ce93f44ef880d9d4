"""Values of the fabric that differ from place to place, or change with the animation, for the engine."""

import json
from typing import Any

import numpy as np
import numpy.typing as npt

from toile.blender_addon.problem import Problem

FIELD = "field_"
"""Begins the names of arrays from which the engine paints fields."""


class PaintedFields:
    """The fields of a garment object: painted by vertex groups and attributes, or the same everywhere.

    `by_vertex` are numbers per vertex by name: vertex groups, and attributes of points, also those of nodes.
    """

    def __init__(self, obj: Any, by_vertex: dict[str, npt.NDArray[Any]]) -> None:
        self._obj = obj
        self._values: list[list[float]] = [[] for _ in obj.toile.fields]
        self.arrays: dict[str, npt.NDArray[np.float64]] = {}
        for number, field in enumerate(obj.toile.fields):
            if not field.source:
                continue
            if field.source not in by_vertex:
                raise Problem(
                    f"'{obj.name}' has no vertex group and no attribute of points called '{field.source}' "
                    f"for its {field.quantity.replace('_', ' ')}: choose another"
                )
            values = by_vertex[field.source].astype(np.float64)
            self.arrays[f"{FIELD}{number}"] = np.clip(values, 0.0, 1.0)

    def see(self) -> None:
        """Note the values in the present frame."""
        for values, field in zip(self._values, self._obj.toile.fields, strict=True):
            values.append(field.high)

    def toml(self, fps: float) -> list[str]:
        """Return the tables of a scene file."""
        lines: list[str] = []
        for number, (field, values) in enumerate(zip(self._obj.toile.fields, self._values, strict=True)):
            # As in the panel, bending is in micronewton metres.
            size = 1e-6 if field.quantity.startswith("bending") else 1.0
            value = f"{size * values[0]:.9g}"
            if field.source:
                low = f"{size * field.low:.9g}"
                value = f"{{ attribute = {json.dumps(str(number))}, low = {low}, high = {value} }}"
            elif len(set(values)) > 1:
                times = ", ".join(f"{frame / fps:.9g}" for frame in range(len(values)))
                keyed = ", ".join(f"{size * each:.9g}" for each in values)
                value = f"{{ times = [{times}], values = [{keyed}] }}"
            lines += ["[[garment.field]]", f"{field.quantity} = {value}"]
        return lines
