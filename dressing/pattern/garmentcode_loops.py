"""Loop directions of pattern files that do not promise them.

The direction of a loop says which side of the fabric is the right one, and with it which ends of two edges
meet in a seam. Files without `normalized_edge_loops` may be drawn with that meaning, as older ones are, or
without (every loop is then to be read counter-clockwise). The seams decide: the reading under which matching
ends lie closer together before sewing is taken.
"""

from dataclasses import replace

import numpy as np

from toile.dressing.pattern.pattern import Arc, Cubic, Curve, Panel, Pattern, Polyline, Quadratic
from toile.dressing.pattern.pattern_outline import is_clockwise, to_world
from toile.dressing.pattern.seam import EdgePart, Seam


def consistent_loops(pattern: Pattern) -> Pattern:
    """Return the pattern as drawn or with every clockwise loop reversed, whichever sews more plausibly."""
    clockwise = {panel.name for panel in pattern.panels if is_clockwise(panel)}
    if not clockwise:
        return pattern
    flipped = Pattern(
        name=pattern.name,
        panels=tuple(reversed_loop(p) if p.name in clockwise else p for p in pattern.panels),
        stitches=tuple(
            replace(
                stitch,
                edge_a=_renumbered(pattern, stitch.panel_a, stitch.edge_a, clockwise),
                edge_b=_renumbered(pattern, stitch.panel_b, stitch.edge_b, clockwise),
            )
            for stitch in pattern.stitches
        ),
        seams=tuple(
            Seam(*(tuple(_turned_part(pattern, part, clockwise) for part in run) for run in (seam.a, seam.b)))
            for seam in pattern.seams
        ),
        notes=(*pattern.notes, "Clockwise panel outlines were reversed: the seams fit better that way."),
    )
    # A thousandth in favour of the file, so that rounding does not decide between equals.
    return flipped if seam_gap(flipped) < 0.999 * seam_gap(pattern) else pattern


def reversed_loop(panel: Panel) -> Panel:
    """Return the same outline walked the other way: edge i becomes edge n - 1 - i."""
    edges = tuple(
        replace(
            edge,
            start=edge.end,
            end=edge.start,
            curve=_reversed_curve(edge.curve),
            notches=tuple(1.0 - notch for notch in reversed(edge.notches)),
        )
        for edge in reversed(panel.edges)
    )
    return replace(panel, edges=edges)


def seam_gap(pattern: Pattern) -> float:
    """Sum over the stitches of the distances [m] between the end points that will be joined."""
    total = 0.0
    for stitch in pattern.stitches:
        a, b = pattern.panel(stitch.panel_a), pattern.panel(stitch.panel_b)
        edge_a, edge_b = a.edges[stitch.edge_a], b.edges[stitch.edge_b]
        ends_a = to_world(a, np.array([a.vertices[edge_a.start], a.vertices[edge_a.end]]))
        ends_b = to_world(b, np.array([b.vertices[edge_b.start], b.vertices[edge_b.end]]))
        if not stitch.right_wrong:
            ends_b = ends_b[::-1]
        total += float(np.linalg.norm(ends_a - ends_b, axis=1).sum())
    return total


def _renumbered(pattern: Pattern, name: str, edge: int, reversed_names: set[str]) -> int:
    return len(pattern.panel(name).edges) - 1 - edge if name in reversed_names else edge


def _turned_part(pattern: Pattern, part: EdgePart, reversed_names: set[str]) -> EdgePart:
    """Return the same stretch of cloth in the numbers of a loop that may be reversed."""
    if part.panel not in reversed_names:
        return part
    edge = len(pattern.panel(part.panel).edges) - 1 - part.edge if _has_edge(pattern, part) else part.edge
    return EdgePart(part.panel, edge, 1.0 - part.start, 1.0 - part.end)


def _has_edge(pattern: Pattern, part: EdgePart) -> bool:
    """Tell whether a part is one of an edge that exists; the check of seams says what is wrong if not."""
    return part.edge < len(pattern.panel(part.panel).edges)


def _reversed_curve(curve: Curve) -> Curve:
    """Return the curve seen from its other end: u becomes 1 - u, and left becomes right."""
    if isinstance(curve, Quadratic):
        return Quadratic((1.0 - curve.control[0], -curve.control[1]))
    if isinstance(curve, Cubic):
        a, b = curve.control_a, curve.control_b
        return Cubic((1.0 - b[0], -b[1]), (1.0 - a[0], -a[1]))
    if isinstance(curve, Arc):
        return replace(curve, right=not curve.right)
    if isinstance(curve, Polyline):
        return Polyline(tuple((1.0 - u, -v) for u, v in reversed(curve.points)))
    return None
