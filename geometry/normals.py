"""Normals of the faces and vertices of a triangle mesh."""

import numpy as np

from toile.geometry.arrays import Float, Int


def area_normals(corners: Float) -> Float:
    """Return normals of triangles, twice as long as their areas, (t, 3), from corners (t, 3, 3)."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def vertex_normals(positions: Float, faces: Int) -> Float:
    """Return area-weighted unit normals, shape (n, 3); those of vertices without area are zero."""
    face_normals = area_normals(positions[faces])
    flat = faces.ravel()
    sums = np.stack(
        [
            np.bincount(flat, weights=np.repeat(face_normals[:, axis], 3), minlength=len(positions))
            for axis in range(3)
        ],
        axis=1,
    )
    return np.asarray(sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-300))


def drawn_normals(positions: Float, faces: Int) -> Float:
    """Return vertex normals for files and pictures, shape (n, 3): upwards where a vertex has no area."""
    normals = vertex_normals(positions, faces)
    normals[~normals.any(axis=1)] = (0.0, 1.0, 0.0)
    return normals
