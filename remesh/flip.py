"""Flip edges that are not Delaunay in the metric, within flat parts of one panel."""

import numpy as np

from toile.geometry.arrays import Bool, Float, Int
from toile.remesh.acceptance import Gate, Proposals
from toile.remesh.disjoint_pairs import first_disjoint
from toile.remesh.edge_size import LONGEST
from toile.remesh.judge_flips import judge_flips
from toile.remesh.mesh_edges import INNER, MeshEdges, corner_after, in_sorted, pair_keys
from toile.remesh.mesh_in_work import MeshInWork

FLIP_MARGIN = 0.05
"""Sine of the angle by which opposite angles must exceed 180 degrees together: near a tie nothing flips, or
the mesh of a still cloth would go on changing with the last digits of the metric."""

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
    fixed = (edges.kind != INNER) | edges.creased | edges.frozen
    active = active[~fixed[active]]
    quads = _quads(work.faces, edges, active)
    excess = _excess(work, quads, active)
    chosen = np.flatnonzero(excess > -np.inf)
    chosen = chosen[_allowed(work, gate, quads[chosen], active[chosen])]
    chosen = chosen[np.argsort(-excess[chosen], kind="stable")]
    chosen = chosen[first_disjoint(edges.faces[active[chosen]], len(work.faces))]
    quads, flipping = quads[chosen], active[chosen]
    ends = work.node[quads[:, [0, 3]]]
    _, first = np.unique(pair_keys(ends[:, 0], ends[:, 1]), return_index=True)
    first.sort()
    accepted = first[_passed(work, gate, quads[first], flipping[first])]
    _apply(work, quads[accepted], flipping[accepted])
    return flipping[accepted]


def _quads(faces: Int, edges: MeshEdges, chosen: Int) -> Int:
    """Material vertices a, b, c, d of the faces abc and dcb at edges bc, shape (k, 4)."""
    t, u = edges.faces[chosen].T
    k, j = edges.sides[chosen].T
    corners = [faces[t, k], corner_after(faces, t, k, 1), corner_after(faces, t, k, 2), faces[u, j]]
    return np.stack(corners, axis=1)


def _excess(work: MeshInWork, quads: Int, flipping: Int) -> Float:
    """By how much edges should flip, shape (k,); see `judge_flips`."""
    excess = np.empty(len(quads))
    pair = work.edges.faces[flipping]
    judge_flips(
        quads, np.ascontiguousarray(pair[:, 0]), work.faces[pair].reshape(-1, 6), work.rest, work.tensors,
        work.frames, work.normals, FLIP_MARGIN, LONGEST, WELL_SHAPED, excess,
    )  # fmt: skip
    return excess


def _new_faces(quads: Int) -> Int:
    """Faces abd and adc of quads, shape (k, 2, 3)."""
    return np.ascontiguousarray(quads[:, [[0, 1, 3], [0, 3, 2]]])


def _allowed(work: MeshInWork, gate: Gate, quads: Int, flipping: Int) -> Bool:
    """Tell which flips make an edge that is not there yet and have not been refused, shape (k,)."""
    a, d = work.node[quads[:, 0]], work.node[quads[:, 3]]
    ends = work.edges.nodes[flipping]
    allowed = (a != d) & ~in_sorted(pair_keys(a, d), work.edges.keys)
    return np.asarray(allowed & gate.open_to(pair_keys(ends[:, 0], ends[:, 1])))


def _passed(work: MeshInWork, gate: Gate, quads: Int, flipping: Int) -> Bool:
    """Ask for acceptance, shape (k,)."""
    owner = np.repeat(np.arange(len(quads), dtype=np.int32), 2)
    new, removed = _new_faces(quads).reshape(-1, 3), work.edges.faces[flipping].ravel()
    proposals = Proposals(
        triangles=work.node[new],
        owner=owner,
        removed=removed,
        removed_owner=owner,
        rest_corners=work.rest_corners(new, removed),
        removed_rest_corners=work.rest_corners(work.faces[removed], removed),
        origin=work.parent[removed],
        removed_origin=work.parent[removed],
        face_nodes=work.face_nodes,
        proposal_count=len(quads),
    )
    ends = work.edges.nodes[flipping]
    return gate.passed(work.positions, proposals, pair_keys(ends[:, 0], ends[:, 1]))


def _apply(work: MeshInWork, quads: Int, flipping: Int) -> None:
    """Replace faces abc, dcb by abd, adc, and bring the edges up to date."""
    edges = work.edges
    t, u = edges.faces[flipping].T
    k, j = edges.sides[flipping].T
    ca, ab = corner_after(edges.face_edges, t, k, 1), corner_after(edges.face_edges, t, k, 2)
    bd, dc = corner_after(edges.face_edges, u, j, 1), corner_after(edges.face_edges, u, j, 2)
    edges.replace_face(bd, u, t, 0)
    edges.replace_face(ab, t, t, 2)
    edges.replace_face(dc, u, u, 0)
    edges.replace_face(ca, t, u, 1)
    edges.faces[flipping] = np.stack([t, u], axis=1)
    edges.sides[flipping] = (1, 2)
    edges.face_edges[t] = np.stack([bd, flipping, ab], axis=1)
    edges.face_edges[u] = np.stack([dc, ca, flipping], axis=1)
    a, d = work.node[quads[:, 0]], work.node[quads[:, 3]]
    edges.nodes[flipping] = np.stack([np.minimum(a, d), np.maximum(a, d)], axis=1)
    keys = np.sort(pair_keys(a, d))
    edges.keys = np.insert(edges.keys, np.searchsorted(edges.keys, keys), keys)
    faces = _new_faces(quads)
    work.faces[t], work.faces[u] = faces[:, 0], faces[:, 1]
