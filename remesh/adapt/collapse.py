"""Removal of nodes where the metric wants longer edges."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from toile.geometry.arrays import Bool
from toile.remesh.adapt.acceptance import Gate, Proposals
from toile.remesh.adapt.choose_merges import choose_merges
from toile.remesh.adapt.merge_patches import after_merges
from toile.remesh.adapt.mesh_in_work import MeshInWork
from toile.remesh.adapt.removable_nodes import Merges, possible_merges
from toile.remesh.mesh.mesh_edges import in_sorted
from toile.remesh.mesh.node_faces import node_faces
from toile.remesh.sizing.edge_size import metric_aspects

LONGEST_NEW = 0.9
"""Longest edge that a collapse may make, in the metric: well below what is split, or both would alternate."""


class CollapseRound(NamedTuple):
    """Outcome of one round.

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
        merges = merges.where(~in_sorted(_keys(merges), gate.refused))
        taken, blocked = choice.among(merges)
        chosen, merges = merges.where(taken), merges.where(blocked)
        accepted = gate.passed(work.positions, _proposals(work, chosen), _keys(chosen))
        if accepted.any() or not len(accepted):
            break
    pending = np.zeros(len(work.positions), bool)
    pending[merges.removed] = True
    return CollapseRound(int(accepted.sum()), *_apply(work, chosen.where(accepted)), pending)


def collapsible(work: MeshInWork) -> int:
    """Count the merges that are possible at once."""
    return int(_Choice(work).among(possible_merges(work, LONGEST_NEW))[0].sum())


def _keys(merges: Merges) -> npt.NDArray[np.int64]:
    """One number per directed node pair; negative, to differ from the numbers of flips."""
    return np.asarray(~(merges.removed.astype(np.int64) << 32 | merges.target.astype(np.int64)))


class _Choice:
    """Chooses merges that can be done at once on a mesh that stays as it is meanwhile."""

    def __init__(self, work: MeshInWork) -> None:
        self._work = work
        self._near = node_faces(work.edges, work.face_nodes, len(work.positions))
        self._aspects = metric_aspects(work.faces, work.rest, work.tensors)

    def among(self, merges: Merges) -> tuple[Bool, Bool]:
        """Take merges in order; those taken, and those that one taken stands in the way of, shapes (k,)."""
        work = self._work
        taken, blocked = np.zeros((2, len(merges.removed)), bool)
        if len(taken):
            choose_merges(
                *merges, *self._near, work.faces, work.node, work.rest, work.tensors, work.normals,
                self._aspects, LONGEST_NEW, np.zeros(len(work.faces), bool),
                np.zeros(len(work.positions), bool), np.full(len(work.positions), -1, np.int32), taken,
                blocked,
            )  # fmt: skip
        return taken, blocked


def _proposals(work: MeshInWork, merges: Merges) -> Proposals:
    faces, owner, vanish = after_merges(work, merges)
    changed = np.flatnonzero(owner >= 0).astype(np.int32)
    left = changed[~vanish[changed]]
    return Proposals(
        triangles=work.node[faces[left]],
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
    """Carry merges out; returns which of the remaining faces changed, shape (t,), and which remain, (t',)."""
    if not len(merges.removed):
        return np.zeros(len(work.faces), bool), np.ones(len(work.faces), bool)
    work.faces, owner, vanish = after_merges(work, merges)
    living = ~vanish
    work.keep_faces(living)
    work.node_alive[merges.removed] = False
    work.vertex_alive[merges.vertices.ravel()] = False
    work.forget_edges()
    return np.asarray(owner[living] >= 0), living
