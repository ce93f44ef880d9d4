"""Height of points above a smooth surface by its nearest vertex: for sizing, not for contact."""

import numpy as np
from scipy.spatial import cKDTree

from toile.collide.avatar_surface import AvatarSurface
from toile.geometry.arrays import Float
from toile.geometry.normals import vertex_normals


def heights_above(avatar: AvatarSurface, points: Float, within: float) -> Float:
    """Height [m] of points (n, 3) above the tangent plane of the nearest vertex; inf where over `within`.

    Vertices of a mesh coarser than `within` are looked for as far as its edges reach.
    """
    corners = avatar.vertices[avatar.faces]
    edge = float(np.median(np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)))
    distance, nearest = cKDTree(avatar.vertices).query(points, distance_upper_bound=within + edge)
    found = np.flatnonzero(np.isfinite(distance))
    height = np.full(len(points), np.inf)
    at = np.asarray(nearest, np.int64)[found]
    normals = vertex_normals(avatar.vertices, avatar.faces)[at]
    height[found] = np.abs(np.einsum("ni,ni->n", points[found] - avatar.vertices[at], normals))
    height[height > within] = np.inf
    return height
