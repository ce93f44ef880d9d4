"""Helpers of the drafts: outlines with named sides in absolute points, mirroring, sewing by name."""

import dataclasses
import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from toile.dressing.body.measurements import Measurements
from toile.dressing.pattern.pattern import Arc, Cubic, Curve, Edge, Panel, Pattern, Point, Quadratic, Stitch
from toile.dressing.pattern.pattern_curve import edge_length, relative_point
from toile.dressing.pattern.roles import EdgeRole, PanelRole
from toile.geometry.errors import InputError

DRAFT_HEIGHT = 1.70
"""Body height [m] that eases and gaps are stated for; they grow in proportion to the height."""

QUARTER_ELLIPSE = 0.5523
"""Length of the handles of a cubic that follows a quarter of an ellipse, as a fraction of the half axes."""


@dataclass(frozen=True, kw_only=True)
class Side:
    """One edge of a draft [m]: straight, a Bezier curve (one or two absolute control points), or an arc."""

    name: str
    start: Point
    end: Point
    controls: tuple[Point, ...] = ()
    arc: Arc | None = None
    label: str = ""
    role: EdgeRole | None = None

    def backwards(self) -> "Side":
        """Return the same curve, run from end to start."""
        arc = None if self.arc is None else dataclasses.replace(self.arc, right=not self.arc.right)
        return dataclasses.replace(
            self, start=self.end, end=self.start, controls=self.controls[::-1], arc=arc
        )

    def mirrored(self) -> "Side":
        """Return the reflection x -> -x; "left" and "right" change places in name and label."""
        return Side(
            name=_swap_sides(self.name),
            start=_reflect(self.start),
            end=_reflect(self.end),
            controls=tuple(_reflect(point) for point in self.controls),
            arc=None if self.arc is None else dataclasses.replace(self.arc, right=not self.arc.right),
            label=_swap_sides(self.label),
            role=self.role,
        )

    def edge(self, index: int, count: int) -> Edge:
        """Return the edge of a panel whose corner `index` is the start of this side."""
        curve: Curve = self.arc
        if self.controls and self.start == self.end:
            raise InputError(
                f"the draft's edge '{self.name}' has no length; check the measurements beside it"
            )
        relative = [relative_point(self.start, self.end, point) for point in self.controls]
        if len(relative) == 1:
            curve = Quadratic(relative[0])
        elif len(relative) == 2:
            curve = Cubic(relative[0], relative[1])
        return Edge(index, (index + 1) % count, curve, self.label, self.role)

    @property
    def length(self) -> float:
        """Length [m]."""
        return edge_length(Panel(name="", vertices=(self.start, self.end), edges=(self.edge(0, 2),)), 0)


@dataclass(frozen=True, kw_only=True)
class Draft:
    """A panel whose sides have names, so that seams can be written down in words.

    The sides run counter-clockwise in (x, y); `turned` gives the panel that shows its wrong side to +z. It is
    placed tilted, its lower end forward, then turned about the vertical by its azimuth, from the front to the
    left, then about z.
    """

    name: str
    sides: tuple[Side, ...]
    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turn_degrees: float = 0.0
    tilt_degrees: float = 0.0
    azimuth_degrees: float = 0.0
    label: str = ""
    role: PanelRole | None = None

    def turned(self) -> "Draft":
        """Return the panel with the loop reversed: its right side faces -z."""
        return dataclasses.replace(self, sides=tuple(side.backwards() for side in reversed(self.sides)))

    def mirrored(self) -> "Draft":
        """Return the panel for the other side of the body, with the same side of the fabric outside."""
        x, y, z = self.translation
        return dataclasses.replace(
            self,
            name=_swap_sides(self.name),
            sides=tuple(side.mirrored().backwards() for side in reversed(self.sides)),
            translation=(-x, y, z),
            turn_degrees=-self.turn_degrees,
            azimuth_degrees=-self.azimuth_degrees,
        )

    def side_index(self, name: str) -> int:
        """Return the edge number of a side. Raises KeyError."""
        for index, side in enumerate(self.sides):
            if side.name == name:
                return index
        raise KeyError(f"{self.name}: no side {name}")

    def panel(self) -> Panel:
        """Return the finished panel."""
        count = len(self.sides)
        return Panel(
            name=self.name,
            vertices=tuple(side.start for side in self.sides),
            edges=tuple(side.edge(index, count) for index, side in enumerate(self.sides)),
            translation=self.translation,
            rotation_degrees=(-self.tilt_degrees, self.azimuth_degrees, self.turn_degrees),
            label=self.label,
            role=self.role,
        )


def closed_loop(corners: Sequence[tuple[Point, str, tuple[Point, ...], str]]) -> tuple[Side, ...]:
    """Sides from corners (point, name of the side that leaves it, its control points, its label)."""
    return tuple(
        Side(name=name, start=start, end=corners[(i + 1) % len(corners)][0], controls=controls, label=label)
        for i, (start, name, controls, label) in enumerate(corners)
    )


def sew(
    name: str,
    drafts: Iterable[Draft],
    seams: Iterable[tuple[str, str, str, str]],
    notes: tuple[str, ...] = (),
) -> Pattern:
    """Return the pattern; a seam is (panel a, side of a, panel b, side of b)."""
    by_name = {draft.name: draft for draft in drafts}
    stitches = tuple(
        Stitch(a, by_name[a].side_index(side_a), b, by_name[b].side_index(side_b))
        for a, side_a, b, side_b in seams
    )
    return Pattern(
        name=name, panels=tuple(draft.panel() for draft in by_name.values()), stitches=stitches, notes=notes
    )


def mirrored_seams(seams: Iterable[tuple[str, str, str, str]]) -> list[tuple[str, str, str, str]]:
    """Return the same seams on the other side of the body."""
    return [(_swap_sides(a), _swap_sides(b), _swap_sides(c), _swap_sides(d)) for a, b, c, d in seams]


def find_root(function: Callable[[float], float], low: float, high: float) -> float:
    """Argument where a rising function crosses zero, by bisection; the nearer end if it has no zero there."""
    if function(low) >= 0.0:
        return low
    if function(high) <= 0.0:
        return high
    for _ in range(60):
        middle = (low + high) / 2.0
        if function(middle) < 0.0:
            low = middle
        else:
            high = middle
    return (low + high) / 2.0


def require_levels(garment: str, body: Measurements, levels: Sequence[str]) -> None:
    """Raise InputError unless all measurements are positive and the named levels rise in that order."""
    for field in dataclasses.fields(body):
        value = getattr(body, field.name)
        if isinstance(value, tuple):
            bad = not all(math.isfinite(component) for component in value)
        else:
            bad = not math.isfinite(value) or (value <= 0.0 and field.name != "arm_angle")
        if bad:
            raise InputError(
                f"{garment}: measurement {field.name} is {value}; give a positive length in metres",
                field=f"measurements.{field.name}",
            )
    for lower, upper in itertools.pairwise(levels):
        if getattr(body, lower) >= getattr(body, upper):
            raise InputError(
                f"{garment}: {lower} ({getattr(body, lower):.3f} m) is not below {upper} "
                f"({getattr(body, upper):.3f} m); the draft needs a body that stands upright",
                field=f"measurements.{lower}",
            )


def waist_notes(body: Measurements) -> tuple[str, ...]:
    """Return a sentence if the waistband has nothing to rest on."""
    if body.waist < 0.97 * body.hip:
        return ()
    return (
        f"The waist ({body.waist:.2f} m) is hardly narrower than the hip ({body.hip:.2f} m): "
        "only friction keeps the waistband up.",
    )


def _reflect(point: Point) -> Point:
    return -point[0], point[1]


def _swap_sides(text: str) -> str:
    """Exchange "left" and "right"."""
    return text.replace("left", "\0").replace("right", "left").replace("\0", "right")
