"""The faces around every node, and the nodes across their sides."""

from typing import NamedTuple

import numpy as np
from numba import types

from toile.geometry.arrays import Int
from toile.geometry.kernel import I32_2, OUT_I32_1, OUT_I32_2, kernel
from toile.remesh.mesh.mesh_edges import MeshEdges


class NodeFaces(NamedTuple):
    """Adjacency of nodes and faces.

    Attributes
    ----------
    offsets, around
        `around[offsets[i] : offsets[i + 1]]` are the faces of node i, in order; shapes (n + 1,) and (3 t,).
    across
        Node opposite to every side in the face across it, shape (t, 3); -1 where there is none.
    """

    offsets: Int
    around: Int
    across: Int


def node_faces(edges: MeshEdges, face_nodes: Int, count: int) -> NodeFaces:
    """Return the faces around each of `count` nodes."""
    offsets, around = np.zeros(count + 2, np.int32), np.empty(3 * len(face_nodes), np.int32)
    across = np.empty((len(face_nodes), 3), np.int32)
    _link(face_nodes, edges.faces, edges.sides, edges.face_edges, offsets, around, across)
    return NodeFaces(offsets[:-1], around, across)


@kernel(types.void(I32_2, I32_2, I32_2, I32_2, OUT_I32_1, OUT_I32_1, OUT_I32_2))
def _link(face_nodes, at_faces, sides, face_edges, offsets, around, across):  # type: ignore[no-untyped-def]
    """Fill `offsets` (n + 2,), all 0, whose last entry is work space, `around` and `across`."""
    for t in range(len(face_nodes)):
        for k in range(3):
            offsets[face_nodes[t, k] + 2] += 1
    for i in range(2, len(offsets)):
        offsets[i] += offsets[i - 1]
    for t in range(len(face_nodes)):
        for k in range(3):
            i = face_nodes[t, k]
            around[offsets[i + 1]] = t
            offsets[i + 1] += 1
            edge = face_edges[t, k]
            slot = 1 if at_faces[edge, 0] == t else 0
            other = at_faces[edge, slot]
            across[t, k] = -1 if other < 0 else face_nodes[other, sides[edge, slot]]
