"""Distance between two draped surfaces."""

import numpy as np
from scipy.spatial import cKDTree

from toile.geometry.arrays import Float, Int

SPACING = 0.003
"""Distance of the points that stand for a surface, unless told [m]."""


def mean_surface_distance(a: tuple[Float, Int], b: tuple[Float, Int], spacing: float = SPACING) -> float:
    """Mean distance [m] of surface a from surface b, both (positions (n, 3), faces (t, 3)).

    Points spread over a, weighted by area, are measured against the tangent planes at the nearest points
    spread over b; what a point lies aside beyond the spacing of these [m] counts as well.
    """
    points, _, weights = _spread(*a, spacing)
    places, normals, _ = _spread(*b, spacing)
    _, nearest = cKDTree(places).query(points)
    offset = points - places[nearest]
    height = np.einsum("ni,ni->n", offset, normals[nearest])
    aside = np.sqrt(np.maximum(np.einsum("ni,ni->n", offset, offset) - height**2, 0.0))
    distance = np.sqrt(height**2 + np.maximum(aside - spacing, 0.0) ** 2)
    return float(np.average(distance, weights=weights))


def _spread(positions: Float, faces: Int, spacing: float) -> tuple[Float, Float, Float]:
    """Points on every face, about `spacing` apart, with the face's normal and their share of its area."""
    corners = positions[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double = np.linalg.norm(normal, axis=1)
    normal /= np.maximum(double, 1e-300)[:, None]
    longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    rows = np.maximum(np.ceil(longest / spacing).astype(int), 1)
    points, normals, weights = [], [], []
    for count in np.unique(rows):
        chosen = np.flatnonzero(rows == count)
        i, j = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
        inside = i + j < count
        u, v = (i[inside] + 1.0 / 3.0) / count, (j[inside] + 1.0 / 3.0) / count
        shares = np.stack([1.0 - u - v, u, v], axis=1)
        points.append(np.einsum("pc,tci->tpi", shares, corners[chosen]).reshape(-1, 3))
        normals.append(np.repeat(normal[chosen], len(shares), axis=0))
        weights.append(np.repeat(0.5 * double[chosen] / len(shares), len(shares)))
    return np.concatenate(points), np.concatenate(normals), np.concatenate(weights)
