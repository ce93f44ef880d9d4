"""Plane cuts through a body: closed outlines and their girths."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from toile.geometry.arrays import Float, Int
from toile.geometry.connected import connected


@dataclass(frozen=True, kw_only=True)
class Section:
    """One connected outline of a plane cut.

    Attributes
    ----------
    points
        Where the plane cuts the edges of the mesh [m], shape (n, 3), in no order.
    girth
        Length of a tape around the outline, its convex girth [m].
    """

    points: Float
    girth: float

    @property
    def low(self) -> Float:
        """Smallest coordinates [m]."""
        return np.asarray(self.points.min(axis=0))

    @property
    def high(self) -> Float:
        """Largest coordinates [m]."""
        return np.asarray(self.points.max(axis=0))

    @property
    def centre(self) -> Float:
        """Middle of the bounding box [m]."""
        return 0.5 * (self.low + self.high)


def cut(vertices: Float, faces: Int, point: Float, normal: Float) -> list[Section]:
    """Outlines of a body in the plane through `point` [m] with unit `normal`, longest girth first.

    Outlines are told apart by the mesh's connectivity, so two thighs that touch are still two.
    """
    height = (vertices - point) @ normal
    above = (height >= 0.0)[faces]
    cuts = above != above[:, [1, 2, 0]]
    meets = cuts[:, 0] | cuts[:, 1]
    crossed, cuts = faces[meets], cuts[meets]
    if not len(crossed):
        return []
    start, end = crossed, crossed[:, [1, 2, 0]]
    low, high = np.minimum(start, end)[cuts], np.maximum(start, end)[cuts]
    key = low.astype(np.int64) * len(vertices) + high
    # Every crossed face has exactly two crossed edges, next to each other in this list.
    nodes, inverse = np.unique(key, return_inverse=True)
    a, b = nodes // len(vertices), nodes % len(vertices)
    share = height[a] / (height[a] - height[b])
    points = vertices[a] + share[:, None] * (vertices[b] - vertices[a])
    links = inverse.reshape(-1, 2)
    label = connected(links, len(nodes))
    order = np.argsort(label, kind="stable")
    groups = np.split(points[order], np.cumsum(np.bincount(label))[:-1])
    first = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    first /= np.linalg.norm(first)
    plane = np.column_stack([first, np.cross(normal, first)])
    sections = [Section(points=group, girth=_convex_girth(group @ plane)) for group in groups]
    return sorted(sections, key=lambda section: -section.girth)


def level_cut(vertices: Float, faces: Int, level: float) -> list[Section]:
    """Outlines at a height above the floor [m]; see `cut`."""
    return cut(vertices, faces, np.array([0.0, level, 0.0]), np.array([0.0, 1.0, 0.0]))


def _convex_girth(outline: Float) -> float:
    """Perimeter of the convex hull of points (n, 2)."""
    if len(outline) < 3:
        return 0.0
    try:
        return float(ConvexHull(outline).area)
    except QhullError:
        # All in one line: a tape goes there and back.
        return 2.0 * float(np.linalg.norm(np.ptp(outline, axis=0)))
