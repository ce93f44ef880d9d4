"""Coarse space of rigid motions: each group of nodes translates and rotates as one body.

Z_i = [I3, -[d_i]x] maps the six motions of a group (translation [m], rotation about its centre [rad]) to
node i, which lies d_i from the centre. Z^T A Z is block sparse like the graph of groups; its banded Cholesky
factor (reverse Cuthill-McKee order) is cheap enough to be made anew for every system.
"""

import numpy as np
import numpy.typing as npt
from numba import types
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from toile.engine.solve.linear_system import LinearSystem
from toile.engine.solve.preconditioner.aggregates import aggregate_nodes
from toile.engine.solve.preconditioner.band_cholesky import factorise, substitute
from toile.engine.solve.preconditioner.rigid_product import (
    multiply_motions,
    multiply_motions_outer,
    subtract_product,
)
from toile.engine.solve.preconditioner.rigid_transfer import prolong, restrict, take_restricted
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import (
    BOOL_1,
    F64_2,
    F64_3,
    I32_1,
    I32_2,
    OUT_F64_2,
    kernel,
    unsigned,
)

Int64 = npt.NDArray[np.int64]
REGULARISATION = 1e-8
"""Relative increase of the coarse diagonal: a group of one or two free nodes has motions that do nothing."""


class RigidCoarseSpace:
    """Z, A Z and the factor of Z^T A Z; `update` refreshes them for new numbers and positions."""

    def __init__(self, system: LinearSystem, group_size: int) -> None:
        pattern = system.pattern
        count = pattern.node_count
        self._group: Int = aggregate_nodes(pattern.indptr, pattern.indices, group_size)[pattern.order]
        self.group_count = int(self._group.max(initial=-1)) + 1
        self._members: Int = np.argsort(self._group, kind="stable").astype(np.int32)
        sizes = np.bincount(self._group, minlength=self.group_count)
        self._begins: Int = np.append(0, np.cumsum(sizes)).astype(np.int32)
        rows = np.repeat(pattern.rank, np.diff(pattern.indptr))
        columns = pattern.rank[pattern.indices]
        # Entries of bending outside the pattern, from one triangle: (row, column), then (column, row).
        ends = np.repeat(np.arange(count, dtype=np.int32), np.diff(system.outer_indptr)), system.outer_ranks
        outer_rows, outer_columns = np.concatenate(ends), np.concatenate(ends[::-1])
        outer_values = np.tile(system.outer_values, 2)
        # A Z by columns: what the motions of one group do to all nodes lies together.
        keys = self._group[np.concatenate([columns, outer_columns])].astype(np.int64) * count
        keys += np.concatenate([rows, outer_rows])
        unique, inverse = np.unique(keys, return_inverse=True)
        slots = inverse.astype(np.int32)
        # What a stored block adds to: by its row's node, and transposed by its column's.
        stored = pattern.entries >= 0
        self._row_slots: Int = np.empty(pattern.slot_count, np.int32)
        self._column_slots: Int = self._row_slots.copy()
        self._row_slots[pattern.entries[stored]] = slots[: len(rows)][stored]
        self._column_slots[~pattern.entries[~stored]] = slots[: len(rows)][~stored]
        # Entries outside the pattern by what they add to: every sum stays in registers.
        outer = slots[len(rows) :]
        sorted_by_slot = np.argsort(outer, kind="stable")
        self._outer_slots, begins = np.unique(outer[sorted_by_slot], return_index=True)
        self._outer_indptr: Int = np.append(begins, len(outer)).astype(np.int32)
        self._outer_indices: Int = outer_columns[sorted_by_slot]
        self._outer_values: Float = outer_values[sorted_by_slot]
        groups, nodes = unique // count, unique % count
        self._nodes: Int = nodes.astype(np.int32)
        self._indptr: Int = np.searchsorted(groups, np.arange(self.group_count + 1)).astype(np.int32)
        self._product: Float = np.zeros((len(unique), 3, 6))
        self._offsets: Float = np.zeros((count, 3))
        self._group_pairs: Int64 = np.unique(self._group[nodes].astype(np.int64) * self.group_count + groups)
        self._rank: Int = np.zeros(self.group_count, np.int32)
        self._ordered: Int64 | None = None
        self._half_bandwidth = 0
        self._factor: Float = np.zeros((0, 0))

    def update(self, system: LinearSystem, positions: Float) -> None:
        """Follow new numbers and node positions [m], by node, shape (node_count, 3)."""
        sizes = np.bincount(self._group, minlength=self.group_count)
        positions = positions[system.pattern.order]
        for axis in range(3):
            centre = np.bincount(self._group, positions[:, axis], self.group_count) / sizes
            self._offsets[:, axis] = positions[:, axis] - centre[self._group]
        self._pinned = system.pinned
        self._product[:] = 0.0
        pattern = system.pattern
        multiply_motions(
            pattern.lower_indptr,
            pattern.lower_ranks,
            self._row_slots,
            self._column_slots,
            system.blocks,
            system.pinned,
            self._offsets,
            self._product,
        )
        if len(self._outer_values):
            multiply_motions_outer(
                self._outer_slots,
                self._outer_indptr,
                self._outer_indices,
                self._outer_values,
                system.outer_scale,
                self._nodes,
                system.pinned,
                self._offsets,
                self._product,
            )
        self._contacts = system.contacts
        self._factorise(self._order_groups())

    def _order_groups(self) -> int:
        """Order the groups, contacts included; return the half bandwidth in groups."""
        nodes = self._contacts.nodes
        pairs = self._group_pairs
        if len(nodes):
            count = self.group_count
            used = np.where(nodes >= 0, self._group[nodes], self._group[nodes[:, :1]]).astype(np.int64)
            more = (used[:, :, None] * count + used[:, None, :]).ravel()
            pairs = np.unique(np.concatenate([pairs, more]))
        if self._ordered is None or len(pairs) != len(self._ordered) or (pairs != self._ordered).any():
            self._ordered = pairs
            self._half_bandwidth = self._order(pairs)
        return self._half_bandwidth

    def _order(self, pairs: Int64) -> int:
        """Rank the groups by reverse Cuthill-McKee; return the half bandwidth in groups."""
        count = self.group_count
        rows, columns = pairs // count, pairs % count
        graph = csr_array((np.ones(len(pairs)), (rows, columns)), shape=(count, count))
        order = reverse_cuthill_mckee(graph, symmetric_mode=True)
        self._rank[order] = np.arange(count, dtype=np.int32)
        return int(np.abs(self._rank[rows] - self._rank[columns]).max(initial=0))

    def _factorise(self, width: int) -> None:
        band = np.zeros((6 * self.group_count, 6 * width + 6))
        _assemble_coarse(
            self._indptr,
            self._nodes,
            self._group,
            self._rank,
            self._pinned,
            self._offsets,
            self._product,
            band,
        )
        if len(self._contacts.nodes):
            _assemble_coarse_contacts(*self._contacts, self._group, self._rank, self._offsets, band)
        diagonal = band[:, 0]
        band[:, 0] = np.where(diagonal > 0.0, diagonal * (1.0 + REGULARISATION), 1.0)
        failed = factorise(band)
        if failed >= 0:
            raise FloatingPointError(f"coarse matrix is not positive definite (motion {failed})")
        self._factor = band

    def solve(self, loads: Float) -> None:
        """Overwrite loads with the motions (Z^T A Z)^-1 loads, shape (6 group_count,)."""
        substitute(self._factor, loads)

    def restrict(self, forces: Float) -> Float:
        """Return Z^T forces; forces [N], shape (node_count, 3)."""
        loads = np.zeros(6 * self.group_count)
        restrict(self._members, self._begins, self._rank, self._pinned, self._offsets, forces, loads)
        return loads

    def take_restricted(self, nodes: Int, forces: Float) -> Float:
        """Return Z^T forces, which act on `nodes` alone, shape (k,), ascending; afterwards there are none."""
        loads = np.zeros(6 * self.group_count)
        take_restricted(nodes, self._group, self._rank, self._pinned, self._offsets, forces, loads)
        return loads

    def add_prolonged(self, motions: Float, residual: Float, out: Float) -> float:
        """Add Z motions to the displacements `out` [m], shape (node_count, 3); return residual . out."""
        product: float = prolong(self._group, self._rank, self._pinned, self._offsets, motions, residual, out)
        return product

    def subtract_restricted_product(self, displacements: Float, loads: Float) -> None:
        """Subtract Z^T A displacements, without the contacts outside the pattern, from `loads`."""
        subtract_product(self._indptr, self._nodes, self._rank, self._product, displacements, loads)


@kernel(types.void(I32_1, I32_1, I32_1, I32_1, BOOL_1, F64_2, F64_3, OUT_F64_2))
def _assemble_coarse(
    indptr: Int,
    nodes: Int,
    group: Int,
    rank: Int,
    pinned: Bool,
    offsets: Float,
    product: Float,
    band: Float,
) -> None:
    """Add Z^T (A Z) to the lower band: entry (row, column) is band[column, row - column]."""
    for g in range(rank.shape[0]):
        column = 6 * rank[g]
        for k in range(unsigned(indptr[g]), unsigned(indptr[g + 1])):
            i = unsigned(nodes[k])
            row = 6 * rank[group[i]]
            if pinned[i] or column > row:
                continue
            d0 = offsets[i, 0]
            d1 = offsets[i, 1]
            d2 = offsets[i, 2]
            for c in range(6):
                p0 = product[k, 0, c]
                p1 = product[k, 1, c]
                p2 = product[k, 2, c]
                base = row - column - c
                at = column + c
                if base >= 0:
                    band[at, base] += p0
                if base + 1 >= 0:
                    band[at, base + 1] += p1
                if base + 2 >= 0:
                    band[at, base + 2] += p2
                if base + 3 >= 0:
                    band[at, base + 3] += d1 * p2 - d2 * p1
                if base + 4 >= 0:
                    band[at, base + 4] += d2 * p0 - d0 * p2
                if base + 5 >= 0:
                    band[at, base + 5] += d0 * p1 - d1 * p0


@kernel(types.void(I32_2, F64_2, F64_3, I32_1, I32_1, F64_2, OUT_F64_2))
def _assemble_coarse_contacts(
    nodes: Int, weights: Float, stiffness: Float, group: Int, rank: Int, offsets: Float, band: Float
) -> None:
    """Add Z^T w w^T x K Z to the lower band, one contact at a time."""
    bodies = np.empty(4, np.int64)
    motion = np.empty((4, 3, 6), np.float64)
    force = np.empty((3, 6), np.float64)
    for contact in range(nodes.shape[0]):
        count = 0
        for a in range(4):
            i = nodes[contact, a]
            if i < 0:
                continue
            body = 6 * rank[group[i]]
            m = 0
            while m < count and bodies[m] != body:
                m += 1
            if m == count:
                bodies[m] = body
                count += 1
                for r in range(3):
                    for c in range(6):
                        motion[m, r, c] = 0.0
            weight = weights[contact, a]
            d0 = weight * offsets[i, 0]
            d1 = weight * offsets[i, 1]
            d2 = weight * offsets[i, 2]
            motion[m, 0, 0] += weight
            motion[m, 1, 1] += weight
            motion[m, 2, 2] += weight
            motion[m, 1, 3] -= d2
            motion[m, 2, 3] += d1
            motion[m, 0, 4] += d2
            motion[m, 2, 4] -= d0
            motion[m, 0, 5] -= d1
            motion[m, 1, 5] += d0
        for n in range(count):
            for r in range(3):
                for c in range(6):
                    force[r, c] = (
                        stiffness[contact, r, 0] * motion[n, 0, c]
                        + stiffness[contact, r, 1] * motion[n, 1, c]
                        + stiffness[contact, r, 2] * motion[n, 2, c]
                    )
            for m in range(count):
                for r in range(6):
                    for c in range(6):
                        below = bodies[m] + r - bodies[n] - c
                        if below >= 0:
                            band[bodies[n] + c, below] += (
                                motion[m, 0, r] * force[0, c]
                                + motion[m, 1, r] * force[1, c]
                                + motion[m, 2, r] * force[2, c]
                            )
