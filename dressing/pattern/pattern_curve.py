"""Edges of a panel as curves: their length, and points spaced evenly along them."""

from itertools import pairwise

import numpy as np

from toile.dressing.pattern.pattern import Arc, Cubic, Curve, Panel, Point, Polyline, Quadratic
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

NO_LENGTH = 1e-150
"""Below this, the square of a length is no number to divide by [m]."""
_SPANS = 64
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)


def edge_length(panel: Panel, edge: int) -> float:
    """Length of one edge [m]. Raises ValueError where an arc cannot reach from start to end."""
    side = panel.edges[edge]
    start, end = np.array(panel.vertices[side.start]), np.array(panel.vertices[side.end])
    if side.curve is None:
        return float(np.linalg.norm(end - start))
    if isinstance(side.curve, Arc):
        radius, _, _, sweep = _circle(start, end, side.curve)
        return abs(radius * sweep)
    if isinstance(side.curve, Polyline):
        return float(_walked(_absolute_points(start, end, side.curve.points))[-1])
    return float(_arc_lengths(_control_points(start, end, side.curve))[-1])


def edge_points(panel: Panel, edge: int, segments: int) -> Float:
    """Points evenly spaced by arc length [m], shape (segments + 1, 2), both end corners included exactly."""
    side = panel.edges[edge]
    start, end = np.array(panel.vertices[side.start]), np.array(panel.vertices[side.end])
    along = np.arange(segments + 1) / segments
    if side.curve is None:
        points = start + along[:, None] * (end - start)
    elif isinstance(side.curve, Arc):
        radius, centre, first, sweep = _circle(start, end, side.curve)
        angle = first + along * sweep
        points = centre + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    elif isinstance(side.curve, Polyline):
        points = points_at(_absolute_points(start, end, side.curve.points), along)
    else:
        control = _control_points(start, end, side.curve)
        points = _bezier(control, _parameters_at(control, along))
    points[0], points[-1] = start, end
    return np.ascontiguousarray(points)


def sagitta(panel: Panel, edge: int, segments: int) -> float:
    """Largest distance [m] of one edge from the chords between points spaced evenly along it."""
    if panel.edges[edge].curve is None:
        return 0.0
    points = edge_points(panel, edge, 2 * segments)
    middles = 0.5 * (points[:-1:2] + points[2::2])
    return float(np.linalg.norm(points[1::2] - middles, axis=1).max())


def relative_point(start: Point, end: Point, point: Point) -> Point:
    """Absolute point to (u, v) of start + u d + v q, d = end - start, q = (-d_y, d_x).

    Raises InputError where start and end are one point.
    """
    dx, dy = end[0] - start[0], end[1] - start[1]
    px, py = point[0] - start[0], point[1] - start[1]
    squared = dx * dx + dy * dy
    if squared < NO_LENGTH**2:
        raise InputError(
            f"a curved edge begins and ends in one point, ({start[0]:.4g}, {start[1]:.4g}) m; split it or "
            "move one of its ends"
        )
    return (px * dx + py * dy) / squared, (py * dx - px * dy) / squared


def points_at(polyline: Float, along: Float) -> Float:
    """Points of a polyline, shape (p, 2), at fractions of its length, shape (n,)."""
    walked = _walked(polyline)
    target = along * walked[-1]
    return np.column_stack([np.interp(target, walked, polyline[:, axis]) for axis in (0, 1)])


def polyline_curve(points: Float) -> Curve:
    """Return the curve of an edge through absolute points, its ends included, shape (p, 2)."""
    if len(points) < 3:
        return None
    start, end = (float(points[0, 0]), float(points[0, 1])), (float(points[-1, 0]), float(points[-1, 1]))
    return Polyline(tuple(relative_point(start, end, (float(x), float(y))) for x, y in points[1:-1]))


def cut_curve(panel: Panel, edge: int, fractions: list[float]) -> list[tuple[Curve, Point]]:
    """Cut an edge at rising fractions of its length, all within 0 and 1.

    Returns the curve of each of the pieces in order, relative to its own chord, and the point where it ends.
    """
    side = panel.edges[edge]
    first, last = panel.vertices[side.start], panel.vertices[side.end]
    start, end = np.array(first), np.array(last)
    bounds = np.array([0.0, *fractions, 1.0])
    if isinstance(side.curve, Quadratic | Cubic):
        control = _control_points(start, end, side.curve)
        bounds = _parameters_at(control, bounds)
        pieces = [_absolute_curve(_blossom(control, a, b)) for a, b in pairwise(bounds.tolist())]
    elif isinstance(side.curve, Arc):
        radius, centre, angle, sweep = _circle(start, end, side.curve)
        ends = angle + bounds * sweep
        corners = centre + radius * np.column_stack([np.cos(ends), np.sin(ends)])
        pieces = [
            (Arc(radius, abs(sweep) * (b - a) > np.pi, side.curve.right), (float(x), float(y)))
            for (a, b), (x, y) in zip(pairwise(bounds.tolist()), corners[1:], strict=True)
        ]
    elif isinstance(side.curve, Polyline):
        line = _absolute_points(start, end, side.curve.points)
        walked = _walked(line) / _walked(line)[-1]
        pieces = []
        for a, b in pairwise(bounds.tolist()):
            inner = line[(walked > a + 1e-9) & (walked < b - 1e-9)]
            ends = points_at(line, np.array([a, b]))
            pieces.append((polyline_curve(np.vstack([ends[:1], inner, ends[1:]])), _point(ends[1])))
    else:
        pieces = [(None, _point(start + b * (end - start))) for b in bounds[1:].tolist()]
    pieces[-1] = (pieces[-1][0], last)
    return pieces


def _point(point: Float) -> Point:
    return float(point[0]), float(point[1])


def _blossom(control: Float, a: float, b: float) -> Float:
    """Control points of a Bezier curve between the parameters a and b."""
    degree = len(control) - 1
    found = []
    for ends in range(degree + 1):
        level = control
        for t in [b] * ends + [a] * (degree - ends):
            level = (1.0 - t) * level[:-1] + t * level[1:]
        found.append(level[0])
    return np.array(found)


def _absolute_curve(control: Float) -> tuple[Curve, Point]:
    """Return a Bezier curve of absolute control points, and its end."""
    first, *inner, last = (_point(point) for point in control)
    relative = [relative_point(first, last, point) for point in inner]
    return (Quadratic(relative[0]) if len(relative) == 1 else Cubic(relative[0], relative[1])), last


def _walked(points: Float) -> Float:
    """Length [m] of a polyline up to each of its points."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def _absolute_points(start: Float, end: Float, points: tuple[Point, ...]) -> Float:
    """Points [m] of an edge from its start to its end, both included."""
    chord = end - start
    left = np.array([-chord[1], chord[0]])
    return np.array([start, *(start + u * chord + v * left for u, v in points), end])


def _circle(start: Float, end: Float, arc: Arc) -> tuple[float, Float, float, float]:
    """Radius [m], centre, angle of the start and signed sweep [rad] of an arc."""
    chord = end - start
    half = float(np.linalg.norm(chord)) / 2.0
    if arc.radius < half * (1.0 - 1e-6):
        raise ValueError(f"an arc of radius {arc.radius:.6g} m cannot span end points {2 * half:.6g} m apart")
    # Files round the radius of half circles; just below half the chord still means half the chord.
    radius = max(arc.radius, half)
    left = np.array([-chord[1], chord[0]]) / (2.0 * half)
    offset = np.sqrt(radius * radius - half * half)
    # A minor arc that turns left (right = True) has its centre on the left of travel; a major arc opposite.
    side = 1.0 if arc.right != arc.large else -1.0
    centre = (start + end) / 2.0 + side * offset * left
    minor = 2.0 * np.arcsin(min(1.0, half / radius))
    sweep = 2.0 * np.pi - minor if arc.large else minor
    first = float(np.arctan2(start[1] - centre[1], start[0] - centre[0]))
    return radius, centre, first, float(sweep if arc.right else -sweep)


def _control_points(start: Float, end: Float, curve: Quadratic | Cubic) -> Float:
    """Absolute control points [m], shape (3, 2) or (4, 2)."""
    chord = end - start
    left = np.array([-chord[1], chord[0]])
    inner = [curve.control] if isinstance(curve, Quadratic) else [curve.control_a, curve.control_b]
    return np.array([start, *(start + u * chord + v * left for u, v in inner), end])


def _bezier(control: Float, t: Float) -> Float:
    """Points of a Bezier curve at parameters t, shape (n, 2) (de Casteljau)."""
    level = [np.broadcast_to(point, (len(t), 2)) for point in control]
    t = t[:, None]
    while len(level) > 1:
        level = [(1.0 - t) * a + t * b for a, b in pairwise(level)]
    return np.array(level[0])


def _speed(control: Float, t: Float) -> Float:
    """Length of the derivative [m] at parameters t."""
    derivative = (len(control) - 1) * np.diff(control, axis=0)
    flat = _bezier(derivative, t.ravel())
    return np.asarray(np.linalg.norm(flat, axis=1).reshape(t.shape))


def _lengths_between(control: Float, t_a: Float, t_b: Float) -> Float:
    """Arc lengths [m] between pairs of parameters, by five-point Gauss quadrature."""
    half = (t_b - t_a) / 2.0
    nodes = (t_a + t_b)[:, None] / 2.0 + half[:, None] * _NODES
    return half * (_speed(control, nodes) @ _WEIGHTS)


def _arc_lengths(control: Float) -> Float:
    """Arc length [m] from the start to each of the _SPANS + 1 evenly spaced parameters."""
    t = np.linspace(0.0, 1.0, _SPANS + 1)
    return np.concatenate([[0.0], np.cumsum(_lengths_between(control, t[:-1], t[1:]))])


def _parameters_at(control: Float, along: Float) -> Float:
    """Parameters at the fractions `along` of the arc length: Newton from the table, kept inside its span."""
    table = _arc_lengths(control)
    target = along * table[-1]
    span = np.clip(np.searchsorted(table, target, side="right") - 1, 0, _SPANS - 1)
    low, high = span / _SPANS, (span + 1) / _SPANS
    width = np.maximum(table[span + 1] - table[span], 1e-300)
    t = low + (high - low) * np.clip((target - table[span]) / width, 0.0, 1.0)
    for _ in range(4):
        error = table[span] + _lengths_between(control, low, t) - target
        t = np.clip(t - error / np.maximum(_speed(control, t), 1e-300), low, high)
    return np.asarray(t)
