"""Where the 3x3 blocks of a symmetric matrix lie: its diagonal, and one triangle of it."""

from collections.abc import Sequence

import numpy as np
from numba import types
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from toile.engine.assembly import node_pairs
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_2, F64_3, I32_1, OUT_F64_2, kernel, unsigned


class BlockPattern:
    """Sparsity of a symmetric matrix of 3x3 blocks, one block row per node.

    Two nodes are coupled when an element of any of the `stencils` holds both; every diagonal block
    exists. One triangle is stored: a product is bound by the memory it reads, and Gauss-Seidel sweeps
    read the very same numbers. Nodes are ranked in reverse Cuthill-McKee order; a block belongs to the row
    of the node with the higher rank. The first blocks are the diagonal, by rank; the lower triangle follows.
    So are the numbers of a vector: what a row asks for was read a few rows before, wherever a mesher put it.

    Attributes
    ----------
    order : nodes by rank, shape (node_count,).
    rank : rank of each node, shape (node_count,). It is the slot of the node's diagonal block as well.
    lower_indptr : the row of rank o owns blocks lower_indptr[o] to lower_indptr[o + 1] of the lower
        triangle, shape (node_count + 1,).
    lower_ranks : block column of each, as a rank, ascending within a row, shape (slot_count - node_count,).
    slots : per stencil array (E, k), the slots of the blocks in the order of `node_pairs(k)`, shape
        (E, k(k + 1) / 2); ~slot where the block is stored transposed.
    indptr, indices : neighbours of each node, itself among them, ascending (CSR of both triangles).
    entries : slot of each of them, ~slot where it is stored transposed, shape like `indices`.
    """

    def __init__(self, node_count: int, stencils: Sequence[Int]) -> None:
        keys = [np.empty(0, np.int64)]
        for stencil in stencils:
            nodes = stencil.astype(np.int64)
            if nodes.size and (nodes.min() < 0 or nodes.max() >= node_count):
                raise ValueError(f"stencils refer to nodes outside 0..{node_count - 1}")
            for a, b in _off_diagonal(stencil):
                if (nodes[:, a] == nodes[:, b]).any():
                    raise ValueError("a stencil holds the same node twice")
                first, last = np.minimum(nodes[:, a], nodes[:, b]), np.maximum(nodes[:, a], nodes[:, b])
                keys.append(first * node_count + last)
        unique, inverse = np.unique(np.concatenate(keys), return_inverse=True)
        first, last, own = unique // node_count, unique % node_count, np.arange(node_count)
        both = np.concatenate([own, first, last]), np.concatenate([own, last, first])
        graph = csr_array((np.arange(len(both[0])), both), shape=(node_count, node_count))
        graph.sort_indices()
        self.node_count = node_count
        self.indptr: Int = graph.indptr.astype(np.int32)
        self.indices: Int = graph.indices.astype(np.int32)
        self.order: Int = np.ascontiguousarray(
            reverse_cuthill_mckee(graph, symmetric_mode=True), dtype=np.int32
        )
        self.rank: Int = np.empty(node_count, np.int32)
        self.rank[self.order] = np.arange(node_count, dtype=np.int32)
        ranks = self.rank[first], self.rank[last]
        rows, columns = np.maximum(*ranks), np.minimum(*ranks)
        by_row = np.argsort(rows.astype(np.int64) * node_count + columns)
        self.lower_indptr: Int = np.append(0, np.cumsum(np.bincount(rows, minlength=node_count))).astype(
            np.int32
        )
        self.lower_ranks: Int = columns[by_row]
        slots = np.empty(len(unique), np.int32)
        slots[by_row] = np.arange(node_count, node_count + len(unique), dtype=np.int32)
        forwards = np.where(ranks[0] > ranks[1], slots, ~slots)
        self.entries: Int = np.concatenate([self.rank, forwards, ~forwards])[graph.data]
        self.slots: list[Int] = []
        begin = 0
        for stencil in stencils:
            found = [self.rank[stencil[:, a]] for a in range(stencil.shape[1])]
            for a, b in _off_diagonal(stencil):
                pair = forwards[inverse[begin : begin + len(stencil)]]
                found.append(np.where(stencil[:, a] < stencil[:, b], pair, ~pair))
                begin += len(stencil)
            self.slots.append(np.stack(found, axis=1))

    @property
    def slot_count(self) -> int:
        """Number of stored blocks."""
        return self.node_count + len(self.lower_ranks)

    def zeros(self) -> Float:
        """Return zero blocks for this pattern, shape (slot_count, 3, 3)."""
        return np.zeros((self.slot_count, 3, 3))

    def diagonal(self, blocks: Float) -> Float:
        """Return the diagonal blocks by rank, a view, shape (node_count, 3, 3)."""
        return blocks[: self.node_count]

    def lower(self, blocks: Float) -> Float:
        """Return the blocks below the diagonal, a view, shape (slot_count - node_count, 3, 3)."""
        return blocks[self.node_count :]

    def multiply(self, blocks: Float, x: Float, start: Float, product: Float) -> float:
        """Write start + B x into `product`, shape (node_count, 3), by rank, and return its product with x.

        `start` has shape (node_count, 4), of which the last column has no meaning.
        """
        total: float = _multiply(
            self.lower_indptr,
            self.lower_ranks,
            self.diagonal(blocks),
            self.lower(blocks),
            x,
            start,
            product,
        )
        return total

    def to_dense(self, blocks: Float) -> Float:
        """Return the matrix as a dense array, shape (3 node_count, 3 node_count). For tests, tiny systems."""
        dense = np.zeros((self.node_count, 3, self.node_count, 3))
        rows = np.repeat(np.arange(self.node_count), np.diff(self.indptr))
        as_stored = self.entries >= 0
        dense[rows[as_stored], :, self.indices[as_stored], :] = blocks[self.entries[as_stored]]
        turned = blocks[~self.entries[~as_stored]].transpose(0, 2, 1)
        dense[rows[~as_stored], :, self.indices[~as_stored], :] = turned
        return dense.reshape(3 * self.node_count, 3 * self.node_count)


def _off_diagonal(stencil: Int) -> tuple[tuple[int, int], ...]:
    """Return the pairs of different corners, in the order of `node_pairs`."""
    return node_pairs(stencil.shape[1])[stencil.shape[1] :]


@kernel(types.float64(I32_1, I32_1, F64_3, F64_3, F64_2, F64_2, OUT_F64_2))
def _multiply(
    indptr: Int,
    ranks: Int,
    diagonal: Float,
    lower: Float,
    x: Float,
    start: Float,
    product: Float,
) -> float:
    total = 0.0
    for row in range(diagonal.shape[0]):
        o = unsigned(row)
        u0 = x[o, 0]
        u1 = x[o, 1]
        u2 = x[o, 2]
        y0 = start[o, 0] + (diagonal[o, 0, 0] * u0 + diagonal[o, 0, 1] * u1 + diagonal[o, 0, 2] * u2)
        y1 = start[o, 1] + (diagonal[o, 1, 0] * u0 + diagonal[o, 1, 1] * u1 + diagonal[o, 1, 2] * u2)
        y2 = start[o, 2] + (diagonal[o, 2, 0] * u0 + diagonal[o, 2, 1] * u1 + diagonal[o, 2, 2] * u2)
        # What the row below the diagonal gives: counted twice in the total, for the column above it.
        z0 = 0.0
        z1 = 0.0
        z2 = 0.0
        for k in range(unsigned(indptr[o]), unsigned(indptr[row + 1])):
            j = unsigned(ranks[k])
            x0 = x[j, 0]
            x1 = x[j, 1]
            x2 = x[j, 2]
            b00 = lower[k, 0, 0]
            b01 = lower[k, 0, 1]
            b02 = lower[k, 0, 2]
            b10 = lower[k, 1, 0]
            b11 = lower[k, 1, 1]
            b12 = lower[k, 1, 2]
            b20 = lower[k, 2, 0]
            b21 = lower[k, 2, 1]
            b22 = lower[k, 2, 2]
            z0 += b00 * x0 + b01 * x1 + b02 * x2
            z1 += b10 * x0 + b11 * x1 + b12 * x2
            z2 += b20 * x0 + b21 * x1 + b22 * x2
            product[j, 0] += b00 * u0 + b10 * u1 + b20 * u2
            product[j, 1] += b01 * u0 + b11 * u1 + b21 * u2
            product[j, 2] += b02 * u0 + b12 * u1 + b22 * u2
        product[o, 0] = y0 + z0
        product[o, 1] = y1 + z1
        product[o, 2] = y2 + z2
        total += u0 * (y0 + 2.0 * z0) + u1 * (y1 + 2.0 * z1) + u2 * (y2 + 2.0 * z2)
    return total
