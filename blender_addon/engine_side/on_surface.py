"""The vertices of a garment's file, located on its present surface."""

import numpy as np
from scipy.spatial import cKDTree

from toile.dressing.run.result import DressedGarment
from toile.geometry.arrays import Float, Int

CANDIDATES = 24
"""Triangles in which a vertex is looked for: those with the nearest centres."""


class OnSurface:
    """Places of the file's vertices on a garment whose mesh changes, found in the rest shape.

    `rest` are the corners of the file at rest [m], shape (p, 3); `corner_vertex` their vertices, of which
    there are `count`.
    """

    def __init__(self, rest: Float, corner_vertex: Int, count: int) -> None:
        self._rest, self._vertex = rest, corner_vertex
        self._corner = np.full(count, -1, np.int32)
        self._corner[corner_vertex[::-1]] = np.arange(len(corner_vertex), dtype=np.int32)[::-1]
        self._key: tuple[int, bytes] | None = None
        self._nodes: Int = np.zeros((count, 3), np.int32)
        self._weights: Float = np.zeros((count, 3))

    def points(self, garment: DressedGarment, lone: Float) -> Float:
        """Places of all vertices [m], shape (n, 3); of those without a face, as in `lone`."""
        key = len(garment.uv), garment.uv_faces.tobytes()
        if key != self._key:
            self._find(garment)
            self._key = key
        placed = np.einsum("nk,nki->ni", self._weights, garment.positions[self._nodes])
        placed[self._corner < 0] = lone[self._corner < 0]
        return np.asarray(placed)

    def _find(self, garment: DressedGarment) -> None:
        """Find triangle and weights of every vertex: of those that are still nodes, and by the rest shape."""
        assert garment.origin is not None
        rest = garment.origin.at_vertices(self._rest)
        corners = rest[garment.uv_faces]
        used = np.flatnonzero(self._corner >= 0)
        wanted = self._rest[self._corner[used]]
        count = min(CANDIDATES, len(corners))
        near = np.asarray(cKDTree(corners.mean(axis=1)).query(wanted, k=count)[1]).reshape(len(used), count)
        a = corners[near, 0]
        u, v, w = corners[near, 1] - a, corners[near, 2] - a, wanted[:, None] - a
        uu, uv, vv = (np.einsum("nki,nki->nk", *pair) for pair in ((u, u), (u, v), (v, v)))
        uw, vw = np.einsum("nki,nki->nk", u, w), np.einsum("nki,nki->nk", v, w)
        area = np.maximum(uu * vv - uv * uv, 1e-30)
        second, third = (vv * uw - uv * vw) / area, (uu * vw - uv * uw) / area
        weights = np.clip(np.stack([1.0 - second - third, second, third], axis=-1), 0.0, 1.0)
        weights /= weights.sum(axis=-1, keepdims=True)
        away = np.linalg.norm(np.einsum("nkc,nkci->nki", weights, corners[near]) - wanted[:, None], axis=-1)
        best = away.argmin(axis=1)
        rows = np.arange(len(used))
        self._nodes[used] = garment.faces[near[rows, best]]
        self._weights[used] = weights[rows, best]
