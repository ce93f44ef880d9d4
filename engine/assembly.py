"""Where element blocks meet the global vector and the block matrix.

The pattern is built once per topology; afterwards an element's 3x3 blocks go to
precomputed slots. Scattering is serial, in element order, hence deterministic.
"""

from collections.abc import Sequence

import numpy as np
from numba import types

from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_3, I32_2, OUT_F64_2, OUT_F64_3, kernel

F64_4 = types.Array(types.float64, 4, "C", readonly=True)


def node_pairs(corner_count: int) -> tuple[tuple[int, int], ...]:
    """Return the order of an element's Hessian blocks: the diagonal ones, then (a, b) with a < b by rows."""
    corners = range(corner_count)
    return tuple((a, a) for a in corners) + tuple((a, b) for a in corners for b in corners if a < b)


class BlockPattern:
    """Sparsity of a symmetric matrix of 3x3 blocks, one block row per node (block CSR).

    Two nodes are coupled when an element of any of the `stencils` holds both; every diagonal block
    exists. Both triangles of the matrix are stored, so a product reads each row straight through.

    Attributes
    ----------
    indptr : row i owns slots indptr[i] to indptr[i+1], shape (node_count + 1,).
    indices : block column of each slot, ascending within a row, shape (slot_count,).
    diagonal : slot of each diagonal block, shape (node_count,).
    slots : per stencil array (E, k), the slots of the blocks in the order of `node_pairs(k)`
        followed by those of the transposed off-diagonal blocks, shape (E, k*k).
    """

    def __init__(self, node_count: int, stencils: Sequence[Int]) -> None:
        own = np.arange(node_count, dtype=np.int64)
        keys = [own * (node_count + 1)]
        for stencil in stencils:
            pairs = node_pairs(stencil.shape[1])
            pairs += tuple((b, a) for a, b in pairs if a != b)
            nodes = stencil.astype(np.int64)
            if nodes.size and (nodes.min() < 0 or nodes.max() >= node_count):
                raise ValueError(f"stencils refer to nodes outside 0..{node_count - 1}")
            keys += [np.stack([nodes[:, a] * node_count + nodes[:, b] for a, b in pairs], axis=1).ravel()]
        unique, inverse = np.unique(np.concatenate(keys), return_inverse=True)
        slot: Int = inverse.astype(np.int32)
        self.node_count = node_count
        self.indices: Int = (unique % node_count).astype(np.int32)
        self.indptr: Int = np.searchsorted(unique, np.arange(node_count + 1) * node_count).astype(np.int32)
        self.diagonal: Int = slot[:node_count].copy()
        self.slots: list[Int] = []
        start = node_count
        for stencil in stencils:
            shape = (stencil.shape[0], stencil.shape[1] ** 2)
            self.slots.append(slot[start : start + shape[0] * shape[1]].reshape(shape).copy())
            start += shape[0] * shape[1]

    @property
    def slot_count(self) -> int:
        """Number of stored blocks."""
        return len(self.indices)

    def zeros(self) -> Float:
        """Return zero blocks for this pattern, shape (slot_count, 3, 3)."""
        return np.zeros((self.slot_count, 3, 3))


@kernel(types.void(I32_2, F64_4, OUT_F64_3))
def scatter_hessians(slots: Int, hessians: Float, blocks: Float) -> None:
    """Add element Hessians [N/m], shape (E, k(k+1)/2, 3, 3), to the matrix blocks, shape (slot_count, 3, 3).

    `slots` is the entry of `BlockPattern.slots` for these elements. An off-diagonal block is row a,
    column b of the pair; its transpose goes to (b, a).
    """
    pair_count = hessians.shape[1]
    slot_count = slots.shape[1]
    corner_count = 2 * pair_count - slot_count
    for e in range(slots.shape[0]):
        for p in range(pair_count):
            s = slots[e, p]
            for r in range(3):
                for c in range(3):
                    blocks[s, r, c] += hessians[e, p, r, c]
        for p in range(corner_count, pair_count):
            s = slots[e, p - corner_count + pair_count]
            for r in range(3):
                for c in range(3):
                    blocks[s, c, r] += hessians[e, p, r, c]


@kernel(types.void(I32_2, F64_3, OUT_F64_2))
def scatter_gradients(nodes: Int, gradients: Float, total: Float) -> None:
    """Add element gradients [N], shape (E, k, 3), to the nodal gradient, shape (node_count, 3)."""
    for e in range(nodes.shape[0]):
        for a in range(nodes.shape[1]):
            i = nodes[e, a]
            total[i, 0] += gradients[e, a, 0]
            total[i, 1] += gradients[e, a, 1]
            total[i, 2] += gradients[e, a, 2]


def to_dense(indptr: Int, indices: Int, blocks: Float) -> Float:
    """Return the matrix as a dense array, shape (3 node_count, 3 node_count). For tests and tiny systems."""
    node_count = len(indptr) - 1
    dense = np.zeros((node_count, 3, node_count, 3))
    rows = np.repeat(np.arange(node_count), np.diff(indptr))
    dense[rows, :, indices, :] = blocks
    return dense.reshape(3 * node_count, 3 * node_count)
