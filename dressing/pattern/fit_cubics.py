"""Cubic Bezier curves through points.

After Schneider, An Algorithm for Automatically Fitting Digitized Curves, Graphics Gems (1990).
"""

from dataclasses import replace

import numpy as np

from toile.dressing.pattern.pattern import Cubic, Panel, Pattern, Polyline
from toile.dressing.pattern.pattern_curve import edge_length, edge_points, relative_point
from toile.dressing.pattern.split_seams import split_seams
from toile.geometry.arrays import Float

TOLERANCE = 1e-4
"""How far a curve may lie from the polyline that it stands for [m]."""
SAMPLE = 0.002
"""Spacing of the points that are fitted [m]."""
_REPARAMETERISATIONS = 8
MOST_DEPTH = 8


def with_curves(pattern: Pattern) -> Pattern:
    """Return the pattern with cubics in place of polylines, edges cut where one cubic does not follow."""
    cuts = {
        (panel.name, index): breaks
        for panel in pattern.panels
        for index, edge in enumerate(panel.edges)
        if isinstance(edge.curve, Polyline) and (breaks := _breaks(_sampled(panel, index)))
    }
    cut = split_seams(pattern, cuts)
    return replace(cut, panels=tuple(_fitted(panel) for panel in cut.panels))


def _fitted(panel: Panel) -> Panel:
    edges = list(panel.edges)
    for index, edge in enumerate(edges):
        if isinstance(edge.curve, Polyline):
            points = _sampled(panel, index)
            control, _ = fit_cubic(points)
            start, end = panel.vertices[edge.start], panel.vertices[edge.end]
            a, b = (relative_point(start, end, (float(x), float(y))) for x, y in control[1:3])
            edges[index] = replace(edge, curve=Cubic(a, b))
    return replace(panel, edges=tuple(edges))


def _sampled(panel: Panel, edge: int) -> Float:
    return edge_points(panel, edge, max(16, int(edge_length(panel, edge) / SAMPLE)))


def _breaks(points: Float, depth: int = 0) -> list[float]:
    """Return the fractions of the length at which a curve must be cut so that cubics follow its pieces."""
    _, errors = fit_cubic(points)
    if errors.max() <= TOLERANCE or depth >= MOST_DEPTH or len(points) < 9:
        return []
    middle = int(np.clip(errors.argmax(), len(points) // 4, len(points) - 1 - len(points) // 4))
    share = middle / (len(points) - 1)
    first, last = _breaks(points[: middle + 1], depth + 1), _breaks(points[middle:], depth + 1)
    return [*(share * at for at in first), share, *(share + (1.0 - share) * at for at in last)]


def fit_cubic(points: Float) -> tuple[Float, Float]:
    """Return the control points of the cubic nearest to points of a curve, and their distances from it [m].

    The ends are kept; both inner control points are free (least squares, chord-length parameters, refined).
    """
    walked = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    t = walked / walked[-1]
    for _ in range(_REPARAMETERISATIONS):
        basis = np.column_stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3])
        rest = points - basis[:, [0, 3]] @ points[[0, -1]]
        inner, *_ = np.linalg.lstsq(basis[:, 1:3], rest, rcond=None)
        control = np.vstack([points[:1], inner, points[-1:]])
        on = basis @ control
        first = 3 * np.diff(control, axis=0)
        speed = np.column_stack([(1 - t) ** 2, 2 * t * (1 - t), t**2]) @ first
        gap = points - on
        squared = np.maximum((speed**2).sum(axis=1), 1e-300)
        t = np.clip(t + (gap * speed).sum(axis=1) / squared, 0.0, 1.0)
        t[0], t[-1] = 0.0, 1.0
    return control, np.linalg.norm(gap, axis=1)
