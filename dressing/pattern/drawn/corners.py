"""Closed outlines cut at their corners, marks projected to edges, and a seam line inside a cut line."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from toile.dressing.pattern.drawn.piece import Notch
from toile.dressing.pattern.pattern_outline import signed_area
from toile.geometry.arrays import Float

CORNER_DEGREES = 25.0
"""Turn of an outline that makes a corner; curves of CAD programs turn by up to 14 degrees per point."""
REACH = 0.003
"""Over how much of the outline on either side a turn is measured at least [m]."""
SAME_POINT = 1e-5
TURN_POINT = 0.001
"""How near a corner must be to a turn point, where the file marks those [m]."""
FARTHEST_NOTCH = 0.03
"""A mark farther from the outline is none of its notches [m]."""
ONE_NOTCH = 0.004
"""Marks closer along an edge are one double notch [m]."""


def without_repeats(points: Float, *, closed: bool = True) -> Float:
    """Return points without repeated ones, nor the first at the end of a closed outline."""
    kept = [points[0]]
    for point in points[1:]:
        if np.linalg.norm(point - kept[-1]) > SAME_POINT:
            kept.append(point)
    if closed and len(kept) > 1 and np.linalg.norm(kept[0] - kept[-1]) <= SAME_POINT:
        kept.pop()
    return np.array(kept)


def counter_clockwise(outline: Float) -> Float:
    """Return an outline in that direction."""
    return outline if signed_area(outline) > 0.0 else np.ascontiguousarray(outline[::-1])


def cut_at_corners(outline: Float, turn_points: Float | None = None) -> tuple[Float, ...]:
    """Cut a closed outline [m], shape (n, 2), into edges from corner to corner, each with both its ends.

    The first edge starts at the corner that comes first in the outline. One without corners is cut at its
    first point.
    """
    turns = np.array([_turn(outline, index) for index in range(len(outline))])
    is_corner = np.abs(turns) > np.radians(CORNER_DEGREES)
    if turn_points is not None and len(turn_points):
        apart = np.linalg.norm(outline[:, None] - turn_points[None], axis=2).min(axis=1)
        is_corner &= apart < TURN_POINT
    corners = _sharpest(outline, np.flatnonzero(is_corner), np.abs(turns))
    if not len(corners):
        corners = np.array([0])
    edges = []
    for first, last in zip(corners, np.roll(corners, -1), strict=True):
        stop = last if last > first else last + len(outline)
        edges.append(np.ascontiguousarray(outline[np.arange(first, stop + 1) % len(outline)]))
    return tuple(edges)


def nearest_on_edges(edges: Sequence[Float], point: Float) -> tuple[int, float, float]:
    """Return the edge nearest to a point, how far along it from its start, and how far away [m]."""
    best = (0, 0.0, np.inf)
    for number, edge in enumerate(edges):
        start, along = edge[:-1], np.diff(edge, axis=0)
        squared = np.maximum((along**2).sum(axis=1), 1e-300)
        t = np.clip(((point - start) * along).sum(axis=1) / squared, 0.0, 1.0)
        away = np.linalg.norm(start + t[:, None] * along - point, axis=1)
        index = int(away.argmin())
        if away[index] < best[2]:
            lengths = np.sqrt(squared)
            best = (number, float(lengths[:index].sum() + t[index] * lengths[index]), float(away[index]))
    return best


def _ahead(edges: Sequence[Float], point: Float, direction: Float) -> tuple[int, float, float] | None:
    """Return the edge that a ray meets first, how far along it and how far ahead [m], or None."""
    best: tuple[int, float, float] | None = None
    ray = direction / max(float(np.linalg.norm(direction)), 1e-300)
    for number, edge in enumerate(edges):
        start, side = edge[:-1], np.diff(edge, axis=0)
        cross = ray[0] * side[:, 1] - ray[1] * side[:, 0]
        cross = np.where(np.abs(cross) < 1e-15, 1e-15, cross)
        to = start - point
        ahead = (to[:, 0] * side[:, 1] - to[:, 1] * side[:, 0]) / cross
        t = (to[:, 0] * ray[1] - to[:, 1] * ray[0]) / cross
        for index in np.flatnonzero(
            (ahead > -SAME_POINT) & (ahead < FARTHEST_NOTCH) & (t >= 0.0) & (t <= 1.0)
        ):
            if best is None or ahead[index] < best[2]:
                lengths = np.linalg.norm(side, axis=1)
                best = (number, float(lengths[:index].sum() + t[index] * lengths[index]), float(ahead[index]))
    return best


def inset(edges: Sequence[Float], allowance: float, fold: int | None) -> tuple[Float, ...]:
    """Return edges moved inwards by an allowance [m], the one on the fold left where it is.

    Neighbours are lengthened or shortened along their end tangents until they meet.
    """
    moved = []
    for number, edge in enumerate(edges):
        direction = np.gradient(edge, axis=0)
        direction /= np.maximum(np.linalg.norm(direction, axis=1), 1e-300)[:, None]
        left = np.column_stack([-direction[:, 1], direction[:, 0]])
        moved.append(edge + left * (0.0 if number == fold else allowance))
    met = [edge.copy() for edge in moved]
    for number in range(len(moved)):
        after = (number + 1) % len(moved)
        point = _meeting(moved[number], moved[after])
        met[number][-1] = met[after][0] = point
    return tuple(met)


def _meeting(before: Float, after: Float) -> Float:
    """Return where the last side of an edge and the first of the next one meet, both made longer."""
    p, d = before[-1], before[-1] - before[-2]
    q, e = after[0], after[1] - after[0]
    cross = d[0] * e[1] - d[1] * e[0]
    if abs(cross) < 0.05 * np.linalg.norm(d) * np.linalg.norm(e):
        return np.asarray(0.5 * (p + q))
    t = ((q - p)[0] * e[1] - (q - p)[1] * e[0]) / cross
    return np.asarray(p + t * d)


def _turn(outline: Float, index: int) -> float:
    """Return the turn of an outline at a point [rad], measured over REACH on either side."""
    back, ahead = _arm(outline, index, -1), _arm(outline, index, 1)
    return float(np.arctan2(-back[0] * ahead[1] + back[1] * ahead[0], -(back @ ahead)))


def _arm(outline: Float, index: int, step: int) -> Float:
    """Return the way from a point to the first one that is REACH away."""
    for away in range(1, len(outline)):
        arm = outline[(index + step * away) % len(outline)] - outline[index]
        if np.linalg.norm(arm) >= REACH:
            return np.asarray(arm)
    return np.asarray(arm)


def _sharpest(outline: Float, corners: NDArray[np.intp], sharpness: Float) -> NDArray[np.intp]:
    """Of corners closer than REACH to each other, keep the sharpest."""
    kept: list[int] = []
    for corner in sorted(corners.tolist(), key=lambda c: -sharpness[c]):
        if all(np.linalg.norm(outline[corner] - outline[other]) > REACH for other in kept):
            kept.append(corner)
    return np.array(sorted(kept), dtype=np.intp)


def projected_notches(
    edges: Sequence[Float],
    marks: Sequence[Float],
    *,
    back: Sequence[bool] | None = None,
    inwards: Sequence[Float | None] | None = None,
) -> tuple[Notch, ...]:
    """Return marks as notches of edges, those on corners and repeated ones left out.

    `back` says which are marks of a back; `inwards` is where a mark points, along which it is projected if an
    edge lies there, else to the nearest.
    """
    found: list[Notch] = []
    for index, mark in enumerate(marks):
        is_back = back is not None and back[index]
        direction = None if inwards is None else inwards[index]
        edge, along, away = (direction is not None and _ahead(edges, mark, direction)) or nearest_on_edges(
            edges, mark
        )
        length = float(np.linalg.norm(np.diff(edges[edge], axis=0), axis=1).sum())
        if away >= FARTHEST_NOTCH or not ONE_NOTCH < along < length - ONE_NOTCH:
            continue
        twin = next(
            (
                n
                for n, other in enumerate(found)
                if other.edge == edge and abs(other.along - along) < ONE_NOTCH
            ),
            None,
        )
        if twin is None:
            found.append(Notch(edge, along, is_back))
        else:
            found[twin] = Notch(edge, 0.5 * (found[twin].along + along), is_back)
    return tuple(sorted(found))


def distance_to_line(line: Float, point: Float) -> float:
    """Return how far a point is from a line through two points [m]."""
    along = line[1] - line[0]
    cross = along[0] * (point - line[0])[1] - along[1] * (point - line[0])[0]
    return float(abs(cross) / np.linalg.norm(along))


def edge_on_line(edges: Sequence[Float], line: Float | None) -> int | None:
    """Return the longest edge all of whose points lie on a line."""
    if line is None:
        return None
    on = [n for n, edge in enumerate(edges) if max(distance_to_line(line, point) for point in edge) < 2e-3]
    return max(on, key=lambda n: float(np.linalg.norm(edges[n][-1] - edges[n][0])), default=None)


def warp_of_line(grain: Float | None) -> float:
    """Return the direction of the grain line from +y, within -90 and 90 degrees."""
    if grain is None:
        return 0.0
    x, y = grain[-1] - grain[0]
    degrees = float(np.degrees(np.arctan2(-x, y)))
    return degrees - 180.0 * round(degrees / 180.0)
