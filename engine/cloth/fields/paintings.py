"""Values that vary from point to point of the rest shape; they stay what they are however it is meshed."""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy.spatial import cKDTree

from toile.geometry.arrays import Float, Int

CANDIDATES = 24
"""Triangles with the nearest centres among which the one under a point is sought."""


class Painting(Protocol):
    """Values over a rest shape."""

    def at(self, points: Float) -> Float:
        """Return the values at points of the rest shape [m], shape (k, 3), as shape (k,)."""


@dataclass(frozen=True, kw_only=True)
class ImagePainting:
    """Values from an image that covers a rectangle of pattern coordinates, linear between its pixels.

    Attributes
    ----------
    values
        Of the pixels, the upper row first, shape (rows, columns).
    low, high
        Corners of the rectangle in pattern coordinates [m]; points outside have the value of its edge.
    """

    values: Float
    low: tuple[float, float]
    high: tuple[float, float]

    def at(self, points: Float) -> Float:
        """Return the values at points of the rest shape [m], shape (k, 3), as shape (k,)."""
        low, size = np.array(self.low), np.array(self.high) - np.array(self.low)
        rows, columns = self.values.shape
        share = np.clip((points[:, :2] - low) / size, 0.0, 1.0)
        # Pixels have their values in their middles.
        x = np.clip(share[:, 0] * columns - 0.5, 0.0, columns - 1.0)
        y = np.clip((1.0 - share[:, 1]) * rows - 0.5, 0.0, rows - 1.0)
        left, upper = np.floor(x).astype(int), np.floor(y).astype(int)
        right, lower = np.minimum(left + 1, columns - 1), np.minimum(upper + 1, rows - 1)
        across, down = x - left, y - upper
        above = (1.0 - across) * self.values[upper, left] + across * self.values[upper, right]
        below = (1.0 - across) * self.values[lower, left] + across * self.values[lower, right]
        return np.asarray((1.0 - down) * above + down * below)


@dataclass(frozen=True, kw_only=True)
class VertexPainting:
    """Values at the vertices of a triangulation of the rest shape, linear within its triangles.

    Attributes
    ----------
    points
        Vertices in rest space [m], shape (p, 3).
    faces
        Triangles, shape (t, 3).
    values
        At the vertices, shape (p,).
    """

    points: Float
    faces: Int
    values: Float

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.points[self.faces].mean(axis=1))

    def at(self, points: Float) -> Float:
        """Return the values at points of the rest shape [m], shape (k, 3), as shape (k,).

        Each is taken from the triangle that it lies in, or least far outside.
        """
        count = min(CANDIDATES, len(self.faces))
        near = np.asarray(self._tree.query(points, k=count)[1], np.int32).reshape(len(points), count)
        shares = self._shares(points, near)
        best = shares.min(axis=2).argmax(axis=1)
        rows = np.arange(len(points))
        share = np.clip(shares[rows, best], 0.0, 1.0)
        share /= share.sum(axis=1, keepdims=True)
        return np.asarray((share * self.values[self.faces[near[rows, best]]]).sum(axis=1))

    def _shares(self, points: Float, faces: Int) -> Float:
        """Barycentric coordinates of points (k, 3) in triangles (k, c), along their normals, (k, c, 3)."""
        corner = self.points[self.faces[faces]]
        u, v = corner[:, :, 1] - corner[:, :, 0], corner[:, :, 2] - corner[:, :, 0]
        w = points[:, None] - corner[:, :, 0]
        uu, uv, vv, wu, wv = (
            np.einsum("kci,kci->kc", a, b) for a, b in ((u, u), (u, v), (v, v), (w, u), (w, v))
        )
        size = np.maximum(uu * vv - uv * uv, 1e-300)
        second, third = (vv * wu - uv * wv) / size, (uu * wv - uv * wu) / size
        # A point beside the plane of a triangle belongs to another one.
        normal = np.cross(u, v)
        height = np.abs(np.einsum("kci,kci->kc", w, normal)) / size
        return np.asarray(np.stack([1.0 - second - third, second, third], axis=2) - height[:, :, None])
