"""Flips of edges that are not Delaunay in the metric, within flat parts of one panel."""

import numpy as np

from toile.geometry.arrays import Bool, Int
from toile.remesh.adapt.acceptance import Gate, Proposals
from toile.remesh.adapt.flip_round import choose_flips, turn_edges
from toile.remesh.adapt.judge_flips import judge_flips
from toile.remesh.adapt.mesh_in_work import MeshInWork
from toile.remesh.mesh.mesh_edges import INNER, MeshEdges, pair_keys
from toile.remesh.sizing.edge_size import LONGEST

FLIP_MARGIN = 0.05
"""Sine of the angle by which opposite angles must exceed 180 degrees together: near a tie nothing flips, or
the mesh of a still cloth would keep changing with the last digits of the metric."""

WELL_SHAPED = 0.2
"""Aspect in the metric below which no change may make a triangle worse."""


def flip_edges(work: MeshInWork, gate: Gate, touched: Bool | None = None) -> int:
    """Flip until the edges are Delaunay in the metric; returns the number of flips.

    With `touched`, shape (t,), starts from the edges of these faces only, and marks in it the faces it
    changes. An edge once flipped away is not made again, so this ends.
    """
    edges = work.edges
    active = np.flatnonzero(edges.kind == INNER).astype(np.int32)
    if touched is not None:
        active = _edges_of(edges, touched)
    flips = 0
    while len(active):
        flipped = _flip_round(work, gate, active)
        flips += len(flipped)
        changed = edges.faces[flipped].ravel()
        if touched is not None:
            touched[changed] = True
        active = _edges_of(edges, changed)
    return flips


def _edges_of(edges: MeshEdges, faces: Bool | Int) -> Int:
    """Edges of some faces, in order, shape (k,)."""
    marked = np.zeros(len(edges.nodes), bool)
    marked[edges.face_edges[faces]] = True
    return np.flatnonzero(marked).astype(np.int32)


def _flip_round(work: MeshInWork, gate: Gate, active: Int) -> Int:
    """Flip edges out of `active` that share no face; returns them."""
    edges = work.edges
    quads, excess = np.empty((len(active), 4), np.int32), np.empty(len(active))
    judge_flips(
        active, edges.kind, edges.creased, edges.frozen, edges.faces, edges.sides, work.faces, work.rest,
        work.tensors, work.frames, work.normals, FLIP_MARGIN, LONGEST, WELL_SHAPED, quads, excess,
    )  # fmt: skip
    taken = np.empty(len(active), np.int32)
    count = choose_flips(
        np.argsort(-excess, kind="stable"), excess, quads, active, edges.nodes, edges.faces, work.node,
        edges.keys, gate.refused, np.zeros(len(work.faces), bool),
        np.full(len(work.positions), -1, np.int32), np.empty((len(active), 2), np.int32), taken,
    )  # fmt: skip
    if not count:
        return active[:0]
    chosen = taken[:count]
    chosen = chosen[_passed(work, gate, quads[chosen], active[chosen])]
    quads, flipping = quads[chosen], active[chosen]
    turn_edges(
        flipping, quads, work.node, work.faces, edges.nodes, edges.faces, edges.sides, edges.face_edges
    )
    edges.add_keys(pair_keys(work.node[quads[:, 0]], work.node[quads[:, 3]]))
    return flipping


def _passed(work: MeshInWork, gate: Gate, quads: Int, flipping: Int) -> Bool:
    """Ask for acceptance, shape (k,)."""
    owner = np.repeat(np.arange(len(quads), dtype=np.int32), 2)
    new, removed = (
        np.ascontiguousarray(quads[:, [0, 1, 3, 0, 3, 2]]).reshape(-1, 3),
        work.edges.faces[flipping].ravel(),
    )
    origin = work.parent[removed]
    proposals = Proposals(
        triangles=work.node[new],
        owner=owner,
        removed=removed,
        removed_owner=owner,
        rest_corners=work.rest_corners(new, removed),
        removed_rest_corners=work.rest_corners(work.faces[removed], removed),
        origin=origin,
        removed_origin=origin,
        face_nodes=work.face_nodes,
        proposal_count=len(quads),
    )
    ends = work.edges.nodes[flipping]
    return gate.passed(work.positions, proposals, pair_keys(ends[:, 0], ends[:, 1]))
