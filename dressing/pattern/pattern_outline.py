"""The outline of a panel as a polygon: sampling, side of the fabric, crossings, place in the world."""

import math
from collections.abc import Sequence

import numpy as np

from toile.dressing.pattern.pattern import Panel
from toile.dressing.pattern.pattern_curve import edge_points
from toile.geometry.arrays import Bool, Float, Int

TOUCH = 1e-6
"""How near sides of an outline count as touching [m]: between nearer ones no triangle fits."""


def outline(panel: Panel, segments: Sequence[int]) -> tuple[Float, Int]:
    """Sample the outline with so many segments per edge; an edge with 0 shrinks to its end.

    Returns the polygon [m], shape (n, 2), without repeating the first point, and the edge each side of the
    polygon belongs to, shape (n,); side i runs from point i to point i + 1.
    """
    pieces = [edge_points(panel, edge, count)[:-1] for edge, count in enumerate(segments) if count]
    owner = np.repeat(np.arange(len(segments), dtype=np.int32), segments)
    return np.ascontiguousarray(np.concatenate(pieces)), owner


def default_segments(panel: Panel, curved: int = 24) -> list[int]:
    """Segments per edge that show the shape: 1 for straight edges, `curved` for the others."""
    return [1 if edge.curve is None else curved for edge in panel.edges]


def signed_area(polygon: Float) -> float:
    """Area [m^2], positive if counter-clockwise."""
    x, y = (polygon - polygon[0]).T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def is_clockwise(panel: Panel) -> bool:
    """Tell whether the loop is clockwise in the panel's (x, y): the wrong side of the fabric faces +z."""
    return signed_area(outline(panel, default_segments(panel))[0]) < 0.0


def crossing_sides(polygon: Float) -> tuple[int, int] | None:
    """Find a pair of polygon sides that cross, touch or fold back on each other; None if there is none."""
    count = len(polygon)
    ahead = np.roll(polygon, -1, axis=0)
    direction = ahead - polygon
    length = np.maximum(np.linalg.norm(direction, axis=1), 1e-300)
    following = np.roll(direction, -1, axis=0)
    cross = direction[:, 0] * following[:, 1] - direction[:, 1] * following[:, 0]
    dot = np.einsum("ij,ij->i", direction, following)
    # 1e-4 rad: a spike so sharp that its two sides coincide within 0.1 mm per metre.
    folded = np.flatnonzero((dot < 0.0) & (np.abs(cross) < 1e-4 * length * np.roll(length, -1)))
    if len(folded):
        return int(folded[0]), int((folded[0] + 1) % count)
    low, high = np.minimum(polygon, ahead) - 0.5 * TOUCH, np.maximum(polygon, ahead) + 0.5 * TOUCH
    best: tuple[int, int] | None = None
    for i in range(count - 2):
        last = count - 1 if i == 0 else count
        other = slice(i + 2, last)
        near = (
            np.flatnonzero((low[other] <= high[i]).all(axis=1) & (high[other] >= low[i]).all(axis=1)) + i + 2
        )
        if not len(near):
            continue
        a, b, c, d = polygon[i], ahead[i], polygon[near], ahead[near]
        # Both ends of each side on the same side of the other one: apart. Touching counts as crossing.
        apart_cd = _beside(_turn(a, b, c) / length[i], _turn(a, b, d) / length[i])
        apart_ab = _beside(_turn(c, d, a) / length[near], _turn(c, d, b) / length[near])
        hit = near[~apart_cd & ~apart_ab]
        if len(hit):
            best = (i, int(hit[0]))
            break
    return best


def _beside(one: Float, other: Float) -> Bool:
    """Whether two points are on the same side of a line, by their distances from it [m], and off it."""
    return np.asarray((np.minimum(one, other) > TOUCH) | (np.maximum(one, other) < -TOUCH))


def to_world(panel: Panel, points: Float) -> Float:
    """Place points of the panel's plane [m], shape (n, 2), in the world [m], shape (n, 3).

    Lengths along a panel that is rolled stay what they are: its plane is bent about one axis.
    """
    rotation = rotation_matrix(panel.rotation_degrees)
    if panel.roll_radius is not None:
        radius, angle = panel.roll_radius, points[:, 0] / panel.roll_radius
        outside = -1.0 if is_clockwise(panel) else 1.0
        rolled = np.column_stack(
            [radius * np.sin(angle), points[:, 1], outside * radius * (np.cos(angle) - 1.0)]
        )
        return np.ascontiguousarray(rolled @ rotation.T + np.array(panel.translation))
    return np.ascontiguousarray(points @ rotation[:, :2].T + np.array(panel.translation))


def edge_ends(panel: Panel, edge: int) -> Float:
    """Return the start and the end of an edge where its panel is placed [m], shape (2, 3)."""
    side = panel.edges[edge]
    return to_world(panel, np.array([panel.vertices[side.start], panel.vertices[side.end]]))


def rotation_matrix(degrees: tuple[float, float, float]) -> Float:
    """Rotation about x, then y, then z, all axes fixed in the world: Rz Ry Rx, shape (3, 3)."""
    (cx, sx), (cy, sy), (cz, sz) = ((_cos(d), _sin(d)) for d in degrees)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]])
    about_y = np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
    about_z = np.array([[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(about_z @ about_y @ about_x)


def _turn(a: Float, b: Float, c: Float) -> Float:
    """Twice the signed area of triangles a b c [m^2]; any argument may be one point or many."""
    return np.asarray(
        (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
    )


def _cos(degrees: float) -> float:
    return _sin(degrees + 90.0)


def _sin(degrees: float) -> float:
    """Sine that is exact at multiples of 90 degrees, so that flat-lying panels stay exactly flat."""
    quarter = degrees / 90.0
    if quarter == round(quarter):
        return (0.0, 1.0, 0.0, -1.0)[int(quarter) % 4]
    return math.sin(math.radians(degrees))
