"""Nodes that can be removed without changing the rest shape, and the edges along which they can.

A node inside a flat part may be merged into any neighbour. On a line (border, seam, or crease of the rest
shape) it may be merged into its two neighbours on the line, if the line is straight there on every side.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import types

from toile.geometry.arrays import Bool, Int
from toile.geometry.kernel import (
    BOOL_1,
    F64_2,
    I8_1,
    I32_1,
    I32_2,
    I64_1,
    OUT_BOOL_1,
    OUT_I32_1,
    OUT_I32_2,
    helper,
    kernel,
)
from toile.remesh.adapt.mesh_in_work import MeshInWork
from toile.remesh.mesh.mesh_edges import BORDER, INNER, SEAM, TANGLED
from toile.remesh.sizing.edge_size import edge_sizes

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
    short = short[np.argsort(size[short], kind="stable")]
    inside, on_line = _removable(work)
    most = 2 * len(short)
    found = Merges(*np.empty((2, most), np.int32), *np.empty((2, most, 2), np.int32))
    count = _list_merges(
        short, edges.nodes, edges.kind, edges.creased, edges.faces, edges.sides, work.faces, work.node,
        inside, on_line, *found,
    )  # fmt: skip
    return found.where(np.arange(count))


@helper
def _is_line(kind, creased, edge):  # type: ignore[no-untyped-def]
    return kind[edge] != INNER or creased[edge]


@helper
def _ends(at_faces, sides, faces, node, edge, side, at):  # type: ignore[no-untyped-def]
    """Material vertices of node `at` and of the other end of an edge, on one of its two sides.

    An edge with one face shows its one side twice.
    """
    if at_faces[edge, side] < 0:
        side = 0
    t, k = at_faces[edge, side], sides[edge, side]
    p, q = faces[t, (k + 1) % 3], faces[t, (k + 2) % 3]
    if node[p] == at:
        return p, q
    return q, p


@kernel(
    types.int64(
        I64_1, I32_2, I8_1, BOOL_1, I32_2, I32_2, I32_2, I32_1, BOOL_1, BOOL_1, OUT_I32_1, OUT_I32_1,
        OUT_I32_2, OUT_I32_2,
    )
)  # fmt: skip
def _list_merges(  # type: ignore[no-untyped-def]
    short, nodes, kind, creased, at_faces, sides, faces, node, inside, on_line, removed, target, vertices,
    target_vertices,
):  # fmt: skip
    """Write the merges of removable nodes along the edges `short`, in order; returns how many."""
    count = 0
    for edge in short:
        line = _is_line(kind, creased, edge)
        for end in range(2):
            i = nodes[edge, end]
            if not (on_line[i] if line else inside[i]):
                continue
            removed[count], target[count] = i, nodes[edge, 1 - end]
            for side in range(2):
                here, there = _ends(at_faces, sides, faces, node, edge, side, i)
                vertices[count, side], target_vertices[count, side] = here, there
            count += 1
    return count


def _removable(work: MeshInWork) -> tuple[Bool, Bool]:
    """Nodes that may merge into any neighbour, and nodes that may merge along their line; each (n,)."""
    edges, count = work.edges, len(work.positions)
    inside, on_line = work.node_alive & ~work.kept, np.empty(count, bool)
    _mark_removable(
        edges.nodes, edges.kind, edges.creased, edges.frozen, edges.faces, edges.sides, work.faces, work.node,
        work.rest, work.positions, work.pinned, work.vertex_alive, np.zeros((count, 4), np.int32), inside,
        on_line,
    )  # fmt: skip
    return inside, on_line


@helper
def _is_between(points, middle, a, b):  # type: ignore[no-untyped-def]
    """Tell whether `middle` lies on the straight line between points a and b."""
    ax, ay, az = (
        points[a, 0] - points[middle, 0],
        points[a, 1] - points[middle, 1],
        points[a, 2] - points[middle, 2],
    )
    bx, by, bz = (
        points[b, 0] - points[middle, 0],
        points[b, 1] - points[middle, 1],
        points[b, 2] - points[middle, 2],
    )
    lx, ly, lz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
    x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    opposite = ax * bx + ay * by + az * bz < 0.0
    return opposite and math.sqrt(x * x + y * y + z * z) <= STRAIGHTNESS * (lx * lx + ly * ly + lz * lz)


@helper
def _is_straight(  # type: ignore[no-untyped-def]
    kind, seen, node, rest, positions, pinned, i, one, two, vertex_count
):
    """Tell whether line edges `one` and `two` go straight on through node i on every side.

    `seen` (4, 2) are the vertices at i and at the far end: of `one` on both its sides, then of `two`.
    """
    if kind[one] != kind[two] or vertex_count != (1 if seen[0, 0] == seen[1, 0] else 2):
        return False
    swapped = 0 if seen[0, 0] == seen[2, 0] else 1
    j, k = node[seen[0, 1]], node[seen[2 + swapped, 1]]
    tests = 2
    if pinned[i]:
        if not ((kind[one] == SEAM or kind[one] == BORDER) and pinned[j] and pinned[k]):
            return False
        tests = 3
    # One call for all: every call of a helper is compiled once more.
    for test in range(tests):
        points, middle, far, far_two = positions, i, j, k
        if test < 2:
            other = 2 + (test ^ swapped)
            if seen[test, 0] != seen[other, 0]:
                return False
            points, middle, far, far_two = rest, seen[test, 0], seen[test, 1], seen[other, 1]
        if not _is_between(points, middle, far, far_two):
            return False
    return True


@kernel(
    types.void(
        I32_2, I8_1, BOOL_1, BOOL_1, I32_2, I32_2, I32_2, I32_1, F64_2, F64_2, BOOL_1, BOOL_1, OUT_I32_2,
        OUT_BOOL_1, OUT_BOOL_1,
    )
)  # fmt: skip
def _mark_removable(  # type: ignore[no-untyped-def]
    nodes, kind, creased, frozen, at_faces, sides, faces, node, rest, positions, pinned, vertex_alive, tally,
    inside, on_line,
):  # fmt: skip
    """Mark nodes `inside` flat parts and `on_line`; those that must stay are not marked in `inside` before.

    Work space: `tally` (n, 4), all 0: how many vertices and lines a node has, and its first two lines.
    """
    for vertex in range(len(node)):
        if vertex_alive[vertex]:
            tally[node[vertex], 0] += 1
    for edge in range(len(nodes)):
        fixed = frozen[edge] or kind[edge] == TANGLED
        line = _is_line(kind, creased, edge)
        for end in range(2):
            i = nodes[edge, end]
            if fixed:
                inside[i] = False
            if line:
                if tally[i, 1] < 2:
                    tally[i, 2 + tally[i, 1]] = edge
                tally[i, 1] += 1
    seen = np.empty((4, 2), np.int32)
    for i in range(len(inside)):
        on_line[i] = False
        if inside[i] and tally[i, 1] == 2:
            for row in range(4):
                here, far = _ends(at_faces, sides, faces, node, tally[i, 2 + row // 2], row % 2, i)
                seen[row, 0], seen[row, 1] = here, far
            on_line[i] = _is_straight(
                kind, seen, node, rest, positions, pinned, i, tally[i, 2], tally[i, 3], tally[i, 0]
            )
        inside[i] = inside[i] and not pinned[i] and tally[i, 1] == 0 and tally[i, 0] == 1
