"""Lengths and shapes of edges and triangles measured in the metric, where 1 is the wanted length."""

import numpy as np
from numba import types

from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_2, I32_2, OUT_F64_1, kernel
from toile.remesh.mesh.mesh_edges import MeshEdges
from toile.remesh.sizing.metric import aspect, squared_length

LONGEST = 1.0
"""Edges longer than this, in the metric, are split."""


def edge_sizes(faces: Int, rest: Float, tensors: Float, edges: MeshEdges) -> Float:
    """Length of every edge in the mean metric of its ends, shape (e,); the largest of all its sides.

    `tensors` are packed, shape (m, 6).
    """
    squared = np.zeros(len(edges.nodes))
    _squared_sizes(faces, edges.face_edges, rest, tensors, squared)
    return np.sqrt(squared)


@kernel(types.void(I32_2, I32_2, F64_2, F64_2, OUT_F64_1))
def _squared_sizes(faces, face_edges, rest, tensors, squared):  # type: ignore[no-untyped-def]
    for t in range(len(faces)):
        for k in range(3):
            p, q = faces[t, (k + 1) % 3], faces[t, (k + 2) % 3]
            e = face_edges[t, k]
            squared[e] = max(squared[e], squared_length(rest, tensors, p, q))


def metric_aspects(faces: Int, rest: Float, tensors: Float) -> Float:
    """Shape of every triangle in the mean metric of its corners: 1 if equilateral, 0 if flat; shape (t,)."""
    shapes = np.empty(len(faces))
    _aspects(faces, rest, tensors, shapes)
    return shapes


@kernel(types.void(I32_2, F64_2, F64_2, OUT_F64_1))
def _aspects(faces, rest, tensors, shapes):  # type: ignore[no-untyped-def]
    for t in range(len(faces)):
        shapes[t] = aspect(rest, tensors, faces[t, 0], faces[t, 1], faces[t, 2])
