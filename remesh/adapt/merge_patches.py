"""Faces around merged nodes, before and after the merge."""

import numpy as np
from numba import types

from toile.geometry.arrays import Bool, Int
from toile.geometry.kernel import I32_1, I32_2, OUT_BOOL_1, OUT_I32_1, OUT_I32_2, kernel
from toile.remesh.adapt.mesh_in_work import MeshInWork
from toile.remesh.adapt.removable_nodes import Merges


def after_merges(work: MeshInWork, merges: Merges) -> tuple[Int, Int, Bool]:
    """Faces after merges (t, 3), the merge that changes each (-1: none), and which vanish, shapes (t,)."""
    faces, owner = work.faces.copy(), np.empty(len(work.faces), np.int32)
    vanish = np.empty(len(faces), bool)
    _merge(
        merges.removed, merges.vertices, merges.target_vertices, work.node,
        np.full(len(work.positions), -1, np.int32), faces, owner, vanish,
    )  # fmt: skip
    return faces, owner, vanish


@kernel(types.void(I32_1, I32_2, I32_2, I32_1, OUT_I32_1, OUT_I32_2, OUT_I32_1, OUT_BOOL_1))
def _merge(removed, vertices, target_vertices, node, of_node, faces, owner, vanish):  # type: ignore[no-untyped-def]
    """Merge in `faces`; work space: `of_node` (n,), all -1."""
    for row in range(len(removed)):
        of_node[removed[row]] = row
    for t in range(len(faces)):
        owner[t] = -1
        vanish[t] = False
        for k in range(3):
            vertex = faces[t, k]
            row = of_node[node[vertex]]
            if row < 0:
                continue
            owner[t] = max(owner[t], row)
            faces[t, k] = target_vertices[row, 0 if vertices[row, 0] == vertex else 1]
        if owner[t] >= 0:
            i, j, k = node[faces[t, 0]], node[faces[t, 1]], node[faces[t, 2]]
            vanish[t] = i == j or j == k or k == i
