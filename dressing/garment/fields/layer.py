"""What users say of layers that belong to cloth: interlining, lining, facing, hems."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from toile.dressing.garment.fields.where import check_where
from toile.engine.cloth.fabric import Fabric
from toile.geometry.arrays import Int
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, shown


@dataclass(frozen=True, kw_only=True)
class Layer:
    """A further layer of fabric on a part of a garment, on the wrong side of it and of layers named before.

    It moves with the cloth as one surface: weight, thickness, membrane and bending add up.

    Attributes
    ----------
    fabric
        Name of a fabric, or a Fabric; None: that of the cloth itself, as in a hem that is turned up.
    bond
        How much it is kept from sliding along the cloth, 0 to 1: 0 as a lining, 1 as if both were one plate;
        glue of a fusible interlining is between.
    panels, run, width, polygon
        Where, as of `Field`.

    Raises InputError naming the field that is at fault.
    """

    fabric: str | Fabric | None = None
    bond: float = 0.0
    panels: Sequence[str] = ()
    run: str | None = None
    width: float | None = None
    polygon: Sequence[tuple[float, float]] = ()

    def __post_init__(self) -> None:
        """Check every field."""
        if self.fabric is not None and not isinstance(self.fabric, str | Fabric):
            raise InputError(f"layer: fabric is a name or a Fabric, got {shown(self.fabric)}", field="fabric")
        if not (is_real(self.bond) and 0.0 <= self.bond <= 1.0):
            raise InputError(f"layer: bond must lie between 0 and 1, got {shown(self.bond)}", field="bond")
        check_where("layer", self.run, self.width, self.polygon)


class Layers(NamedTuple):
    """Layers of a garment's faces.

    Attributes
    ----------
    stack
        Stack of layers of every face, shape (t,).
    stacks
        Layers of every stack, outside first; their fabrics are names no longer.
    """

    stack: Int
    stacks: tuple[tuple[Layer, ...], ...]
