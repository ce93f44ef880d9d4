"""How a body's file is to be read: what the user knows of it, and toile need not recognise."""

from dataclasses import dataclass

from toile.dressing.body.avatar_units import METRES_PER_UNIT
from toile.dressing.body.facing import FRONTS
from toile.geometry.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Reading:
    """How a body's file is read; None is recognised.

    Attributes
    ----------
    units
        "m", "dm", "cm" or "mm".
    up
        "y" or "z".
    front
        Axis of the file that the body faces: "x", "-x", "y", "-y", "z" or "-z".
    only, without
        Names of the parts (groups, objects, nodes) that are the body, and of those that are not, with
        wildcards.
    """

    units: str | None = None
    up: str | None = None
    front: str | None = None
    only: tuple[str, ...] = ()
    without: tuple[str, ...] = ()

    def check(self, file: str) -> None:
        """Raise InputError if a word is none that is known."""
        if self.units is not None and self.units not in METRES_PER_UNIT:
            raise InputError(
                f"{file}: unknown unit {self.units!r}; give one of {', '.join(METRES_PER_UNIT)}",
                field="units",
            )
        if self.up is not None and self.up not in ("y", "z"):
            raise InputError(f'{file}: unknown up axis {self.up!r}; give "y" or "z"', field="up")
        if self.front is not None and self.front not in FRONTS:
            raise InputError(
                f"{file}: unknown front {self.front!r}; give the axis that the body faces: "
                f"{', '.join(FRONTS)}",
                field="front",
            )


RECOGNISED = Reading()
"""Everything is recognised."""
