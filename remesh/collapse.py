"""Remove nodes where the metric wants longer edges."""

import numpy as np
import numpy.typing as npt

from toile.geometry.arrays import Bool, Int
from toile.remesh.acceptance import Gate, Proposals
from toile.remesh.choose_merges import choose_merges
from toile.remesh.edge_size import metric_aspects
from toile.remesh.mesh_edges import MeshEdges
from toile.remesh.mesh_in_work import MeshInWork
from toile.remesh.removable_nodes import Merges, possible_merges

LONGEST_NEW = 0.9
"""Longest edge that a collapse may make, in the metric: well below what is split, or both would alternate."""


def collapse_round(work: MeshInWork, gate: Gate) -> tuple[int, Bool]:
    """Merge nodes into neighbours, no two merges touching; return how many, and which faces changed, (t,).

    The rest shape stays exactly as it is.
    """
    while True:
        merges = possible_merges(work, LONGEST_NEW)
        merges = merges.where(gate.open_to(_keys(merges)))
        merges = merges.where(_chosen(work, merges))
        accepted = gate.passed(work.positions, _proposals(work, merges), _keys(merges))
        if accepted.any() or not len(accepted):
            break
    return int(accepted.sum()), _apply(work, merges.where(accepted))


def _keys(merges: Merges) -> npt.NDArray[np.int64]:
    """One number per directed node pair; negative, to differ from the numbers of flips."""
    return np.asarray(~(merges.removed.astype(np.int64) << 32 | merges.target.astype(np.int64)))


def _chosen(work: MeshInWork, merges: Merges) -> Bool:
    """Take merges in order that can be done at once, shape (k,)."""
    taken = np.zeros(len(merges.removed), bool)
    if len(taken):
        face_nodes = work.face_nodes
        corners = face_nodes.ravel()
        offsets = np.zeros(len(work.positions) + 1, np.int32)
        np.cumsum(np.bincount(corners, minlength=len(work.positions)), out=offsets[1:])
        around = (np.argsort(corners, kind="stable") // 3).astype(np.int32)
        across = _far_nodes(work.edges, face_nodes)
        stamps = np.full(len(work.positions), -1, np.int32)
        used, is_target = np.zeros(len(work.faces), bool), np.zeros(len(work.positions), bool)
        choose_merges(
            *merges, offsets, around, across, work.faces, work.node, work.rest, work.tensors, work.normals,
            metric_aspects(work.faces, work.rest, work.tensors), LONGEST_NEW, used, is_target, stamps, taken,
        )  # fmt: skip
    return taken


def _far_nodes(edges: MeshEdges, face_nodes: Int) -> Int:
    """Node opposite to every side in the face across it, shape (t, 3); -1 where there is none."""
    pair = edges.faces[edges.face_edges]
    own = np.arange(len(face_nodes), dtype=np.int32)[:, None]
    slot = np.where(pair[..., 0] == own, 1, 0)
    other = np.take_along_axis(pair, slot[..., None], axis=2)[..., 0]
    side = np.take_along_axis(edges.sides[edges.face_edges], slot[..., None], axis=2)[..., 0]
    return np.where(other < 0, -1, face_nodes[other, side]).astype(np.int32)


def _after(work: MeshInWork, merges: Merges) -> tuple[Int, Int, Int]:
    """Faces after the merges (t, 3), the merge that changes each face (-1: none), each vertex's heir."""
    heir = np.arange(len(work.rest), dtype=np.int32)
    heir[merges.vertices] = merges.target_vertices
    merge_of_node = np.full(len(work.positions), -1, np.int32)
    merge_of_node[merges.removed] = np.arange(len(merges.removed), dtype=np.int32)
    return heir[work.faces], merge_of_node[work.face_nodes].max(axis=1), heir


def _collapsed(face_nodes: Int) -> Bool:
    a, b, c = face_nodes.T
    return np.asarray((a == b) | (b == c) | (c == a))


def _proposals(work: MeshInWork, merges: Merges) -> Proposals:
    faces, owner, _ = _after(work, merges)
    changed = np.flatnonzero(owner >= 0).astype(np.int32)
    nodes = work.node[faces[changed]]
    new = ~_collapsed(nodes)
    left = changed[new]
    return Proposals(
        triangles=nodes[new],
        owner=owner[left],
        removed=changed,
        removed_owner=owner[changed],
        rest_corners=work.rest_corners(faces[left], left),
        removed_rest_corners=work.rest_corners(work.faces[changed], changed),
        origin=work.parent[left],
        removed_origin=work.parent[changed],
        face_nodes=work.face_nodes,
        proposal_count=len(merges.removed),
    )


def _apply(work: MeshInWork, merges: Merges) -> Bool:
    """Carry merges out; returns which of the remaining faces changed, shape (t,)."""
    faces, owner, heir = _after(work, merges)
    if not len(merges.removed):
        return np.zeros(len(faces), bool)
    living = ~((owner >= 0) & _collapsed(work.node[faces]))
    work.faces = faces
    work.keep_faces(living)
    work.node_alive[merges.removed] = False
    work.vertex_alive[heir != np.arange(len(heir))] = False
    work.forget_edges()
    return np.asarray(owner[living] >= 0)
