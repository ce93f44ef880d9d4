"""Remove nodes where the metric wants longer edges."""

from typing import NamedTuple

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


class CollapseRound(NamedTuple):
    """What a round did.

    Attributes
    ----------
    merged
        Number of merges.
    touched
        Which of the faces that are left changed, shape (t,).
    kept
        Which of the faces before are left, shape (t',).
    pending
        Nodes whose merges stood in each other's way, shape (n,).
    """

    merged: int
    touched: Bool
    kept: Bool
    pending: Bool


def collapse_round(work: MeshInWork, gate: Gate, last: CollapseRound | None = None) -> CollapseRound:
    """Merge nodes into neighbours, no two merges touching. The rest shape stays exactly as it is.

    After the round `last`, whose touched faces must include those that flipped since, only merges near its
    changes and those pending are looked at: all others were impossible and still are.
    """
    near = None if last is None else last.pending.copy()
    if near is not None and last is not None:
        near[work.face_nodes[last.touched].ravel()] = True
    merges = possible_merges(work, LONGEST_NEW, near)
    choice = _Choice(work)
    while True:
        merges = merges.where(gate.open_to(_keys(merges)))
        taken, blocked = choice.among(merges)
        chosen, merges = merges.where(taken), merges.where(blocked)
        accepted = gate.passed(work.positions, _proposals(work, chosen), _keys(chosen))
        if accepted.any() or not len(accepted):
            break
    pending = np.zeros(len(work.positions), bool)
    pending[merges.removed] = True
    return CollapseRound(int(accepted.sum()), *_apply(work, chosen.where(accepted)), pending)


def collapsible(work: MeshInWork) -> int:
    """How many merges are possible at once."""
    return int(_Choice(work).among(possible_merges(work, LONGEST_NEW))[0].sum())


def _keys(merges: Merges) -> npt.NDArray[np.int64]:
    """One number per directed node pair; negative, to differ from the numbers of flips."""
    return np.asarray(~(merges.removed.astype(np.int64) << 32 | merges.target.astype(np.int64)))


class _Choice:
    """Chooses merges that can be done at once on a mesh that stays as it is meanwhile."""

    def __init__(self, work: MeshInWork) -> None:
        self._work = work
        face_nodes = work.face_nodes
        corners = face_nodes.ravel()
        self._offsets = np.zeros(len(work.positions) + 1, np.int32)
        np.cumsum(np.bincount(corners, minlength=len(work.positions)), out=self._offsets[1:])
        self._around = (np.argsort(corners, kind="stable") // 3).astype(np.int32)
        self._across = _far_nodes(work.edges, face_nodes)
        self._aspects = metric_aspects(work.faces, work.rest, work.tensors)

    def among(self, merges: Merges) -> tuple[Bool, Bool]:
        """Take merges in order; those taken, and those that one taken stands in the way of, shapes (k,)."""
        work = self._work
        taken, blocked = np.zeros((2, len(merges.removed)), bool)
        if len(taken):
            choose_merges(
                *merges, self._offsets, self._around, self._across, work.faces, work.node, work.rest,
                work.tensors, work.normals, self._aspects, LONGEST_NEW, np.zeros(len(work.faces), bool),
                np.zeros(len(work.positions), bool), np.full(len(work.positions), -1, np.int32), taken,
                blocked,
            )  # fmt: skip
        return taken, blocked


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


def _apply(work: MeshInWork, merges: Merges) -> tuple[Bool, Bool]:
    """Carry merges out; returns which of the remaining faces changed, shape (t,)."""
    faces, owner, heir = _after(work, merges)
    if not len(merges.removed):
        return np.zeros(len(faces), bool), np.ones(len(faces), bool)
    living = ~((owner >= 0) & _collapsed(work.node[faces]))
    work.faces = faces
    work.keep_faces(living)
    work.node_alive[merges.removed] = False
    work.vertex_alive[heir != np.arange(len(heir))] = False
    work.forget_edges()
    return np.asarray(owner[living] >= 0), living
