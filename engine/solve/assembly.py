"""Scattering of element gradients and blocks to the global vector and the block matrix.

An element's 3x3 blocks go to slots found once per topology (`block_pattern`). Scattering is serial, in
element order, hence deterministic.
"""

from numba import types

from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_3, I32_2, OUT_F64_2, OUT_F64_3, kernel

F64_4 = types.Array(types.float64, 4, "C", readonly=True)


def node_pairs(corner_count: int) -> tuple[tuple[int, int], ...]:
    """Return the order of an element's Hessian blocks: the diagonal ones, then (a, b) with a < b by rows."""
    corners = range(corner_count)
    return tuple((a, a) for a in corners) + tuple((a, b) for a in corners for b in corners if a < b)


@kernel(types.void(I32_2, F64_4, OUT_F64_3))
def scatter_hessians(slots: Int, hessians: Float, blocks: Float) -> None:
    """Add element Hessians [N/m], shape (E, k(k+1)/2, 3, 3), to the matrix blocks, shape (slot_count, 3, 3).

    `slots` is the entry of `BlockPattern.slots` for these elements. An off-diagonal block is row a,
    column b of the pair; where the slot is ~slot, its transpose is what is stored.
    """
    for e in range(slots.shape[0]):
        for p in range(slots.shape[1]):
            s = slots[e, p]
            if s >= 0:
                for r in range(3):
                    for c in range(3):
                        blocks[s, r, c] += hessians[e, p, r, c]
            else:
                for r in range(3):
                    for c in range(3):
                        blocks[~s, c, r] += hessians[e, p, r, c]


@kernel(types.void(I32_2, F64_3, OUT_F64_2))
def scatter_gradients(nodes: Int, gradients: Float, total: Float) -> None:
    """Add element gradients [N], shape (E, k, 3), to the nodal gradient, shape (node_count, 3)."""
    for e in range(nodes.shape[0]):
        for a in range(nodes.shape[1]):
            i = nodes[e, a]
            total[i, 0] += gradients[e, a, 0]
            total[i, 1] += gradients[e, a, 1]
            total[i, 2] += gradients[e, a, 2]
