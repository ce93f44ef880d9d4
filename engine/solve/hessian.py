"""The Hessian of a Newton iteration, to which forces add element blocks, stencils and a constant part."""

from collections.abc import Sequence

import numpy as np

from toile.engine.solve.assembly import scatter_hessians
from toile.engine.solve.block_pattern import BlockPattern
from toile.engine.solve.linear_system import ContactStencils
from toile.geometry.arrays import Float, Int


class Hessian:
    """Positive semi-definite second derivatives [N/m] of the forces on one topology.

    Attributes
    ----------
    pattern
        Where blocks lie.
    blocks
        Those of elements and of single nodes, shape (slot_count, 3, 3).
    stencils
        What forces added as weighted squares, one entry per force.
    squares
        Vectors g, shape (n, 3), of squares (g . x)^2/2 that forces added: they join all nodes that they name.
    constant_scale
        Factor on the constant matrix, which the linear system knows.
    """

    def __init__(self, node_count: int, elements: Sequence[Int]) -> None:
        """Build for elements (e, k) of forces; the arrays themselves are what `add_elements` is given."""
        self.pattern = BlockPattern(node_count, elements)
        self.blocks: Float = self.pattern.zeros()
        self.stencils: list[ContactStencils] = []
        self.squares: list[Float] = []
        self.constant_scale = 1.0
        self._elements = list(elements)

    def clear(self) -> None:
        """Begin a new iteration."""
        self.blocks[:] = 0.0
        self.stencils = []
        self.squares = []
        self.constant_scale = 1.0

    def add_elements(self, nodes: Int, blocks: Float) -> None:
        """Add blocks of elements, shape (e, k (k + 1) / 2, 3, 3), in the order of `node_pairs(k)`."""
        for known, slots in zip(self._elements, self.pattern.slots, strict=True):
            if known is nodes:
                scatter_hessians(slots, blocks, self.blocks)
                return
        raise ValueError(
            "the elements of this force are not in the matrix: `nodes` must be one array, for good"
        )

    def add_nodes(self, blocks: Float) -> None:
        """Add blocks of single nodes, shape (n, 3, 3)."""
        self.blocks[self.pattern.rank] += blocks

    def add_stencils(self, stencils: ContactStencils) -> None:
        """Add weighted squares of up to four nodes each, which need no block of their own."""
        self.stencils.append(stencils)

    def add_square(self, vector: Float) -> None:
        """Add g g^T of a vector g over all nodes [sqrt(N/m)], shape (n, 3)."""
        self.squares.append(vector)

    def scale_constant(self, factor: float) -> None:
        """Multiply the constant matrix in this iteration."""
        self.constant_scale = factor

    def to_dense(self, constant: Float | None = None) -> Float:
        """Return the whole matrix, shape (3 n, 3 n), with a constant scalar one, shape (n, n): for tests."""
        dense: Float = self.pattern.to_dense(self.blocks)
        if constant is not None:
            dense = dense + self.constant_scale * np.kron(constant, np.eye(3))
        for vector in self.squares:
            dense = dense + np.outer(vector, vector)
        for nodes, weights, stiffness in self.stencils:
            for row in range(len(nodes)):
                lever = np.zeros((3, len(dense)))
                for node, weight in zip(nodes[row], weights[row], strict=True):
                    if node >= 0:
                        lever[:, 3 * node : 3 * node + 3] += weight * np.eye(3)
                dense = dense + lever.T @ stiffness[row] @ lever
        return dense
