"""Sparsity of a symmetric matrix of 3x3 blocks: its diagonal and one triangle."""

from collections.abc import Sequence

import numpy as np
from numba import types
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from toile.engine.solve.assembly import node_pairs
from toile.engine.solve.block_rows import block_rows, plus_columns
from toile.geometry.arrays import Float, Int
from toile.geometry.fours import (
    four_at,
    four_times,
    plus_product,
    plus_three,
    put_four,
    three_of,
)
from toile.geometry.kernel import F64_1, I32_1, OUT_F64_1, OUT_F64_2, helper, kernel, unsigned

ONE, TWO, THREE, FOUR = (unsigned(number) for number in range(1, 5))


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

    def multiply(self, blocks: Float, x: Float, sums: Float, product: Float) -> float:
        """Write sums + B x into `product`, shape (node_count, 3), by rank, and return its product with x.

        `sums` has shape (node_count, 4), of which the last column has no meaning; afterwards it is used up.
        """
        total: float = _multiply(
            self.lower_indptr,
            self.lower_ranks,
            self.diagonal(blocks).reshape(-1),
            self.lower(blocks).reshape(-1),
            x.reshape(-1),
            sums.reshape(-1),
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


@helper
def _sum_of_three(four):  # type: ignore[no-untyped-def]
    """Sum of the first three numbers."""
    x, y, z = three_of(four)
    return x + y + z


@kernel(types.float64(I32_1, I32_1, F64_1, F64_1, F64_1, OUT_F64_1, OUT_F64_2))
def _multiply(  # type: ignore[no-untyped-def]
    indptr, ranks, diagonal, lower, x, sums, product
):
    """Write the first three columns of sums (n, 4) + B x (n, 3) to `product`; return x . that.

    `diagonal` (n, 3, 3), `lower` (k, 3, 3), x and sums are laid out as rows of numbers. Of x fours are read
    only where a row follows: nothing beyond it is. Diagonal blocks are symmetric: their rows are taken for
    their columns.
    """
    total = 0.0
    for row in range(product.shape[0]):
        o = unsigned(row)
        at = THREE * o
        u0, u1, u2 = x[at], x[at + ONE], x[at + TWO]
        numbers = four_times(u0), four_times(u1), four_times(u2)
        a = four_times(0.0)
        b, c = a, a
        for k in range(unsigned(indptr[o]), unsigned(indptr[o + 1])):
            j = unsigned(ranks[k])
            rows, below = block_rows(lower, k), four_at(x, THREE * j)
            a, b = plus_product(a, rows[0], below), plus_product(b, rows[1], below)
            c = plus_product(c, rows[2], below)
            put_four(sums, FOUR * j, plus_columns(four_at(sums, FOUR * j), rows, numbers))
        # What the row below the diagonal gives: counted twice in the total, for the column above it.
        z0, z1, z2 = _sum_of_three(a), _sum_of_three(b), _sum_of_three(c)
        whole = plus_columns(four_at(sums, FOUR * o), block_rows(diagonal, o), numbers)
        whole = plus_three(whole, z0, z1, z2)
        put_four(sums, FOUR * o, whole)
        y0, y1, y2 = three_of(whole)
        total += u0 * (y0 + z0) + u1 * (y1 + z1) + u2 * (y2 + z2)
    for row in range(product.shape[0]):
        o = unsigned(row)
        product[o, 0] = sums[FOUR * o]
        product[o, 1] = sums[FOUR * o + ONE]
        product[o, 2] = sums[FOUR * o + TWO]
    return total
