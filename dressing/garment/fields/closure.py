"""What users say of closures: buttons, snaps, hooks, zips."""

from dataclasses import dataclass

from toile.engine.cloth.fields.keyed import Keyed
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, is_whole, shown

KINDS = ("buttons", "snaps", "zip")
DISTANCE = {"buttons": 0.003, "snaps": 0.0025, "zip": 0.003}
"""How far apart the two sides are when closed [m]: cloth between them, a shank, the tapes of a zip."""
STIFFNESS = {"buttons": 3000.0, "snaps": 3000.0, "zip": 3e5}
"""Of each pair [N/m], or of a zip per length [N/m^2]."""
MOST = {"buttons": 60.0, "snaps": 15.0, "zip": 6000.0}
"""Largest force of each pair [N], or of a zip per length [N/m]: beyond it gives way."""
MOST_COUNT = 200


@dataclass(frozen=True, kw_only=True)
class Closure:
    """Two edges of a garment that are fastened to each other, in a row.

    Attributes
    ----------
    kind
        "buttons" (`over` lies on the right side of `under`, or on its wrong side), "snaps" (the same, less
        strong; hooks and eyes alike) or "zip" (edge to edge, wherever they come from).
    over, under
        Edges of one panel each, such as "front.2", a label or "left.1[0:0.5]". As in seams, `over` is walked
        along the loop of its panel and `under` against it, from where the row begins; "-left.1" turns an edge
        around.
    count
        How many buttons or snaps.
    inset
        How far inside of its edges they are [m].
    ends
        How far the first and the last of them are from the ends of the edges [m]; None: half of the distance
        between two.
    wrong_side
        Whether `over` lies on the wrong side of `under`.
    closed
        Share of the row that is closed, from where it begins, 0 to 1; `Keyed` in a film. A zip is closed to
        there, buttons and snaps one after the other.
    distance
        How far apart the two sides are when closed [m].
    stiffness
        Force per distance of each pair [N/m], or of a zip per length as well [N/m^2].
    most
        Largest force of each pair [N], or of a zip per length [N/m].

    Raises InputError naming the field that is at fault.
    """

    kind: str
    over: str
    under: str
    count: int | None = None
    inset: float = 0.0
    ends: float | None = None
    wrong_side: bool = False
    closed: float | Keyed = 1.0
    distance: float | None = None
    stiffness: float | None = None
    most: float | None = None

    def __post_init__(self) -> None:
        """Check every field."""
        if self.kind not in KINDS:
            raise InputError(
                f"closure: kind must be one of {', '.join(KINDS)}, got {shown(self.kind)}", field="kind"
            )
        for name in ("over", "under"):
            if not isinstance(getattr(self, name), str) or not getattr(self, name):
                raise InputError(f"closure: {name} must name edges, such as front.2", field=name)
        is_zip = self.kind == "zip"
        if is_zip and (self.count is not None or self.inset or self.ends is not None or self.wrong_side):
            raise InputError(
                "closure: a zip runs along its edges; count, inset, ends and wrong_side are for buttons and "
                "snaps",
                field="kind",
            )
        if not is_zip and not (is_whole(self.count) and 1 <= (self.count or 0) <= MOST_COUNT):
            raise InputError(
                f"closure: count of {self.kind} must be a whole number from 1 to {MOST_COUNT}, got "
                f"{shown(self.count)}",
                field="count",
            )
        if not isinstance(self.wrong_side, bool):
            raise InputError("closure: wrong_side must be true or false", field="wrong_side")
        _check("inset", self.inset, 0.0, 0.5)
        _check("ends", self.ends, 0.0, 2.0)
        _check("distance", self.distance, 0.0, 0.05)
        _check("stiffness", self.stiffness, 1.0, 1e7)
        _check("most", self.most, 1e-3, 1e6)
        for value in self.closed.values if isinstance(self.closed, Keyed) else (self.closed,):
            _check("closed", value, 0.0, 1.0)


def _check(name: str, value: float | None, low: float, high: float) -> None:
    """Raise InputError unless a number lies within limits; None stands for the usual one."""
    if value is not None and not (is_real(value) and low <= value <= high):
        raise InputError(
            f"closure: {name} must lie between {low:g} and {high:g}, got {shown(value)}", field=name
        )
