"""Fields: values on regions of cloth that differ from those of its fabric.

A region is a label of faces, as a panel is. Remeshing keeps the borders of regions, so that a value that ends
sharply goes on ending there, and no area changes sides.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from toile.engine.cloth.fields.keyed import Keyed, later, value_at
from toile.engine.cloth.fields.paintings import Painting
from toile.geometry.arrays import Bool, Float, Int

Value = float | Keyed | Painting
"""One number, one over time, or one for every point."""
QUADRATURE = np.array([[4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]]) / 6.0
"""Corner weights of the points at which faces are sampled: their mean is exact for quadratics."""


@dataclass(frozen=True, kw_only=True)
class Fields:
    """Values on the regions of a cloth.

    Attributes
    ----------
    region
        Region of every face, shape (t,).
    values
        Per region: name of a quantity to its value there. Quantities are the fields of `Fabric`, and
        "rest_warp" and "rest_weft", by which the rest shape is scaled, and "pressure" [Pa].
    sampled
        Values of painted quantities on all faces, by name, shape (t,); of no meaning elsewhere.
    """

    region: Int
    values: tuple[Mapping[str, Value], ...]
    sampled: Mapping[str, Float] = field(default_factory=dict)

    def names(self) -> set[str]:
        """Return the quantities that have a value anywhere."""
        return {name for values in self.values for name in values}

    def where(self, name: str) -> Bool:
        """Mark the faces on which a quantity has a value, shape (t,)."""
        return np.array([name in values for values in self.values], bool)[self.region]

    def over(self, name: str, base: Float, seconds: float = 0.0) -> Float:
        """Return a quantity on all faces at a time [s], shape (t,), given what it is without fields."""
        result = base
        for number, values in enumerate(self.values):
            if name not in values:
                continue
            if result is base:
                result = base.copy()
            value, own = values[name], self.region == number
            if isinstance(value, int | float | Keyed):
                result[own] = value_at(value, seconds)
            else:
                result[own] = self.sampled[name][own]
        return result

    def is_keyed(self, names: Sequence[str]) -> bool:
        """Whether one of some quantities changes over time anywhere."""
        return any(isinstance(values.get(name), Keyed) for values in self.values for name in names)

    def later(self, seconds: float) -> "Fields":
        """Return the fields of a film whose frame 0 is at a time [s]."""
        return replace(
            self,
            values=tuple(
                {
                    name: later(value, seconds) if isinstance(value, int | float | Keyed) else value
                    for name, value in values.items()
                }
                for values in self.values
            ),
        )

    def on(self, region: Int, corners: Float) -> "Fields":
        """Return the fields of the same cloth with other faces.

        `region` is the region of every face, shape (t,), and `corners` are theirs in rest space [m], shape
        (t, 3, 3).
        """
        sampled: dict[str, Float] = {}
        for number, name, painting in self._paintings():
            own = np.flatnonzero(region == number)
            points = np.einsum("qc,tci->tqi", QUADRATURE, corners[own])
            found = painting.at(points.reshape(-1, 3)).reshape(-1, len(QUADRATURE)).mean(axis=1)
            sampled.setdefault(name, np.zeros(len(region)))[own] = found
        return replace(self, region=region, sampled=sampled)

    def _paintings(self) -> Iterator[tuple[int, str, Painting]]:
        for number, values in enumerate(self.values):
            for name, value in values.items():
                if not isinstance(value, int | float | Keyed):
                    yield number, name, value

    @staticmethod
    def together(parts: "Sequence[Fields | None]", faces: Sequence[int]) -> "Fields | None":
        """Return the fields of cloths that become one, of so many faces each; None if none has any."""
        if all(part is None for part in parts):
            return None
        whole = [
            part or Fields(region=np.zeros(count, np.int32), values=({},))
            for part, count in zip(parts, faces, strict=True)
        ]
        first = np.cumsum([0] + [len(part.values) for part in whole])
        names = {name for part in whole for name in part.sampled}
        return Fields(
            region=np.concatenate(
                [part.region + number for part, number in zip(whole, first, strict=False)]
            ).astype(np.int32),
            values=tuple(values for part in whole for values in part.values),
            sampled={
                name: np.concatenate([part.sampled.get(name, np.zeros(len(part.region))) for part in whole])
                for name in names
            },
        )
