"""How far apart two states of a garment are, point of the pattern by point, on whatever meshes they are.

A mesh that adapts has other vertices in every film, but every vertex lies somewhere in the pattern. So both
states are compared at the material vertices of one of them, weighted by their share of the area.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from toile.geometry.arrays import Float, Int

NEAREST = 24
"""Triangles around a point that are tried first, the nearest by their centroids."""
INSIDE = 1e-9
"""Distance in the pattern below which a point lies in a triangle [m]."""


@dataclass(frozen=True)
class Worn:
    """A state of garments.

    Attributes
    ----------
    positions, faces
        Nodes [m], shape (n, 3), and triangles, shape (t, 3).
    uv, uv_faces, panel
        Pattern coordinates [m], shape (m, 2), the same triangles in them, and the panel of each, shape (t,).
    """

    positions: Float
    faces: Int
    uv: Float
    uv_faces: Int
    panel: Int

    @property
    def flat(self) -> bool:
        """Whether there are pattern coordinates to compare by."""
        return bool(self.uv.any())


def material_distances(a: Worn, b: Worn) -> tuple[Float, Float]:
    """Distance of every material vertex of `b` from the same point of `a` [m], and its share of the area."""
    distances, shares = np.zeros(len(b.uv)), np.zeros(len(b.uv))
    node = np.zeros(len(b.uv), np.int64)
    node[b.uv_faces] = b.faces
    np.add.at(shares, b.uv_faces, _areas(b.uv[b.uv_faces])[:, None] / 3.0)
    for panel in np.unique(b.panel):
        vertices = np.unique(b.uv_faces[b.panel == panel])
        own = a.panel == panel
        if not own.any():
            raise ValueError(f"the states are of different garments: one has no panel {panel}")
        there = _places(b.uv[vertices], a.uv[a.uv_faces[own]], a.positions[a.faces[own]])
        distances[vertices] = np.linalg.norm(there - b.positions[node[vertices]], axis=1)
    return distances, shares / shares.sum()


def rms_and_largest(a: list[Worn], b: list[Worn]) -> tuple[float, float]:
    """Root mean square over frames and area, and largest, of the distances of two films [m].

    Raises ValueError where they have not equally many frames.
    """
    squares, largest = [], 0.0
    for one, other in zip(a, b, strict=True):
        distances, shares = material_distances(one, other)
        squares.append(float(shares @ distances**2))
        largest = max(largest, float(distances.max()))
    return float(np.sqrt(np.mean(squares))), largest


def _places(points: Float, corners: Float, positions: Float) -> Float:
    """Where points of a panel, shape (p, 2), are [m]: of its triangles, shapes (t, 3, 2) and (t, 3, 3)."""
    tree = cKDTree(corners.mean(axis=1))
    count = min(NEAREST, len(corners))
    _, tried = tree.query(points, k=count)
    tried = np.asarray(tried).reshape(len(points), count)
    weights, away = _weights(points[:, None], corners[tried])
    best = away.argmin(axis=1)
    rows = np.arange(len(points))
    face, weight, off = tried[rows, best], weights[rows, best], away[rows, best]
    # Beside large triangles lie small ones whose centroids are all nearer.
    for row in np.flatnonzero(off > INSIDE):
        some, distance = _weights(points[row][None], corners)
        nearest = int(distance.argmin())
        if distance[nearest] < off[row]:
            face[row], weight[row] = nearest, some[nearest]
    return np.asarray(np.einsum("pk,pkd->pd", weight, positions[face]))


def _weights(points: Float, corners: Float) -> tuple[Float, Float]:
    """Weights of the corners for points, clipped to the triangles, and how far off these are [m]."""
    a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
    area = _cross(b - a, c - a)
    area = np.where(np.abs(area) < 1e-300, 1e-300, area)
    second = _cross(points - a, c - a) / area
    third = _cross(b - a, points - a) / area
    weights = np.clip(np.stack((1.0 - second - third, second, third), axis=-1), 0.0, None)
    weights /= weights.sum(axis=-1, keepdims=True)
    off = np.einsum("...k,...kd->...d", weights, corners) - points
    return weights, np.asarray(np.linalg.norm(off, axis=-1))


def _cross(a: Float, b: Float) -> Float:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _areas(corners: Float) -> Float:
    return np.asarray(0.5 * np.abs(_cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])))
