"""Where fields lie on a pattern: levels, negative within, and cuts of edges where borders cross them."""

from collections.abc import Sequence

import numpy as np

from toile.dressing.garment.fields.cut_mesh import HALVINGS, ON_LINE, Level
from toile.dressing.garment.fields.field import Elastic, Field, Hold, Parts
from toile.dressing.garment.fields.layer import Layer
from toile.dressing.garment.fields.patch import Patch
from toile.dressing.garment.fields.runs import run_parts
from toile.dressing.pattern.pattern import Panel, Pattern
from toile.dressing.pattern.pattern_curve import cut_curve, edge_points
from toile.dressing.pattern.seam import EdgePart
from toile.dressing.pattern.split_seams import EdgeKey
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

ALONG = 128
"""Points along an edge at which its distance from a line is looked at."""


def levels_of(field: Field | Layer, pattern: Pattern) -> dict[str, Level]:
    """Return the level of what ends within panels, by the panel's name; none where it does not."""
    chosen = field.panels or [panel.name for panel in pattern.panels]
    if field.polygon:
        corners = np.array(field.polygon, np.float64)
        return {name: lambda points: _signed_distance(points, corners) for name in chosen}
    if field.run is None or field.width is None:
        return {}
    lines: dict[str, list[Float]] = {}
    for part in run_parts(field.run, pattern):
        if part.panel in chosen:
            lines.setdefault(part.panel, []).append(_polyline(pattern.panel(part.panel), part))
    if not lines:
        raise InputError(f"run '{field.run}' lies on none of the panels {list(chosen)}", field="run")
    return {name: _band(pieces, field.width) for name, pieces in lines.items()}


def cuts_of(parts: Parts, levels: Sequence[dict[str, Level]], pattern: Pattern) -> dict[EdgeKey, list[float]]:
    """Return the fractions at which edges are cut: where regions meet the border, and where runs end."""
    cuts: dict[EdgeKey, list[float]] = {}
    for of_panels in levels:
        for name, level in of_panels.items():
            panel = pattern.panel(name)
            for edge in range(len(panel.edges)):
                cuts.setdefault((name, edge), []).extend(_crossings(panel, edge, level))
    named: list[Field | Layer | Elastic | Hold | Patch] = [
        *parts.fields, *parts.layers, *parts.elastic, *parts.holds, *parts.patches,
    ]  # fmt: skip
    runs = [one.run for one in named] + [run for one in parts.closures for run in (one.over, one.under)]
    for run in runs:
        for part in () if run is None else run_parts(run, pattern):
            ends = [at for at in (part.start, part.end) if 0.0 < at < 1.0]
            cuts.setdefault((part.panel, part.edge), []).extend(ends)
    return {key: sorted(at) for key, at in cuts.items() if at}


def _polyline(panel: Panel, part: EdgePart) -> Float:
    """Points along a stretch of an edge [m], shape (k, 2)."""
    low, high = sorted((part.start, part.end))
    count = 1 if panel.edges[part.edge].curve is None else ALONG
    points = edge_points(panel, part.edge, count)
    if (low, high) == (0.0, 1.0):
        return points
    at = np.arange(count + 1) / count
    inner = points[(at > low + 1e-9) & (at < high - 1e-9)]
    ends = [_point_at(panel, part.edge, share) for share in (low, high)]
    return np.concatenate([ends[:1], inner, ends[1:]])


def _point_at(panel: Panel, edge: int, share: float) -> Float:
    """Point at a fraction of an edge's length [m], shape (2,)."""
    if share in (0.0, 1.0):
        return np.asarray(edge_points(panel, edge, 1)[int(share)])
    return np.array(cut_curve(panel, edge, [share])[0][1])


def _band(pieces: list[Float], width: float) -> Level:
    """Return the level of points within a width of polylines."""
    start = np.concatenate([points[:-1] for points in pieces])
    way = np.concatenate([points[1:] - points[:-1] for points in pieces])
    return lambda points: _distance(points, start, way) - width


def _distance(points: Float, start: Float, way: Float) -> Float:
    """Distance of points (n, 2) from the nearest of some segments, shape (n,)."""
    away = points[:, None] - start
    square = np.maximum((way**2).sum(axis=1), 1e-300)
    share = np.clip(np.einsum("nki,ki->nk", away, way) / square, 0.0, 1.0)
    return np.asarray(np.linalg.norm(away - share[:, :, None] * way, axis=2).min(axis=1))


def _signed_distance(points: Float, corners: Float) -> Float:
    """Distance of points (n, 2) from a polygon's outline, negative within, shape (n,)."""
    ahead = np.roll(corners, -1, axis=0)
    distance = _distance(points, corners, ahead - corners)
    x, y = points[:, 0, None], points[:, 1, None]
    above = (corners[:, 1] > y) != (ahead[:, 1] > y)
    rise = np.where(above, ahead[:, 1] - corners[:, 1], 1.0)
    crosses = above & (x < corners[:, 0] + (y - corners[:, 1]) * (ahead[:, 0] - corners[:, 0]) / rise)
    inside = crosses.sum(axis=1) % 2 == 1
    return np.where(inside, -distance, distance)


def _crossings(panel: Panel, edge: int, level: Level) -> list[float]:
    """Fractions of an edge's length at which a level is 0, its ends aside."""
    values = level(edge_points(panel, edge, ALONG))
    values = np.where(np.abs(values) < ON_LINE, 0.0, values)
    found = [k / ALONG for k in range(1, ALONG) if values[k] == 0.0 and values[k - 1] * values[k + 1] < 0.0]
    for k in np.flatnonzero(values[:-1] * values[1:] < 0.0).tolist():
        low, high = k / ALONG, (k + 1) / ALONG
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            here = float(level(_point_at(panel, edge, middle)[None])[0])
            low, high = (middle, high) if here * values[k] > 0.0 else (low, middle)
        found.append(0.5 * (low + high))
    return found
