"""Lengths and shapes of edges and triangles measured in the metric: 1 is as long as wanted."""

import math

import numpy as np

from toile.geometry.arrays import Float, Int
from toile.remesh.mesh_edges import SEAM, TANGLED, MeshEdges, corner_after
from toile.remesh.packed_tensor import inner_product

LONGEST = 1.0
"""Edges longer than this, in the metric, are split."""


def edge_sizes(faces: Int, rest: Float, tensors: Float, edges: MeshEdges) -> Float:
    """Length of every edge in the mean metric of its ends, shape (e,); the largest of all its sides.

    `tensors` are packed, shape (m, 6).
    """
    squared = np.zeros(len(edges.nodes))
    for slot, chosen in enumerate((np.arange(len(squared)), np.flatnonzero(edges.kind == SEAM))):
        here = _squared_sizes(faces, rest, tensors, edges.faces[chosen, slot], edges.sides[chosen, slot])
        squared[chosen] = np.maximum(squared[chosen], here)
    if (edges.kind == TANGLED).any():
        flat = np.flatnonzero(edges.kind[edges.face_edges] == TANGLED).astype(np.int32)
        here = _squared_sizes(faces, rest, tensors, flat // 3, flat % 3)
        np.maximum.at(squared, edges.face_edges.ravel()[flat], here)
    return np.sqrt(squared)


def _squared_sizes(faces: Int, rest: Float, tensors: Float, face: Int, side: Int) -> Float:
    """Squared length of sides in the mean metric of their ends, shape (k,)."""
    p, q = corner_after(faces, face, side, 1), corner_after(faces, face, side, 2)
    along = rest[q] - rest[p]
    return inner_product(0.5 * (tensors[p] + tensors[q]), along, along)


def metric_aspects(faces: Int, rest: Float, tensors: Float) -> Float:
    """Shape of every triangle in the mean metric of its corners: 1 if equilateral, 0 if flat; shape (t,)."""
    a, b, c = faces.T
    mean = (tensors[a] + tensors[b] + tensors[c]) / 3.0
    u, v = rest[b] - rest[a], rest[c] - rest[a]
    uu, vv, uv = inner_product(mean, u, u), inner_product(mean, v, v), inner_product(mean, u, v)
    area = 0.5 * np.sqrt(np.maximum(uu * vv - uv * uv, 0.0))
    perimeter = np.sqrt(uu) + np.sqrt(vv) + np.sqrt(np.maximum(uu + vv - 2.0 * uv, 0.0))
    return np.asarray(12.0 * math.sqrt(3.0) * area / np.maximum(perimeter * perimeter, 1e-300))
