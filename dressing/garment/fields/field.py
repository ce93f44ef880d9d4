"""What users say of parts of a garment: fields, elastic, gas, and pins with times."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from pathlib import Path

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.garment.fields.closure import Closure
from toile.dressing.garment.fields.layer import Layer
from toile.dressing.garment.fields.patch import Patch
from toile.dressing.garment.fields.where import check_where
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.fields.keyed import Keyed
from toile.geometry.arrays import Float
from toile.geometry.by_value import ByValue
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, shown

OF_FABRIC = tuple(entry.name for entry in fields(Fabric) if entry.name != "name")
QUANTITIES = (*OF_FABRIC, "rest_warp", "rest_weft", "pressure", "pull")
"""What a field may set: every number of a fabric, scale of the rest shape, pressure [Pa], pull [N/m^3]."""
KEYABLE = ("stretch_warp", "stretch_weft", "shear", "compression", "rest_warp", "rest_weft", "pressure")
POSITIVE = ("areal_density", "thickness", "stretch_warp", "stretch_weft")
"""Quantities without which there is no cloth."""
LEAST_REST, MOST_REST = 0.1, 5.0
"""Limits of a scale of the rest shape."""
MOST_PRESSURE = 1e5
"""Largest pressure [Pa]: an atmosphere."""
MOST_PULL = 1e6
"""Largest pull [N/m^3]: contact is twice as stiff."""
FIRM = 1e6
"""Pull of a hold, unless it is told [N/m^3]: a skirt of 100 g on a band of 1 cm sinks by 0.1 mm."""


@dataclass(frozen=True)
class Painted:
    """Values at vertices of a garment: `low` where an attribute of its file is 0, `high` where it is 1."""

    attribute: str
    low: float = 0.0
    high: float = 1.0


@dataclass(frozen=True)
class Textured:
    """Values from an image in pattern coordinates: `low` where it is black, `high` where it is white.

    Attributes
    ----------
    image
        A PNG file, or brightness from 0 to 1, the upper row first, shape (rows, columns).
    low, high
        Values of black and white.
    box
        Rectangle that it covers, in the panel's own coordinates [m]: left, lower, right, upper. None: the
        panel's bounding box.
    """

    image: Path | Float
    low: float = 0.0
    high: float = 1.0
    box: tuple[float, float, float, float] | None = None


FieldValue = float | Keyed | Painted | Textured


@dataclass(frozen=True, kw_only=True, eq=False)
class Field(ByValue):
    """Values on a part of a garment that differ from its fabric's; of several, the last one counts.

    Attributes
    ----------
    values
        Quantity to its value there: any number of `Fabric`; "rest_warp" and "rest_weft", lengths at rest over
        those in the pattern; "pressure" towards the right side [Pa]; "pull" to where a mesh garment starts, a
        stiffness per area [N/m^3]. A value is a number, or `Keyed`, `Painted` or `Textured`.
    panels
        Names of the panels; empty: all, or those of the run.
    run
        Edges such as "waist", a label, or "front.3 + back.1[0:0.5]": with `width`, the band beside them.
    width
        Of that band [m].
    polygon
        Corners in the panel's own coordinates [m]: the part of the panels within.

    Raises InputError naming the field that is at fault.
    """

    values: Mapping[str, FieldValue]
    panels: Sequence[str] = ()
    run: str | None = None
    width: float | None = None
    polygon: Sequence[tuple[float, float]] = ()

    def __post_init__(self) -> None:
        """Check every value."""
        if not self.values:
            raise InputError(f"field: sets nothing; set one of {', '.join(QUANTITIES)}", field="field")
        for name, value in self.values.items():
            _check_value(name, value)
        numbers = {
            name: float(value) if isinstance(value, int) else value for name, value in self.values.items()
        }
        object.__setattr__(self, "values", numbers)
        check_where("field", self.run, self.width, self.polygon)


@dataclass(frozen=True, kw_only=True, eq=False)
class Elastic(ByValue):
    """Elastic sewn along edges.

    Attributes
    ----------
    run
        Edges such as "waist", a label, or "front.3 + back.1[0:0.5]".
    rest
        Its length at rest over that of the edges in the pattern.
    stiffness
        Its tension per strain [N].
    """

    run: str
    rest: float | Keyed
    stiffness: float | Keyed

    def __post_init__(self) -> None:
        """Check every number. Raises InputError naming the field."""
        _check_range("elastic: rest", self.rest, LEAST_REST, MOST_REST, "rest")
        _check_range("elastic: stiffness", self.stiffness, 1e-3, 1e4, "stiffness", " N")


@dataclass(frozen=True, kw_only=True)
class Filling:
    """Gas in a closed garment.

    Attributes
    ----------
    pressure
        Constant pressure above that outside [Pa]; or
    volume
        volume that the gas has outside [m^3]: inside, its pressure goes with 1/V.
    """

    pressure: float | Keyed | None = None
    volume: float | Keyed | None = None

    def __post_init__(self) -> None:
        """Check that one is given. Raises InputError."""
        if (self.pressure is None) == (self.volume is None):
            raise InputError("gas: give its pressure or its volume, one of them", field="gas")
        if self.pressure is not None:
            _check_range("gas: pressure", self.pressure, -MOST_PRESSURE, MOST_PRESSURE, "pressure", " Pa")
        if self.volume is not None:
            _check_range("gas: volume", self.volume, 1e-6, 100.0, "volume", " m3")


@dataclass(frozen=True, kw_only=True, eq=False)
class Hold(ByValue):
    """Nodes held in a film where they are at its start, for a time.

    Attributes
    ----------
    run
        Edges such as "waist", a label, or "front.3"; or
    panels
        whole panels by their names.
    frames
        First frame in which they are held and first in which they are free, or None.
    share
        Instead of frames: how much of the stiffness acts over the film, 0 to 1.
    stiffness
        Per area [N/m^3]; soft pins have less.
    follow
        Whether places go along with the body, or stay in the room.
    """

    run: str | None = None
    panels: Sequence[str] = ()
    frames: tuple[int, int] | None = None
    share: Keyed | None = None
    stiffness: float = FIRM
    follow: bool = True

    def __post_init__(self) -> None:
        """Check every field. Raises InputError naming it."""
        if (self.run is None) == (not self.panels):
            raise InputError("hold: give a run of edges or panels, one of them", field="run")
        if (self.frames is None) == (self.share is None):
            raise InputError("hold: give frames, such as [0, 10], or share, one of them", field="frames")
        if self.frames is not None and not (
            len(self.frames) == 2 and all(type(f) is int for f in self.frames)
            and 0 <= self.frames[0] < self.frames[1]
        ):  # fmt: skip
            raise InputError(
                f"hold: frames are the first that is held and the first that is free, got {self.frames!r}",
                field="frames",
            )
        if self.share is not None:
            _check_range("hold: share", self.share, 0.0, 1.0, "share")
        _check_range("hold: stiffness", self.stiffness, 0.0, MOST_PULL, "stiffness", " N/m3")

    def shares(self, fps: float) -> Keyed:
        """Return how much of the stiffness acts over a film of so many frames per second."""
        if self.share is not None:
            return self.share
        assert self.frames is not None
        start, end = (frame / fps for frame in self.frames)
        # From one frame to the next it comes or goes.
        times, values = [start, end - 1.0 / fps, end], [1.0, 1.0, 0.0]
        if self.frames[0] > 0:
            times, values = [start - 1.0 / fps, *times], [0.0, *values]
        kept = [k for k in range(len(times)) if k == 0 or times[k] > times[k - 1]]
        return Keyed(tuple(times[k] for k in kept), tuple(values[k] for k in kept))


@dataclass(frozen=True, kw_only=True)
class Parts:
    """All that a garment says of its parts."""

    fields: tuple[Field, ...] = ()
    elastic: tuple[Elastic, ...] = ()
    holds: tuple[Hold, ...] = ()
    gas: Filling | None = None
    closures: tuple[Closure, ...] = ()
    patches: tuple[Patch, ...] = ()
    layers: tuple[Layer, ...] = ()

    @property
    def attributes(self) -> tuple[str, ...]:
        """Names of the attributes of vertices that fields are painted from."""
        values = [value for field in self.fields for value in field.values.values()]
        return tuple(dict.fromkeys(value.attribute for value in values if isinstance(value, Painted)))

    def __bool__(self) -> bool:
        """Whether there is anything."""
        return any(vars(self).values())


def _check_value(name: str, value: FieldValue) -> None:
    """Raise InputError unless a quantity can have a value."""
    if name not in QUANTITIES:
        raise InputError(f"field: {unknown_name('quantity', name, QUANTITIES)}", field=name)
    if isinstance(value, Keyed) and name not in KEYABLE:
        raise InputError(f"field: {name} cannot change over a film, only {', '.join(KEYABLE)}", field=name)
    if isinstance(value, Painted | Textured):
        if name == "pressure":
            raise InputError("field: pressure is a number, or keyed; give regions their own", field=name)
        for end in (value.low, value.high):
            _check_limits(name, end)
    else:
        _check_limits(name, value)


def _check_limits(name: str, value: float | Keyed) -> None:
    low, high = 0.0, math.inf
    if name.startswith("rest_"):
        low, high = LEAST_REST, MOST_REST
    elif name == "pressure":
        low, high = -MOST_PRESSURE, MOST_PRESSURE
    elif name == "pull":
        high = MOST_PULL
    elif name == "compression":
        high = 1.0
    elif name in POSITIVE:
        low = 1e-9
    _check_range(f"field: {name}", value, low, high, name)


def _check_range(
    what: str, value: float | Keyed, low: float, high: float, field: str, unit: str = ""
) -> None:
    """Raise InputError unless all of a value lies in [low, high] and its times rise."""
    if isinstance(value, Keyed):
        times = value.times
        if not times or len(times) != len(value.values) or not all(map(_is_number, times)):
            raise InputError(f"{what}: a key has a time and a value each; give as many of both", field=field)
        if any(b <= a for a, b in pairwise(times)):
            raise InputError(f"{what}: times of keys must rise, got {list(times)!r}", field=field)
    for number in value.values if isinstance(value, Keyed) else (value,):
        if not _is_number(number) or not low <= number <= high:
            between = f"at least {low:g}" if high == math.inf else f"between {low:g} and {high:g}"
            raise InputError(f"{what} must be {between}{unit}, got {shown(number)}", field=field)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and is_real(value)
