"""The symmetric positive definite system of one Newton iteration, and its product with a vector.

    A = diag(node_diagonal) x I3  +  B  +  s (S x I3)  +  sum_c (w_c w_c^T) x K_c  +  sum_q g_q g_q^T

B: element blocks; S: the constant scalar bending matrix; the sums: contacts, and squares that join all nodes
(enclosed gas). Everything that fits the
element pattern (the diagonal, the in-pattern part of S, contacts that touch one node or nodes of one
element) is merged into one block matrix, which is also what preconditioners look at; only
the outer ring of S and contacts between distant nodes stay apart. Pinned nodes keep dx = 0: their
rows and columns become those of the identity (Baraff & Witkin 1998, section 5.3, as a projection).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import types
from scipy.sparse import csr_array

from toile.engine.solve.block_pattern import BlockPattern
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import (
    BOOL_1,
    F64_1,
    F64_2,
    F64_3,
    I32_1,
    I32_2,
    OUT_F64_2,
    OUT_F64_3,
    OUT_I32_1,
    kernel,
    packed_kernel,
    unsigned,
)


class ContactStencils(NamedTuple):
    """Contacts as K-weighted squares of the weighted sum of up to four node displacements.

    nodes: shape (C, 4), int32, -1 where unused. weights: shape (C, 4). stiffness: symmetric positive
    semi-definite [N/m], shape (C, 3, 3).
    """

    nodes: Int
    weights: Float
    stiffness: Float


NO_CONTACTS = ContactStencils(np.zeros((0, 4), np.int32), np.zeros((0, 4)), np.zeros((0, 3, 3)))


def joined(stencils: list[ContactStencils]) -> ContactStencils:
    """Return one list of contacts from several."""
    if len(stencils) == 1:
        return stencils[0]
    return ContactStencils(
        *(np.ascontiguousarray(np.concatenate(parts)) for parts in zip(*stencils, strict=True))
    )


class LinearSystem:
    """A x, for one topology; `update` sets the numbers of one Newton iteration.

    It is told of nodes and keeps all by rank, as vectors are that it works on: see `BlockPattern`.

    Attributes
    ----------
    blocks : merged block matrix on `pattern` [N/m], shape (slot_count, 3, 3); identity rows at pins.
        Another array after an `update` that follows `lend_blocks`.
    outer_indptr, outer_ranks, outer_values : entries of S outside the pattern, below its diagonal: CSR by
        rank.
    outer_scale : the factor of those entries.
    contacts : contacts that do not fit the pattern, their nodes by rank; weights vanish at pins.
    pinned : by rank, shape (node_count,).
    squares : vectors g, by rank, shape (node_count, 3); they vanish at pins.
    """

    def __init__(self, pattern: BlockPattern, bending: csr_array | None = None) -> None:
        self.pattern = pattern
        self.blocks: Float = pattern.zeros()
        self._spare: Float = pattern.zeros()
        self._lent = False
        self.pinned: Bool = np.zeros(pattern.node_count, dtype=np.bool_)
        self.contacts = NO_CONTACTS
        self.squares: list[Float] = []
        self.outer_scale = 0.0
        self._inner_slots: Int = np.zeros(0, np.int32)
        self._inner_values: Float = np.zeros(0)
        self.outer_indptr: Int = np.zeros(pattern.node_count + 1, np.int32)
        self.outer_ranks: Int = np.zeros(0, np.int32)
        self.outer_values: Float = np.zeros(0)
        # Four columns: four sums are made at once.
        self._sums: Float = np.zeros((pattern.node_count, 4))
        if bending is not None:
            self._split(bending)

    def _split(self, bending: csr_array) -> None:
        """Separate the entries of S that have a block in the pattern from those that have none."""
        count = self.pattern.node_count
        if bending.shape != (count, count):
            raise ValueError(f"bending must have shape ({count}, {count}), got {bending.shape}")
        bending = bending.sorted_indices()
        rows = np.repeat(np.arange(count), np.diff(bending.indptr))
        pattern_rows = np.repeat(np.arange(count), np.diff(self.pattern.indptr))
        pattern_keys = pattern_rows * count + self.pattern.indices
        keys = rows * count + bending.indices
        at = np.minimum(np.searchsorted(pattern_keys, keys), len(pattern_keys) - 1)
        inner = pattern_keys[at] == keys
        slots = self.pattern.entries[at[inner]]
        stored = slots >= 0
        self._inner_slots = np.ascontiguousarray(slots[stored])
        self._inner_values = np.ascontiguousarray(bending.data[inner][stored], dtype=np.float64)
        row_ranks, column_ranks = self.pattern.rank[rows], self.pattern.rank[bending.indices]
        below = np.flatnonzero(~inner & (column_ranks < row_ranks))
        below = below[np.lexsort((column_ranks[below], row_ranks[below]))]
        self.outer_ranks = column_ranks[below]
        self.outer_values = np.ascontiguousarray(bending.data[below], dtype=np.float64)
        self.outer_indptr = np.searchsorted(row_ranks[below], np.arange(count + 1)).astype(np.int32)

    def update(
        self,
        element_blocks: Float,
        node_diagonal: Float,
        *,
        bending_scale: float = 1.0,
        contacts: ContactStencils = NO_CONTACTS,
        pinned: Bool | None = None,
        squares: Sequence[Float] = (),
    ) -> None:
        """Set the numbers of this Newton iteration.

        Parameters
        ----------
        element_blocks : assembled element Hessians B [N/m], shape (slot_count, 3, 3); not changed.
        node_diagonal : mass / h^2 and other isotropic node terms [N/m], shape (node_count,).
        bending_scale : the factor s of the bending matrix.
        contacts : this iteration's contacts.
        pinned : nodes that keep dx = 0, shape (node_count,); None: no node.
        squares : vectors g over all nodes, shape (node_count, 3), whose g g^T count.
        """
        if self._lent:
            self.blocks, self._spare, self._lent = self._spare, self.blocks, False
        np.copyto(self.blocks, element_blocks)
        _add_isotropic(self.pattern.rank, node_diagonal, 1.0, self.blocks)
        self.outer_scale = bending_scale
        if len(self._inner_slots):
            _add_isotropic(self._inner_slots, self._inner_values, bending_scale, self.blocks)
        self.contacts = NO_CONTACTS
        if len(contacts.nodes):
            self._absorb(contacts)
        if pinned is not None and pinned.any():
            self._pin(pinned)
        elif self.pinned.any():
            self.pinned = np.zeros_like(self.pinned)
        self.squares = [np.where(self.pinned[:, None], 0.0, g[self.pattern.order]) for g in squares]

    def _absorb(self, contacts: ContactStencils) -> None:
        """Add contacts that fit the pattern to the blocks; keep the others apart."""
        left = np.empty(len(contacts.nodes), np.int32)
        pattern = self.pattern
        count = _absorb_contacts(
            pattern.rank, pattern.lower_indptr, pattern.lower_ranks, *contacts, self.blocks, left
        )
        if count:
            kept = left[:count]
            nodes = contacts.nodes[kept]
            self.contacts = ContactStencils(
                np.where(nodes >= 0, pattern.rank[nodes], np.int32(-1)),
                contacts.weights[kept],
                contacts.stiffness[kept],
            )

    def _pin(self, pinned: Bool) -> None:
        pattern = self.pattern
        self.pinned = np.asarray(pinned, dtype=np.bool_)[pattern.order]
        _make_identity(
            pattern.lower_indptr,
            pattern.lower_ranks,
            self.pinned,
            pattern.diagonal(self.blocks),
            pattern.lower(self.blocks),
        )
        if len(self.contacts.nodes):
            nodes, weights, stiffness = self.contacts
            self.contacts = ContactStencils(nodes, np.where(self.pinned[nodes], 0.0, weights), stiffness)

    def apply(self, x: Float, product: Float) -> float:
        """Write A x into `product` and return x . A x; shapes (node_count, 3). x must vanish at pins."""
        if len(self.outer_values):
            _multiply_outer(
                self.outer_indptr,
                self.outer_ranks,
                self.outer_values,
                self.outer_scale,
                self.pinned,
                x.reshape(-1),
                self._sums,
            )
        else:
            self._sums[:] = 0.0
        energy = self.pattern.multiply(self.blocks, x, self._sums, product)
        if self.has_distant_contacts:
            energy += self.add_distant_contacts(x, product)
        for g in self.squares:
            along = float(np.vdot(g, x))
            product += along * g
            energy += along * along
        return energy

    @property
    def has_distant_contacts(self) -> bool:
        """Whether some contacts do not fit the pattern."""
        return len(self.contacts.nodes) > 0

    def add_distant_contacts(self, x: Float, product: Float) -> float:
        """Add the part of A x from contacts outside the pattern to `product`; return its x . A x."""
        energy: float = _multiply_contacts(*self.contacts, x, product)
        return energy

    def lend_blocks(self) -> Float:
        """Return `blocks` for others to read until the next call: an update writes elsewhere meanwhile."""
        self._lent = True
        return self.blocks

    def diagonal_blocks(self) -> Float:
        """Return the diagonal blocks of A by rank [N/m], shape (node_count, 3, 3)."""
        diagonal: Float = self.pattern.diagonal(self.blocks).copy()
        if len(self.contacts.nodes):
            _add_contact_diagonal(*self.contacts, diagonal)
        return diagonal


@kernel(types.void(I32_1, F64_1, types.float64, OUT_F64_3))
def _add_isotropic(slots: Int, values: Float, scale: float, blocks: Float) -> None:
    for k in range(slots.shape[0]):
        s = slots[k]
        value = scale * values[k]
        blocks[s, 0, 0] += value
        blocks[s, 1, 1] += value
        blocks[s, 2, 2] += value


@kernel(types.int64(I32_1, I32_1, I32_1, I32_2, F64_2, F64_3, OUT_F64_3, OUT_I32_1))
def _absorb_contacts(
    rank: Int,
    indptr: Int,
    ranks: Int,
    nodes: Int,
    weights: Float,
    stiffness: Float,
    blocks: Float,
    left: Int,
) -> int:
    """Add every contact whose node pairs all have a block; list the others in `left`, return their number."""
    left_count = 0
    slots = np.empty(16, np.int32)
    for c in range(nodes.shape[0]):
        fits = True
        for a in range(4):
            for b in range(a + 1):
                slot = -1
                if nodes[c, a] >= 0 and nodes[c, b] >= 0:
                    row = max(rank[nodes[c, a]], rank[nodes[c, b]])
                    column = min(rank[nodes[c, a]], rank[nodes[c, b]])
                    if row == column:
                        slot = row
                    else:
                        for k in range(indptr[row], indptr[row + 1]):
                            if ranks[k] == column:
                                slot = rank.shape[0] + k
                                break
                        if slot < 0:
                            fits = False
                slots[4 * a + b] = slot
            if not fits:
                break
        if not fits:
            left[left_count] = c
            left_count += 1
            continue
        for a in range(4):
            for b in range(a + 1):
                s = slots[4 * a + b]
                if s >= 0:
                    weight = weights[c, a] * weights[c, b]
                    if a != b and nodes[c, a] == nodes[c, b]:
                        weight *= 2.0
                    for r in range(3):
                        for q in range(3):
                            blocks[s, r, q] += weight * stiffness[c, r, q]
    return left_count


@kernel(types.void(I32_1, I32_1, BOOL_1, OUT_F64_3, OUT_F64_3))
def _make_identity(indptr: Int, ranks: Int, pinned: Bool, diagonal: Float, lower: Float) -> None:
    for o in range(pinned.shape[0]):
        if pinned[o]:
            for r in range(3):
                for q in range(3):
                    diagonal[o, r, q] = 1.0 if r == q else 0.0
        for k in range(indptr[o], indptr[o + 1]):
            if pinned[o] or pinned[ranks[k]]:
                for r in range(3):
                    for q in range(3):
                        lower[k, r, q] = 0.0


@packed_kernel(types.void(I32_1, I32_1, F64_1, types.float64, BOOL_1, F64_1, OUT_F64_2))
def _multiply_outer(
    indptr: Int,
    ranks: Int,
    values: Float,
    scale: float,
    pinned: Bool,
    row: Float,
    product: Float,
) -> None:
    """Write the outer part of A x, with a fourth column of no meaning: four sums are made at once.

    `row` are the rows of x one after the other, shape (3 n,). No column is that of the last node.
    """
    for o in range(pinned.shape[0]):
        i = unsigned(o)
        at = unsigned(3) * i
        u0 = scale * row[at]
        u1 = scale * row[at + unsigned(1)]
        u2 = scale * row[at + unsigned(2)]
        u3 = u2
        y0 = 0.0
        y1 = 0.0
        y2 = 0.0
        y3 = 0.0
        for k in range(unsigned(indptr[o]), unsigned(indptr[o + 1])):
            j = unsigned(ranks[k])
            at = unsigned(3) * j
            value = values[k]
            y0 += value * row[at]
            y1 += value * row[at + unsigned(1)]
            y2 += value * row[at + unsigned(2)]
            y3 += value * row[at + unsigned(3)]
            product[j, 0] += value * u0
            product[j, 1] += value * u1
            product[j, 2] += value * u2
            product[j, 3] += value * u3
        product[i, 0] = scale * y0
        product[i, 1] = scale * y1
        product[i, 2] = scale * y2
        product[i, 3] = scale * y3
    for pin in range(pinned.shape[0]):
        if pinned[pin]:
            product[pin, 0] = 0.0
            product[pin, 1] = 0.0
            product[pin, 2] = 0.0


@kernel(types.float64(I32_2, F64_2, F64_3, F64_2, OUT_F64_2))
def _multiply_contacts(nodes: Int, weights: Float, stiffness: Float, x: Float, product: Float) -> float:
    """Add the contacts' part of A x to `product`; return their part of x . A x."""
    energy = 0.0
    for c in range(nodes.shape[0]):
        d0 = 0.0
        d1 = 0.0
        d2 = 0.0
        for a in range(4):
            i = nodes[c, a]
            if i >= 0:
                weight = weights[c, a]
                d0 += weight * x[i, 0]
                d1 += weight * x[i, 1]
                d2 += weight * x[i, 2]
        f0 = stiffness[c, 0, 0] * d0 + stiffness[c, 0, 1] * d1 + stiffness[c, 0, 2] * d2
        f1 = stiffness[c, 1, 0] * d0 + stiffness[c, 1, 1] * d1 + stiffness[c, 1, 2] * d2
        f2 = stiffness[c, 2, 0] * d0 + stiffness[c, 2, 1] * d1 + stiffness[c, 2, 2] * d2
        energy += d0 * f0 + d1 * f1 + d2 * f2
        for a in range(4):
            i = nodes[c, a]
            if i >= 0:
                weight = weights[c, a]
                product[i, 0] += weight * f0
                product[i, 1] += weight * f1
                product[i, 2] += weight * f2
    return energy


@kernel(types.void(I32_2, F64_2, F64_3, OUT_F64_3))
def _add_contact_diagonal(nodes: Int, weights: Float, stiffness: Float, diagonal: Float) -> None:
    for c in range(nodes.shape[0]):
        for a in range(4):
            i = nodes[c, a]
            if i >= 0:
                weight = weights[c, a] * weights[c, a]
                for r in range(3):
                    for q in range(3):
                        diagonal[i, r, q] += weight * stiffness[c, r, q]
