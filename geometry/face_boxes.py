"""Boxes of the faces of a triangle surface."""

import numpy as np
from numba import types

from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_2, I32_2, OUT_F64_2, kernel


def face_boxes(vertices: Float, faces: Int) -> Float:
    """Return boxes of faces (t, 3) of vertices (v, 3) [m]: lower corner, upper corner, shape (t, 6)."""
    boxes = np.empty((len(faces), 6))
    boxes[:, :3], boxes[:, 3:] = np.inf, -np.inf
    _include(vertices, faces, boxes)
    return boxes


def swept_face_boxes(places: list[Float], faces: Int) -> Float:
    """Boxes of faces (t, 3) whose vertices go from place to place [m], each of shape (v, 3): shape (t, 6)."""
    boxes = face_boxes(places[0], faces)
    for place in places[1:]:
        _include(place, faces, boxes)
    return boxes


@kernel(types.void(F64_2, I32_2, OUT_F64_2))
def _include(vertices, faces, boxes):  # type: ignore[no-untyped-def]
    """Let boxes of faces grow until they hold the faces of these vertices, too."""
    for t in range(faces.shape[0]):
        for corner in range(3):
            v = faces[t, corner]
            for axis in range(3):
                boxes[t, axis] = min(boxes[t, axis], vertices[v, axis])
                boxes[t, axis + 3] = max(boxes[t, axis + 3], vertices[v, axis])
