"""Meshing of a panel with folds: corners where they end, and what lies between them filled apart."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from toile.dressing.pattern.pattern import Fold, Panel, Pattern
from toile.dressing.pattern.pattern_curve import edge_length, edge_points
from toile.dressing.pattern.pattern_outline import signed_area
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError
from toile.remesh.panel.panel_mesh import triangulate_panel

REACH = 0.005
"""How far from the outline a fold may end [m]: it is drawn on to it."""
SAMPLES = 512
"""Of an edge, to find where a fold ends on it; straight pieces between them."""


class FoldedMesh(NamedTuple):
    """Vertices [m], shape (n, 2), the border's first and in order; faces (t, 3); part of every face, (t,).

    `lines` are the folds from border vertex to border vertex, shape (k, 2) each [m].
    """

    vertices: Float
    faces: Int
    part: Int
    lines: tuple[Float, ...]


def fold_cuts(pattern: Pattern) -> dict[tuple[str, int], list[float]]:
    """Return the fractions of edges at which folds end, by panel and edge.

    Raises InputError for a fold that has no length or angle, or does not reach from outline to outline.
    """
    cuts: dict[tuple[str, int], list[float]] = {}
    for panel in pattern.panels:
        for number, fold in enumerate(panel.folds):
            where = f"{pattern.name}: panel '{panel.name}', fold {number}"
            _check(where, panel.name, fold)
            for end in (fold.points[0], fold.points[-1]):
                edge, fraction, distance = _place(panel, np.array(end))
                if distance > REACH:
                    raise InputError(
                        f"{where} ends at ({end[0]:.3f}, {end[1]:.3f}), {1e3 * distance:.0f} mm "
                        "from the outline; draw it from outline to outline",
                        field=f"pattern.panels.{panel.name}",
                    )
                cuts.setdefault((panel.name, edge), []).append(fraction)
    return cuts


def joined_cuts(
    cuts: Mapping[tuple[str, int], Sequence[float]] | None, folds: Mapping[tuple[str, int], Sequence[float]]
) -> dict[tuple[str, int], list[float]] | None:
    """Return cuts of edges and those where folds end together; None where there is none."""
    if not cuts and not folds:
        return None
    return {
        key: [*(cuts or {}).get(key, ()), *folds.get(key, ())]
        for key in dict.fromkeys([*(cuts or ()), *folds])
    }


def _check(where: str, panel: str, fold: Fold) -> None:
    points = np.array(fold.points, np.float64)
    problem = None
    if points.ndim != 2 or points.shape[1:] != (2,) or len(points) < 2 or not np.isfinite(points).all():
        problem = f"needs two points (x, y) [m] or more, got {fold.points!r}"
    elif np.linalg.norm(np.diff(points, axis=0), axis=1).min() == 0.0:
        problem = "has two points in one place; leave one out"
    elif not -180.0 <= fold.degrees <= 180.0:
        problem = f"is turned by {fold.degrees:g} degrees; give -180 to 180"
    elif fold.stiffness is not None and not fold.stiffness >= 0.0:
        problem = f"has a stiffness of {fold.stiffness:g} N; it must not be negative"
    if problem is not None:
        raise InputError(f"{where} {problem}", field=f"pattern.panels.{panel}")


def _place(panel: Panel, point: Float) -> tuple[int, float, float]:
    """Return the edge nearest to a point, the fraction of its length there, and how far that is [m]."""
    best = (0, 0.0, np.inf)
    for edge in range(len(panel.edges)):
        count = 1 if panel.edges[edge].curve is None else SAMPLES
        line = edge_points(panel, edge, count)
        along = np.diff(line, axis=0)
        squared = np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
        share = np.clip(np.einsum("ij,ij->i", point - line[:-1], along) / squared, 0.0, 1.0)
        away = np.linalg.norm(line[:-1] + share[:, None] * along - point, axis=1)
        at = int(away.argmin())
        if away[at] < best[2]:
            fraction = float((at + share[at]) / count)
            # An end as near to a corner as rounding makes no edge of its own.
            if edge_length(panel, edge) * min(fraction, 1.0 - fraction) < 1e-6:
                fraction = float(round(fraction))
            best = (edge, fraction, float(away[at]))
    return best


def folded_mesh(border: Float, folds: Mapping[str, Float], edge_length: float) -> FoldedMesh:
    """Fill a counter-clockwise border (b, 2) [m] with triangles, folds (k, 2) among their sides.

    The folds' names serve errors only. Raises ValueError if two folds cross, or one leaves the outline.
    """
    loops = [np.arange(len(border), dtype=np.int64)]
    points, lines = list(border), []
    for name, corners in folds.items():
        first, last = (
            int(np.linalg.norm(border - end, axis=1).argmin()) for end in (corners[0], corners[-1])
        )
        line = np.vstack((border[first], corners[1:-1], border[last]))
        lines.append(line)
        inner = _sampled(line, edge_length)
        chain = np.concatenate(([first], len(points) + np.arange(len(inner)), [last]))
        home = [n for n, loop in enumerate(loops) if first in loop and last in loop]
        home = [n for n in home if _is_inside(np.array(points)[loops[n]], line)]
        if first == last or len(home) != 1:
            raise ValueError(f"{name} crosses another fold or leaves the outline")
        points += list(inner)
        loop = loops.pop(home[0])
        i, j = int(np.flatnonzero(loop == first)[0]), int(np.flatnonzero(loop == last)[0])
        there = np.roll(loop, -i)[: (j - i) % len(loop) + 1]
        back = np.roll(loop, -j)[: (i - j) % len(loop) + 1]
        loops += [np.concatenate((there, chain[::-1][1:-1])), np.concatenate((back, chain[1:-1]))]
    vertices, faces, part = np.array(points), [], []
    for number, loop in enumerate(loops):
        if signed_area(vertices[loop]) <= 0.0:
            raise ValueError(f"{', '.join(folds)}: they cross each other or leave the outline")
        mesh = triangulate_panel(vertices[loop], edge_length=edge_length)
        number_of = np.concatenate((loop, len(vertices) + np.arange(len(mesh.vertices) - len(loop))))
        vertices = np.concatenate((vertices, mesh.vertices[len(loop) :]))
        faces.append(number_of[mesh.faces])
        part.append(np.full(len(mesh.faces), number, np.int32))
    return FoldedMesh(
        np.ascontiguousarray(vertices), np.ascontiguousarray(np.concatenate(faces), np.int32),
        np.concatenate(part), tuple(lines),
    )  # fmt: skip


def _sampled(line: Float, edge_length: float) -> Float:
    """Points along a polyline without its ends, about `edge_length` [m] apart, all corners among them."""
    points = []
    for start, end in pairwise(line):
        count = max(1, round(float(np.linalg.norm(end - start)) / edge_length))
        points.append(start + np.arange(count)[:, None] / count * (end - start))
    return np.concatenate(points)[1:]


def _is_inside(polygon: Float, line: Float) -> bool:
    """Tell whether the middles of a polyline's pieces lie within a polygon."""
    x, y = polygon.T
    ahead_x, ahead_y = np.roll(x, -1), np.roll(y, -1)
    for px, py in 0.5 * (line[:-1] + line[1:]):
        crosses = (y > py) != (ahead_y > py)
        with np.errstate(divide="ignore", invalid="ignore"):
            at = x + (py - y) / (ahead_y - y) * (ahead_x - x)
        if np.count_nonzero(crosses & (at > px)) % 2 == 0:
            return False
    return True
