"""Between nodes and the rigid motions of their groups: Z^T and Z of `rigid_coarse`.

Node i belongs to group[i], whose six motions or loads begin at 6 rank[group[i]]; it lies offsets[i] [m] from
the group's centre. Pinned nodes take no part.
"""

from numba import types

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import (
    BOOL_1,
    F64_1,
    F64_2,
    I32_1,
    OUT_F64_1,
    OUT_F64_2,
    kernel,
    packed_kernel,
    unsigned,
)


@packed_kernel(types.void(I32_1, I32_1, I32_1, BOOL_1, F64_2, F64_2, OUT_F64_1))
def restrict(
    members: Int, indptr: Int, rank: Int, pinned: Bool, offsets: Float, forces: Float, loads: Float
) -> None:
    """Write Z^T forces [N], shape (n, 3), into the loads, shape (6 g,).

    The nodes of group g are members[indptr[g]:indptr[g + 1]].
    """
    for g in range(rank.shape[0]):
        s0, s1, s2, s3, s4, s5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(unsigned(indptr[g]), unsigned(indptr[g + 1])):
            i = unsigned(members[k])
            if not pinned[i]:
                f0 = forces[i, 0]
                f1 = forces[i, 1]
                f2 = forces[i, 2]
                s0 += f0
                s1 += f1
                s2 += f2
                s3 += offsets[i, 1] * f2 - offsets[i, 2] * f1
                s4 += offsets[i, 2] * f0 - offsets[i, 0] * f2
                s5 += offsets[i, 0] * f1 - offsets[i, 1] * f0
        load = loads[6 * rank[g] :]
        load[0] = s0
        load[1] = s1
        load[2] = s2
        load[3] = s3
        load[4] = s4
        load[5] = s5


@kernel(types.void(I32_1, I32_1, I32_1, BOOL_1, F64_2, OUT_F64_2, OUT_F64_1))
def take_restricted(
    nodes: Int, group: Int, rank: Int, pinned: Bool, offsets: Float, forces: Float, loads: Float
) -> None:
    """Add Z^T forces on some nodes, shape (k,), to the loads, and set the forces to zero."""
    for n in range(nodes.shape[0]):
        i = unsigned(nodes[n])
        if not pinned[i]:
            load = loads[6 * rank[unsigned(group[i])] :]
            f0 = forces[i, 0]
            f1 = forces[i, 1]
            f2 = forces[i, 2]
            load[0] += f0
            load[1] += f1
            load[2] += f2
            load[3] += offsets[i, 1] * f2 - offsets[i, 2] * f1
            load[4] += offsets[i, 2] * f0 - offsets[i, 0] * f2
            load[5] += offsets[i, 0] * f1 - offsets[i, 1] * f0
        forces[i, 0] = 0.0
        forces[i, 1] = 0.0
        forces[i, 2] = 0.0


@kernel(types.float64(I32_1, I32_1, BOOL_1, F64_2, F64_1, F64_2, OUT_F64_2))
def prolong(
    group: Int, rank: Int, pinned: Bool, offsets: Float, motions: Float, residual: Float, out: Float
) -> float:
    """Add Z motions, shape (6 g,), to displacements `out` [m], shape (n, 3); return residual . out."""
    product = 0.0
    for i in range(pinned.shape[0]):
        if not pinned[i]:
            motion = motions[6 * rank[unsigned(group[i])] :]
            d0 = offsets[i, 0]
            d1 = offsets[i, 1]
            d2 = offsets[i, 2]
            out[i, 0] += motion[0] + motion[4] * d2 - motion[5] * d1
            out[i, 1] += motion[1] + motion[5] * d0 - motion[3] * d2
            out[i, 2] += motion[2] + motion[3] * d1 - motion[4] * d0
        product += residual[i, 0] * out[i, 0] + residual[i, 1] * out[i, 1] + residual[i, 2] * out[i, 2]
    return product
