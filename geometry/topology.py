"""Edges and face neighbours of an indexed triangle mesh."""

from typing import NamedTuple

import numpy as np

from toile.geometry.arrays import Bool, Int


class Topology(NamedTuple):
    """Adjacency of a triangle mesh. Side k of a face is the edge opposite its corner k.

    Attributes
    ----------
    edges
        Node pairs, lower node first, sorted, shape (e, 2).
    face_edges
        Edge of every side, shape (t, 3).
    edge_face_count
        How many faces meet at every edge, shape (e,).
    neighbours
        Face across every side, shape (t, 3); -1 at a border and where more than two faces meet.
    neighbour_sides
        Which side of that face it is, shape (t, 3); -1 where there is no neighbour.
    """

    edges: Int
    face_edges: Int
    edge_face_count: Int
    neighbours: Int
    neighbour_sides: Int

    @property
    def border_edges(self) -> Int:
        """Edges with exactly one face, shape (b, 2)."""
        border: Int = self.edges[self.edge_face_count == 1]
        return border

    @property
    def neighbour_pairs(self) -> Int:
        """Pairs of neighbouring faces, the lower face first, shape (p, 2)."""
        face, side = np.nonzero(self.neighbours > np.arange(len(self.neighbours))[:, None])
        return np.column_stack([face, self.neighbours[face, side]]).astype(np.int32)

    @property
    def border_sides(self) -> Bool:
        """True where a side has no neighbour, shape (t, 3)."""
        return self.neighbours < 0


def triangle_topology(faces: Int) -> Topology:
    """Return the edges and neighbours of triangles given as node triples (t, 3).

    Orientation does not matter: two faces that share both nodes of a side are neighbours. A side whose two
    nodes coincide (a face that sewing has collapsed) has no neighbour.
    """
    face_count = len(faces)
    start = faces[:, [1, 2, 0]].ravel().astype(np.int64)
    end = faces[:, [2, 0, 1]].ravel().astype(np.int64)
    low, high = np.minimum(start, end), np.maximum(start, end)
    stride = np.int64(high.max() + 1 if len(high) else 1)
    keys = low * stride + high
    order = np.argsort(keys, kind="stable")
    sorted_keys = keys[order]
    first = np.ones(len(keys), dtype=bool)
    first[1:] = sorted_keys[1:] != sorted_keys[:-1]
    starts = np.flatnonzero(first)
    counts = np.diff(np.append(starts, len(keys)))
    face_edges = np.empty(len(keys), dtype=np.int32)
    face_edges[order] = np.cumsum(first) - 1
    unique_keys = sorted_keys[starts]
    edges = np.column_stack((unique_keys // stride, unique_keys % stride)).astype(np.int32)

    neighbours = np.full(3 * face_count, -1, dtype=np.int32)
    sides = np.full(3 * face_count, -1, dtype=np.int32)
    pairs = starts[(counts == 2) & (edges[:, 0] != edges[:, 1])]
    one, two = order[pairs], order[pairs + 1]
    proper = one // 3 != two // 3
    one, two = one[proper], two[proper]
    neighbours[one], neighbours[two] = two // 3, one // 3
    sides[one], sides[two] = two % 3, one % 3
    return Topology(
        edges=edges,
        face_edges=face_edges.reshape(-1, 3),
        edge_face_count=counts.astype(np.int32),
        neighbours=neighbours.reshape(-1, 3),
        neighbour_sides=sides.reshape(-1, 3),
    )
