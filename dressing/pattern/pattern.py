"""A sewing pattern: flat panels placed in space, and the seams between their edges. All lengths in metres."""

from dataclasses import dataclass, replace

from toile.dressing.pattern.roles import EdgeRole, PanelRole
from toile.dressing.pattern.seam import Seam
from toile.geometry.by_value import ByValue

Point = tuple[float, float]


@dataclass(frozen=True)
class Quadratic:
    """Bezier edge with one control point (u, v), relative to the chord d = end - start.

    The point is start + u d + v q, where q is d turned left by 90 degrees.
    """

    control: Point


@dataclass(frozen=True)
class Cubic:
    """Bezier edge with two control points, each relative to the chord as in `Quadratic`."""

    control_a: Point
    control_b: Point


@dataclass(frozen=True)
class Arc:
    """Circular edge.

    Attributes
    ----------
    radius
        Radius [m]; at least half the distance between the end points.
    large
        True for the longer way round.
    right
        True if the angle about the centre increases along the edge: a minor arc bulges to the right of
        travel.
    """

    radius: float
    large: bool
    right: bool


@dataclass(frozen=True)
class Polyline:
    """Edge through points, each relative to the chord as in `Quadratic`; its own ends are not among them."""

    points: tuple[Point, ...]


Curve = Quadratic | Cubic | Arc | Polyline | None
"""None is a straight edge."""


@dataclass(frozen=True)
class Edge:
    """One side of a panel, from corner `start` to corner `end` (indices into the panel's vertices).

    `label` is the file's name for it, under which it can be pinned; `role` says what it lies on, None if that
    is nothing in particular. `notches` are marks that seams match, as fractions of its length. `piece` says
    what it was before it was cut: number of the edge, and where it starts and ends, as fractions of that.
    """

    start: int
    end: int
    curve: Curve = None
    label: str = ""
    role: EdgeRole | None = None
    notches: tuple[float, ...] = ()
    piece: tuple[int, float, float] | None = None


@dataclass(frozen=True)
class Fold:
    """A line of a panel along which it is folded at rest.

    Attributes
    ----------
    points
        Its corners in the panel's coordinates [m], from outline to outline: two, if it is straight.
    degrees
        By how much the cloth is turned there, -180 to 180: 0 is flat, 180 shut with the right sides facing
        each other, -180 shut with the wrong sides inside.
    stiffness
        Moment per length and turn in radians [N]; None takes that of the panel's fabric bent over 1 mm.
    line
        Number of the drawn line of the panel that it follows, in place of points.
    """

    points: tuple[Point, ...] = ()
    degrees: float = 180.0
    stiffness: float | None = None
    line: int | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel(ByValue):
    """A flat piece of fabric.

    Attributes
    ----------
    name
        Unique in its pattern.
    vertices
        Corners in the panel's own plane [m].
    edges
        One closed loop; edge i ends where edge i + 1 starts. The loop runs counter-clockwise seen from the
        right side of the fabric, so a loop that is clockwise in (x, y) shows its wrong side to +z.
    translation
        Place of the panel's origin in the world [m].
    rotation_degrees
        Turns about the world's x, then y, then z axis.
    label
        The file's word for the part of the body that the panel covers ("body", "leg", "arm", or "").
    role
        That part, whatever the file calls it; None if it is not known.
    warp_degrees
        Direction of the warp, counter-clockwise from the panel's +y.
    roll_radius
        Radius [m] of the cylinder about a line parallel to the panel's y axis that the panel is rolled around
        at the start, its right side outside and its x = 0 in its plane; None where it starts flat.
    folds
        Lines along which it is folded at rest; none crosses another.
    lines
        Lines that the file draws inside it [m], which folds may follow; by themselves they do nothing.
    """

    name: str
    vertices: tuple[Point, ...]
    edges: tuple[Edge, ...]
    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation_degrees: tuple[float, float, float] = (0.0, 0.0, 0.0)
    label: str = ""
    role: PanelRole | None = None
    warp_degrees: float = 0.0
    roll_radius: float | None = None
    folds: tuple[Fold, ...] = ()
    lines: tuple[tuple[Point, ...], ...] = ()


@dataclass(frozen=True)
class Stitch:
    """A seam between two whole edges.

    The end of edge a joins the start of edge b (right side to right side); with `right_wrong` start joins
    start. Edges of different length are gathered. Two edges of one panel that share a corner make a dart.
    """

    panel_a: str
    edge_a: int
    panel_b: str
    edge_b: int
    right_wrong: bool = False

    @property
    def name(self) -> str:
        """Such as "left_sleeve_f.0 - left_sleeve_b.5"."""
        return f"{self.panel_a}.{self.edge_a} - {self.panel_b}.{self.edge_b}"

    def partner(self, panel: str) -> str | None:
        """Return the panel that it sews to a panel, None if that is not in it."""
        if panel not in (self.panel_a, self.panel_b):
            return None
        return self.panel_b if self.panel_a == panel else self.panel_a


@dataclass(frozen=True, kw_only=True, eq=False)
class Pattern(ByValue):
    """Panels and stitches of one garment.

    `seams` join runs of edges beside the stitches, which join whole ones; `notes` say what the reader had to
    assume, one sentence each.
    """

    name: str
    panels: tuple[Panel, ...]
    stitches: tuple[Stitch, ...]
    notes: tuple[str, ...] = ()
    seams: tuple[Seam, ...] = ()

    def panel(self, name: str) -> Panel:
        """Return the panel of that name. Raises KeyError."""
        for panel in self.panels:
            if panel.name == name:
                return panel
        raise KeyError(name)

    def moved(self, way: tuple[float, float, float], note: str) -> "Pattern":
        """Return the pattern with all panels moved [m], and a note on it."""
        x, y, z = way
        panels = []
        for panel in self.panels:
            px, py, pz = panel.translation
            panels.append(replace(panel, translation=(px + x, py + y, pz + z)))
        return replace(self, panels=tuple(panels), notes=(*self.notes, note))
