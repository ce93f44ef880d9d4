"""A triangle surface for the contact search: each vertex and edge is owned by exactly one face."""

from dataclasses import dataclass

import numpy as np

from toile.geometry.arrays import Int


@dataclass(frozen=True)
class Surface:
    """Faces and what they own.

    Representative triangles (Curtis, Tamstorf and Manocha 2008): a pair of faces tests only the vertices
    and edges that its faces own, so every vertex-face and edge-edge pair is tested once.

    Attributes
    ----------
    faces
        Vertex indices, shape (t, 3).
    owned
        What face t owns, as bits, shape (t,): bit k its corner k, bit 3 + k its edge from there to the next.
    """

    faces: Int
    owned: Int


def surface_of(faces: Int) -> Surface:
    """Give every vertex and every edge to the first face that has it."""
    corners = faces.ravel()
    owns_vertex = np.zeros(corners.shape, bool)
    owns_vertex[np.unique(corners, return_index=True)[1]] = True
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    edges = np.sort(ends, axis=1).astype(np.int64)
    keys = edges[:, 0] * (int(faces.max(initial=0)) + 1) + edges[:, 1]
    owns_edge = np.zeros(keys.shape, bool)
    owns_edge[np.unique(keys, return_index=True)[1]] = True
    flags = np.hstack([owns_vertex.reshape(-1, 3), owns_edge.reshape(-1, 3)])
    return Surface(
        np.ascontiguousarray(faces, np.int32), (flags << np.arange(6)).sum(axis=1).astype(np.int32)
    )
