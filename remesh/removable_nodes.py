"""Which nodes can be removed without changing the rest shape, and along which edges.

A node inside a flat part may be merged into any neighbour. On a line (border, seam, or crease of the rest
shape) it may be merged into its two neighbours on the line, if the line is straight there on every side.
"""

from typing import NamedTuple

import numpy as np

from toile.geometry.arrays import Bool, Float, Int
from toile.remesh.edge_size import edge_sizes
from toile.remesh.mesh_edges import BORDER, INNER, SEAM, TANGLED, MeshEdges, corner_after
from toile.remesh.mesh_in_work import MeshInWork
from toile.remesh.row_products import row_cross, row_dot

STRAIGHTNESS = 1e-9
"""A point lies on a line if its distance is at most this share of the line's length."""


class Merges(NamedTuple):
    """Possible merges of a node into a neighbour, shortest edge first.

    Attributes
    ----------
    removed, target
        The node that goes and the one that takes its place, shape (k,).
    vertices, target_vertices
        Its material vertices on the one or two sides of the edge and what takes their place (twice the same
        inside a panel and on a border), shape (k, 2).
    """

    removed: Int
    target: Int
    vertices: Int
    target_vertices: Int

    def where(self, chosen: Bool | Int) -> "Merges":
        """Return the chosen ones."""
        return Merges(*(values[chosen] for values in self))


def possible_merges(work: MeshInWork, longest: float, near: Bool | None = None) -> Merges:
    """List the merges along edges up to `longest` in the metric that leave the rest shape as it is.

    With `near`, shape (n,), only along edges with an end at one of these nodes.
    """
    edges = work.edges
    size = edge_sizes(work.faces, work.rest, work.tensors, edges)
    looked_at = (size <= longest) & ~edges.frozen & (edges.kind != TANGLED)
    if near is not None:
        looked_at &= near[edges.nodes].any(axis=1)
    short = np.flatnonzero(looked_at)
    inside, on_line = _removable(work)
    line = _is_line(edges)[short]
    ends = edges.nodes[short]
    allowed = np.where(line[:, None], on_line[ends], inside[ends])
    order = np.argsort(size[short], kind="stable")
    row, end = np.nonzero(allowed[order])
    edge = short[order[row]].astype(np.int32)
    removed, target = edges.nodes[edge, end], edges.nodes[edge, 1 - end]
    here, there = _side_vertices(work, edges, edge, removed)
    return Merges(removed, target, here, there)


def _is_line(edges: MeshEdges) -> Bool:
    return np.asarray((edges.kind != INNER) | edges.creased)


def _side_vertices(work: MeshInWork, edges: MeshEdges, edge: Int, at: Int) -> tuple[Int, Int]:
    """Material vertices of node `at` and of the other end, on both sides of edges, each (k, 2).

    An edge with one face shows its one side twice.
    """
    face, side = edges.faces[edge], edges.sides[edge]
    alone = face[:, 1] < 0
    face[alone, 1], side[alone, 1] = face[alone, 0], side[alone, 0]
    p, q = corner_after(work.faces, face, side, 1), corner_after(work.faces, face, side, 2)
    forward = work.node[p] == at[:, None]
    return np.where(forward, p, q), np.where(forward, q, p)


def _removable(work: MeshInWork) -> tuple[Bool, Bool]:
    """Nodes that may merge into any neighbour, and nodes that may merge along their line; each (n,)."""
    edges = work.edges
    count = len(work.positions)
    free = work.node_alive & ~work.kept
    fixed = edges.nodes[edges.frozen | (edges.kind == TANGLED)]
    free[fixed.ravel()] = False
    vertex_count = np.bincount(work.node[work.vertex_alive], minlength=count).astype(np.int32)
    line = np.flatnonzero(_is_line(edges))
    ends = edges.nodes[line].ravel()
    line_count = np.bincount(ends, minlength=count)
    inside = free & ~work.pinned & (line_count == 0) & (vertex_count == 1)

    order = np.argsort(ends, kind="stable")
    line_of = line[order // 2].astype(np.int32)
    start = np.searchsorted(ends[order], np.arange(count))
    nodes = np.flatnonzero(free & (line_count == 2)).astype(np.int32)
    one, two = line_of[start[nodes]], line_of[start[nodes] + 1]
    on_line = np.zeros(count, bool)
    on_line[nodes] = _is_straight(work, edges, nodes, one, two, vertex_count[nodes])
    return inside, on_line


def _is_straight(work: MeshInWork, edges: MeshEdges, nodes: Int, one: Int, two: Int, vertices: Int) -> Bool:
    """Tell where line edges `one` and `two` go straight on through `nodes` on every side; shape (k,)."""
    here_one, far_one = _side_vertices(work, edges, one, nodes)
    here_two, far_two = _side_vertices(work, edges, two, nodes)
    swapped = here_one[:, 0] != here_two[:, 0]
    far_two[swapped] = far_two[swapped, ::-1]
    here_two[swapped] = here_two[swapped, ::-1]
    straight = (edges.kind[one] == edges.kind[two]) & (here_one == here_two).all(axis=1)
    straight &= np.where(here_one[:, 0] == here_one[:, 1], 1, 2) == vertices
    for side in (0, 1):
        straight &= _between(work.rest, here_one[:, side], far_one[:, side], far_two[:, side])
    pinned = np.flatnonzero(work.pinned[nodes])
    row = work.node[far_one[pinned, 0]], work.node[far_two[pinned, 0]]
    in_row = np.isin(edges.kind[one[pinned]], (SEAM, BORDER)) & work.pinned[row[0]] & work.pinned[row[1]]
    straight[pinned] &= in_row & _between(work.positions, nodes[pinned], *row)
    return np.asarray(straight)


def _between(points: Float, middle: Int, a: Int, b: Int) -> Bool:
    """Tell where `middle` lies on the straight line between points a and b, shape (k,)."""
    to_a, to_b, length = points[a] - points[middle], points[b] - points[middle], points[b] - points[a]
    twice_area = row_cross(to_a, to_b)
    opposite = row_dot(to_a, to_b) < 0.0
    near = np.sqrt(row_dot(twice_area, twice_area)) <= STRAIGHTNESS * row_dot(length, length)
    return np.asarray(opposite & near)
