"""A Z of `rigid_coarse`: what the six rigid motions of a group do to every node, by columns.

Node i lies offsets[i] [m] from the centre of its group. The block of A Z between a node and a group has three
rows and six columns; `slots` say which block an entry of A adds to. Pinned nodes take no part.
"""

from numba import types

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import (
    BOOL_1,
    F64_1,
    F64_2,
    F64_3,
    I32_1,
    OUT_F64_1,
    OUT_F64_3,
    helper,
    kernel,
    packed_kernel,
    unsigned,
)


@helper
def _add_motions(
    product: Float, slot: int, row: int, b0: float, b1: float, b2: float, offsets: Float, node: int
) -> None:
    """Add the product of a block's row with the motions of a node."""
    d0 = offsets[node, 0]
    d1 = offsets[node, 1]
    d2 = offsets[node, 2]
    product[slot, row, 0] += b0
    product[slot, row, 1] += b1
    product[slot, row, 2] += b2
    product[slot, row, 3] += d1 * b2 - d2 * b1
    product[slot, row, 4] += d2 * b0 - d0 * b2
    product[slot, row, 5] += d0 * b1 - d1 * b0


@packed_kernel(types.void(I32_1, I32_1, I32_1, I32_1, F64_3, BOOL_1, F64_2, OUT_F64_3))
def multiply_motions(
    indptr: Int,
    ranks: Int,
    row_slots: Int,
    column_slots: Int,
    blocks: Float,
    pinned: Bool,
    offsets: Float,
    product: Float,
) -> None:
    """Add what the stored blocks of `BlockPattern` give, each for its row and transposed for its column."""
    count = unsigned(pinned.shape[0])
    for o in range(count):
        i = unsigned(o)
        if pinned[i]:
            continue
        s = unsigned(row_slots[o])
        for r in range(3):
            _add_motions(product, s, r, blocks[o, r, 0], blocks[o, r, 1], blocks[o, r, 2], offsets, i)
        for k in range(count + unsigned(indptr[o]), count + unsigned(indptr[o + 1])):
            j = unsigned(ranks[k - count])
            if pinned[j]:
                continue
            s = unsigned(row_slots[k])
            t = unsigned(column_slots[k])
            for r in range(3):
                _add_motions(product, s, r, blocks[k, r, 0], blocks[k, r, 1], blocks[k, r, 2], offsets, j)
                _add_motions(product, t, r, blocks[k, 0, r], blocks[k, 1, r], blocks[k, 2, r], offsets, i)


@kernel(types.void(I32_1, I32_1, I32_1, F64_1, types.float64, I32_1, BOOL_1, F64_2, OUT_F64_3))
def multiply_motions_outer(
    slots: Int,
    indptr: Int,
    indices: Int,
    values: Float,
    scale: float,
    nodes: Int,
    pinned: Bool,
    offsets: Float,
    product: Float,
) -> None:
    """Add what scalar entries of A give, sorted by the block t of A Z that they add to."""
    for t in range(slots.shape[0]):
        block = product[unsigned(slots[t])]
        if pinned[nodes[unsigned(slots[t])]]:
            continue
        move0, move1, move2 = block[0, 0], block[1, 1], block[2, 2]
        turn10, turn20 = block[1, 3], block[2, 3]
        turn01, turn21 = block[0, 4], block[2, 4]
        turn02, turn12 = block[0, 5], block[1, 5]
        for k in range(unsigned(indptr[t]), unsigned(indptr[t + 1])):
            j = unsigned(indices[k])
            if pinned[j]:
                continue
            value = scale * values[k]
            d0 = value * offsets[j, 0]
            d1 = value * offsets[j, 1]
            d2 = value * offsets[j, 2]
            move0 += value
            move1 += value
            move2 += value
            turn10 -= d2
            turn20 += d1
            turn01 += d2
            turn21 -= d0
            turn02 -= d1
            turn12 += d0
        block[0, 0], block[1, 1], block[2, 2] = move0, move1, move2
        block[1, 3], block[2, 3] = turn10, turn20
        block[0, 4], block[2, 4] = turn01, turn21
        block[0, 5], block[1, 5] = turn02, turn12


@packed_kernel(types.void(I32_1, I32_1, I32_1, F64_3, F64_2, OUT_F64_1))
def subtract_product(
    indptr: Int, nodes: Int, rank: Int, product: Float, displacements: Float, loads: Float
) -> None:
    """Subtract (A Z)^T displacements, shape (n, 3), from the loads, shape (6 g,)."""
    for g in range(rank.shape[0]):
        load = loads[6 * rank[g] :]
        s0 = load[0]
        s1 = load[1]
        s2 = load[2]
        s3 = load[3]
        s4 = load[4]
        s5 = load[5]
        for k in range(unsigned(indptr[g]), unsigned(indptr[g + 1])):
            i = unsigned(nodes[k])
            x0 = displacements[i, 0]
            x1 = displacements[i, 1]
            x2 = displacements[i, 2]
            s0 -= product[k, 0, 0] * x0 + product[k, 1, 0] * x1 + product[k, 2, 0] * x2
            s1 -= product[k, 0, 1] * x0 + product[k, 1, 1] * x1 + product[k, 2, 1] * x2
            s2 -= product[k, 0, 2] * x0 + product[k, 1, 2] * x1 + product[k, 2, 2] * x2
            s3 -= product[k, 0, 3] * x0 + product[k, 1, 3] * x1 + product[k, 2, 3] * x2
            s4 -= product[k, 0, 4] * x0 + product[k, 1, 4] * x1 + product[k, 2, 4] * x2
            s5 -= product[k, 0, 5] * x0 + product[k, 1, 5] * x1 + product[k, 2, 5] * x2
        load[0] = s0
        load[1] = s1
        load[2] = s2
        load[3] = s3
        load[4] = s4
        load[5] = s5
