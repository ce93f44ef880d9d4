"""Edges between nodes, with their one or two sides in the panels."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.topology import triangle_topology
from toile.remesh.row_products import row_dot

INNER, SEAM, BORDER, TANGLED = 0, 1, 2, 3
"""Two faces of one panel; two faces of different panels; one face; more faces, or only one node."""

FLATNESS = 1e-7
"""Two faces are one plane in rest space if the far corner is at most so high above it, per its distance."""


@dataclass
class MeshEdges:
    """Edges of a mesh. Flips keep them up to date in place; splits and collapses build them anew.

    Attributes
    ----------
    nodes
        Both ends, lower node first, shape (e, 2).
    kind
        INNER, SEAM, BORDER or TANGLED, shape (e,).
    faces
        The one or two faces, -1 where there is none, shape (e, 2); of a tangled edge the first one only.
    sides
        Which side of each face it is (side k lies opposite to corner k), shape (e, 2).
    face_edges
        Edge of every side, shape (t, 3).
    creased
        True for inner edges whose faces do not lie in one plane of rest space, shape (e,).
    frozen
        True for edges that must stay as they are, shape (e,).
    keys
        Sorted keys of all node pairs that are edges, or were before a flip since the edges were built.
    """

    nodes: Int
    kind: npt.NDArray[np.int8]
    faces: Int
    sides: Int
    face_edges: Int
    creased: Bool
    frozen: Bool
    keys: npt.NDArray[np.int64]

    def replace_face(self, edges: Int, old: Int, new: Int, new_side: int) -> None:
        """Let edges that lie at faces `old` lie at side `new_side` of faces `new` instead; all shape (k,)."""
        for slot in (0, 1):
            hit = self.faces[edges, slot] == old
            self.faces[edges[hit], slot] = new[hit]
            self.sides[edges[hit], slot] = new_side


def pair_keys(a: Int, b: Int) -> npt.NDArray[np.int64]:
    """Return one number per unordered pair; sorted numbers are sorted pairs, lower entry first."""
    low, high = np.minimum(a, b).astype(np.int64), np.maximum(a, b).astype(np.int64)
    return np.asarray(low << 32 | high)


def in_sorted(values: npt.NDArray[np.int64], ordered: npt.NDArray[np.int64]) -> Bool:
    """Tell which values occur in a sorted array."""
    if not len(ordered):
        return np.zeros(len(values), bool)
    place = np.minimum(np.searchsorted(ordered, values), len(ordered) - 1)
    return np.asarray(ordered[place] == values)


def corner_after(faces: Int, face: Int, corner: Int, steps: int) -> Int:
    """Return the entry of `faces` some corners after `corner`, shape (k,)."""
    flat = 3 * face.astype(np.intp) + (corner + steps) % 3
    return np.asarray(faces.ravel().take(flat))


def build_edges(
    faces: Int,
    node: Int,
    region: Int,
    rest: Float,
    normals: Float,
    frozen_keys: npt.NDArray[np.int64],
) -> MeshEdges:
    """Build the edges of faces (t, 3) of material vertices that belong to nodes `node`, shape (m,).

    `normals` are the unit normals of the faces in rest space, shape (t, 3).
    """
    topology = triangle_topology(node[faces])
    count = len(topology.edges)
    face_edges = topology.face_edges
    flat = face_edges.ravel()
    tangled = (topology.edge_face_count > 2) | (topology.edges[:, 0] == topology.edges[:, 1])
    first = np.empty(count, np.int32)
    first[flat[::-1]] = np.arange(len(flat), dtype=np.int32)[::-1]
    paired = topology.neighbours.ravel()[first] >= 0
    tangled |= (topology.edge_face_count == 2) & ~paired
    edge_faces = np.full((count, 2), -1, np.int32)
    edge_sides = np.zeros((count, 2), np.int32)
    edge_faces[:, 0], edge_sides[:, 0] = first // 3, first % 3
    edge_faces[paired, 1] = topology.neighbours.ravel()[first[paired]]
    edge_sides[paired, 1] = topology.neighbour_sides.ravel()[first[paired]]

    kind = np.full(count, BORDER, np.int8)
    kind[tangled] = TANGLED
    creased = np.zeros(count, bool)
    two = np.flatnonzero(paired)
    t, u = edge_faces[two].T
    k, j = edge_sides[two].T
    b, c = corner_after(faces, t, k, 1), corner_after(faces, t, k, 2)
    same = (corner_after(faces, u, j, 2) == b) & (corner_after(faces, u, j, 1) == c)
    same &= region[t] == region[u]
    kind[two] = np.where(same, INNER, SEAM)
    inner = two[same]
    far = rest[faces[u[same], j[same]]] - rest[b[same]]
    normal = normals[t[same]]
    height = np.abs(row_dot(far, normal))
    turned = row_dot(normal, normals[u[same]]) <= 0.0
    creased[inner] = turned | (height > FLATNESS * np.sqrt(row_dot(far, far)))
    keys = pair_keys(topology.edges[:, 0], topology.edges[:, 1])
    return MeshEdges(
        nodes=topology.edges,
        kind=kind,
        faces=edge_faces,
        sides=edge_sides,
        face_edges=face_edges,
        creased=creased,
        frozen=in_sorted(keys, frozen_keys),
        keys=keys,
    )
