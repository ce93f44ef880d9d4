"""Closest points of a triangle surface, exact, for measuring: contact has kernels of its own."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from toile.geometry.arrays import Float, Int

FIRST, MORE = 12, 8
"""Faces that are looked at first, by their centres, and the factor for points that need more."""


class ClosestPoints(NamedTuple):
    """The closest points of a surface.

    distance: from the points [m], shape (n,). face: on which face they lie, shape (n,). weights: of its
    corners, shape (n, 3).
    """

    distance: Float
    face: Int
    weights: Float

    def take(self, at_vertices: Float, faces: Int) -> Float:
        """Return values of the surface's vertices, shape (v, ...), at the closest points, shape (n, ...)."""
        return np.asarray(np.einsum("nc,nc...->n...", self.weights, at_vertices[faces[self.face]]))


def closest_points(points: Float, vertices: Float, faces: Int) -> ClosestPoints:
    """Return the closest points of a surface, vertices (v, 3) [m] and faces (t, 3), to points (n, 3) [m].

    Faces are tried in the order of their centres' distance, until no other can be nearer.
    """
    corners = vertices[faces]
    centres = corners.mean(axis=1)
    widest = float(np.linalg.norm(corners - centres[:, None], axis=2).max())
    tree = cKDTree(centres)
    count = len(points)
    distance, face = np.full(count, np.inf), np.zeros(count, np.int32)
    weights = np.zeros((count, 3))
    left, looked = np.arange(count), FIRST
    while len(left):
        looked = min(looked, len(faces))
        queried = tree.query(points[left], k=looked)
        away, near = (np.asarray(part).reshape(len(left), -1) for part in queried)
        found, shares = _on_triangles(points[left][:, None], corners[near])
        best = found.argmin(axis=1)
        rows = np.arange(len(left))
        distance[left], face[left] = found[rows, best], near[rows, best]
        weights[left] = shares[rows, best]
        # The centre of a face that is nearer lies within this distance and its own reach.
        open_ = distance[left] + widest > away[:, -1] if looked < len(faces) else np.zeros(len(left), bool)
        left, looked = left[open_], looked * MORE
    return ClosestPoints(distance, face, weights)


def _on_triangles(points: Float, corners: Float) -> tuple[Float, Float]:
    """Return distances (n, k) [m] of points (n, 1, 3) and triangles (n, k, 3, 3), and weights (n, k, 3)."""
    a = corners[..., 0, :]
    u, v = corners[..., 1, :] - a, corners[..., 2, :] - a
    w = points - a
    uu, uv, vv = (u * u).sum(-1), (u * v).sum(-1), (v * v).sum(-1)
    wu, wv = (w * u).sum(-1), (w * v).sum(-1)
    area = np.maximum(uu * vv - uv * uv, 1e-300)
    s, t = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    inside = (s >= 0.0) & (t >= 0.0) & (s + t <= 1.0)
    choices = [np.stack([s, t], axis=-1)]
    along_u = np.clip(wu / np.maximum(uu, 1e-300), 0.0, 1.0)
    along_v = np.clip(wv / np.maximum(vv, 1e-300), 0.0, 1.0)
    across = v - u
    far = np.clip(((w - u) * across).sum(-1) / np.maximum((across * across).sum(-1), 1e-300), 0.0, 1.0)
    zero = np.zeros_like(along_u)
    choices += [np.stack(pair, axis=-1) for pair in ((along_u, zero), (zero, along_v), (1.0 - far, far))]
    options = np.stack(choices, axis=-2)
    gaps = np.linalg.norm(
        w[..., None, :] - options[..., :1] * u[..., None, :] - options[..., 1:] * v[..., None, :], axis=-1
    )
    gaps[..., 0] = np.where(inside, gaps[..., 0], np.inf)
    best = gaps.argmin(axis=-1)[..., None]
    chosen = np.take_along_axis(options, best[..., None], axis=-2)[..., 0, :]
    shares = np.concatenate([1.0 - chosen.sum(-1, keepdims=True), chosen], axis=-1)
    return np.take_along_axis(gaps, best, axis=-1)[..., 0], shares
