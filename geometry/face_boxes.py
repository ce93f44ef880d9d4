"""Boxes of the faces of a triangle surface."""

import numpy as np

from toile.geometry.arrays import Float, Int


def face_boxes(vertices: Float, faces: Int) -> Float:
    """Return boxes of faces (t, 3) of vertices (v, 3) [m]: lower corner, upper corner, shape (t, 6)."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    return np.ascontiguousarray(np.concatenate([low, high], axis=1))
