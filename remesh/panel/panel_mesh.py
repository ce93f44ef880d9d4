"""Triangulation of one flat panel: border points are kept, the inside is filled evenly."""

import math
from dataclasses import dataclass

import manifold3d
import numpy as np

from toile.geometry.arrays import Float, Int
from toile.remesh.panel.delaunay_flip import flip_to_delaunay, neighbours_across
from toile.remesh.panel.frontal_insert import border_point_sizes, insert_points
from toile.remesh.panel.smooth_points import lift_worst, smooth_points, stars
from toile.remesh.panel.split_ears import split_ears


@dataclass(frozen=True, kw_only=True)
class PanelMeshOptions:
    """Options of the triangulation of a panel.

    Attributes
    ----------
    grading
        Growth of the wanted edge length per distance from a finer border (dimensionless).
    circumradius
        Triangles with a larger circumradius, in wanted edge lengths, get another point (equilateral: 0.577).
    rounds
        Times that smoothing and flips alternate.
    ear_angle
        Corners wider than this [degrees] are not left to a single triangle.
    """

    grading: float = 0.35
    circumradius: float = 0.77
    rounds: int = 6
    ear_angle: float = 60.0


@dataclass(frozen=True)
class PanelMesh:
    """Vertices [m], shape (n, 2), the border first and in order; faces, shape (t, 3), counter-clockwise."""

    vertices: Float
    faces: Int


def triangulate_panel(
    border: Float, *, edge_length: float, options: PanelMeshOptions | None = None
) -> PanelMesh:
    """Fill a simple counter-clockwise polygon with triangles of about `edge_length` [m].

    No border side is split and no border point moves. Where the border is finer than `edge_length`, the
    triangles grow inwards.

    Raises ValueError if the polygon cannot be triangulated (it is clockwise or crosses itself).
    """
    options = options or PanelMeshOptions()
    border = np.ascontiguousarray(border, dtype=np.float64)
    corners = constrained_triangles(border)
    across = neighbours_across(corners)
    flip_to_delaunay(border, corners, across, np.empty(3 * len(corners) + 8, np.int32))
    points, size, corners, across = _filled(border, corners, across, edge_length, options)
    stack = np.empty(3 * len(corners) + 8, np.int32)
    for _ in range(options.rounds):
        offsets, around = stars(corners, len(points))
        smooth_points(points, corners, size, offsets, around, len(border), 2, 0.7)
        flip_to_delaunay(points, corners, across, stack)
    split_ears(points, corners, across, len(border), math.cos(math.radians(options.ear_angle)))
    offsets, around = stars(corners, len(points))
    smooth_points(points, corners, size, offsets, around, len(border), 2, 0.8)
    lift_worst(points, corners, offsets, around, len(border), 3, 0.8)
    return PanelMesh(points, corners)


def constrained_triangles(polygon: Float) -> Int:
    """Triangles between the points of a simple polygon, shape (n - 2, 3). Raises ValueError if that fails."""
    corners = np.ascontiguousarray(manifold3d.triangulate([polygon], allow_convex=False), dtype=np.int32)
    a, b, c = polygon[corners[:, 0]], polygon[corners[:, 1]], polygon[corners[:, 2]]
    twice = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    extent = float(np.ptp(polygon, axis=0).max())
    if len(corners) != len(polygon) - 2 or twice.min() < -1e-9 * extent * extent:
        raise ValueError("the outline cannot be triangulated: it is clockwise, touches or crosses itself")
    return corners


def _filled(
    border: Float, corners: Int, across: Int, edge_length: float, options: PanelMeshOptions
) -> tuple[Float, Float, Int, Int]:
    """Insert inner points, with room for as many as it takes."""
    ahead = np.roll(border, -1, axis=0)
    border_size = np.linalg.norm(ahead - border, axis=1)
    x, y = (border - border[0]).T
    area = 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    room = int(1.5 * area / edge_length**2) + 2 * len(border) + 16
    while True:
        points = np.zeros((room, 2))
        points[: len(border)] = border
        size = np.zeros(room)
        border_point_sizes(border, border_size, edge_length, options.grading, size)
        all_corners = np.zeros((2 * room, 3), np.int32)
        all_across = np.full((2 * room, 3), -1, np.int32)
        all_corners[: len(corners)], all_across[: len(corners)] = corners, across
        work = np.zeros((2, 2 * room), np.int32)
        vertices, faces = insert_points(
            border, border_size, edge_length, options.grading, options.circumradius,
            len(border), len(corners), points, size, all_corners, all_across, work[0], work[1],
        )  # fmt: skip
        if vertices < room:
            return (
                points[:vertices].copy(), size[:vertices].copy(),
                all_corners[:faces].copy(), all_across[:faces].copy(),
            )  # fmt: skip
        room *= 2
