"""Assembly and the product A x against dense twins."""

import numpy as np
import pytest
from scipy.sparse import csr_array

from toile.engine.solve.assembly import node_pairs, scatter_gradients, scatter_hessians
from toile.engine.solve.block_pattern import BlockPattern
from toile.engine.solve.linear_system import ContactStencils, LinearSystem
from toile.geometry.arrays import Bool, Float, Int


def grid_triangles(rows: int, columns: int) -> Int:
    """Right-triangle grid of rows x columns nodes."""
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    lower = np.stack([a, b, d], axis=-1).reshape(-1, 3)
    upper = np.stack([a, d, c], axis=-1).reshape(-1, 3)
    return np.concatenate([lower, upper]).astype(np.int32)


def random_hessians(rng: np.random.Generator, count: int, corners: int) -> tuple[Float, Float]:
    """Positive semi-definite element matrices, dense (E, 3k, 3k) and as the blocks of `node_pairs`."""
    root = rng.normal(size=(count, 3 * corners, 4))
    dense = root @ root.transpose(0, 2, 1)
    blocks = [dense[:, 3 * a : 3 * a + 3, 3 * b : 3 * b + 3] for a, b in node_pairs(corners)]
    return dense, np.ascontiguousarray(np.stack(blocks, axis=1))


def scatter_dense(total: Float, nodes: Int, dense: Float) -> None:
    for stencil, element in zip(nodes, dense, strict=True):
        rows = (3 * stencil[:, None] + np.arange(3)).ravel()
        total[np.ix_(rows, rows)] += element


def dense_contacts(node_count: int, contacts: ContactStencils) -> Float:
    total = np.zeros((3 * node_count, 3 * node_count))
    for nodes, weights, stiffness in zip(*contacts, strict=True):
        row = np.zeros(node_count)
        np.add.at(row, nodes[nodes >= 0], weights[nodes >= 0])
        total += np.kron(np.outer(row, row), stiffness)
    return total


class Problem:
    """A small random system with every ingredient, and its dense twin."""

    def __init__(self, *, pins: bool = True, contact_count: int = 40, seed: int = 3) -> None:
        rng = np.random.default_rng(seed)
        triangles = grid_triangles(6, 7)
        self.count = 42
        springs = rng.permutation(self.count)[:12].reshape(6, 2).astype(np.int32)
        self.pattern = BlockPattern(self.count, [triangles, springs])
        self.dense = np.zeros((3 * self.count, 3 * self.count))
        blocks = self.pattern.zeros()
        for nodes, slots in zip([triangles, springs], self.pattern.slots, strict=True):
            element, hessians = random_hessians(rng, len(nodes), nodes.shape[1])
            scatter_hessians(slots, hessians, blocks)
            scatter_dense(self.dense, nodes, element)
        self.element_blocks = blocks
        self.element_dense = self.dense.copy()
        self.diagonal = rng.uniform(0.5, 2.0, self.count)
        second = np.zeros((self.count, self.count))
        for i in range(self.count - 15):
            stencil = np.array([i, i + 1, i + 7, i + 15])
            weights = rng.normal(size=4)
            second[np.ix_(stencil, stencil)] += np.outer(weights, weights)
        self.bending = csr_array(second)
        self.scale = 0.7
        self.contacts = random_contacts(rng, self.count, triangles, contact_count)
        self.pinned: Bool = np.zeros(self.count, np.bool_)
        if pins:
            self.pinned[[0, 6, 20]] = True
        self.dense += np.kron(np.diag(self.diagonal) + self.scale * second, np.eye(3))
        self.dense += dense_contacts(self.count, self.contacts)
        fixed = np.repeat(self.pinned, 3)
        self.dense[fixed] = 0.0
        self.dense[:, fixed] = 0.0
        self.dense[fixed, fixed] = 1.0
        self.system = LinearSystem(self.pattern, self.bending)
        self.refresh()

    def refresh(self) -> None:
        self.system.update(
            self.element_blocks,
            self.diagonal,
            bending_scale=self.scale,
            contacts=self.contacts,
            pinned=self.pinned,
        )


def random_contacts(rng: np.random.Generator, count: int, triangles: Int, number: int) -> ContactStencils:
    """Body contacts of one node, of a face's nodes, and contacts between distant nodes."""
    nodes = np.full((number, 4), -1, np.int32)
    for c in range(number):
        kind = c % 3
        if kind == 0:
            nodes[c, 0] = rng.integers(count)
        elif kind == 1:
            nodes[c, 1:] = triangles[rng.integers(len(triangles))]
        else:
            nodes[c] = rng.permutation(count)[:4]
    root = rng.normal(size=(number, 3, 2))
    return ContactStencils(nodes, rng.normal(size=(number, 4)), root @ root.transpose(0, 2, 1))


def test_assembly_equals_dense_twin() -> None:
    problem = Problem()
    dense = problem.pattern.to_dense(problem.element_blocks)
    np.testing.assert_allclose(dense, problem.element_dense, atol=1e-12)


def test_gradients_scatter_to_their_nodes() -> None:
    rng = np.random.default_rng(0)
    triangles = grid_triangles(4, 5)
    gradients = rng.normal(size=(len(triangles), 3, 3))
    total = np.zeros((20, 3))
    scatter_gradients(triangles, gradients, total)
    expected = np.zeros((20, 3))
    np.add.at(expected, triangles, gradients)
    np.testing.assert_allclose(total, expected, atol=1e-13)


def test_pattern_has_seven_blocks_inside_a_grid_and_sorted_rows() -> None:
    pattern = BlockPattern(42, [grid_triangles(6, 7)])
    row = pattern.indices[pattern.indptr[15] : pattern.indptr[16]]
    assert len(row) == 7
    assert (np.diff(row) > 0).all()
    assert pattern.slot_count == (len(pattern.indices) + 42) // 2
    for o in range(42):
        row = pattern.lower_ranks[pattern.lower_indptr[o] : pattern.lower_indptr[o + 1]]
        assert (np.diff(row) > 0).all()
        assert (row < o).all()


def test_pattern_rejects_foreign_nodes() -> None:
    with pytest.raises(ValueError, match=r"outside 0\.\.3"):
        BlockPattern(4, [np.array([[0, 1, 4]], np.int32)])


def test_pattern_rejects_a_node_that_a_stencil_holds_twice() -> None:
    with pytest.raises(ValueError, match="same node twice"):
        BlockPattern(4, [np.array([[0, 1, 1]], np.int32)])


def test_lent_blocks_outlive_an_update() -> None:
    """What a preconditioner reads stays while the matrix gets new numbers, any number of times."""
    problem = Problem()
    lent = problem.system.lend_blocks()
    before = lent.copy()
    for factor in (2.0, 3.0):
        problem.system.update(factor * problem.element_blocks, problem.diagonal)
        np.testing.assert_array_equal(lent, before)


@pytest.mark.parametrize("pins", [False, True])
def test_product_equals_dense_twin(pins: bool) -> None:
    problem = Problem(pins=pins)
    x = np.random.default_rng(1).normal(size=(problem.count, 3))
    x[problem.pinned] = 0.0
    order, rank = problem.pattern.order, problem.pattern.rank
    product = np.empty_like(x)
    energy = problem.system.apply(x[order], product)
    np.testing.assert_allclose(product[rank].ravel(), problem.dense @ x.ravel(), rtol=1e-11, atol=1e-11)
    assert energy == pytest.approx(float(x.ravel() @ problem.dense @ x.ravel()), rel=1e-12)


def test_sums_made_at_once_are_those_made_one_by_one() -> None:
    """To the last bit: the product is the same on machines that add fewer numbers at once."""
    problem = Problem(contact_count=0, pins=False)
    system = problem.system
    x = np.random.default_rng(1).normal(size=(problem.count, 3))
    product = np.empty_like(x)
    system.apply(x, product)
    pattern, scale = system.pattern, problem.scale
    outer = [[0.0, 0.0, 0.0] for _ in range(problem.count)]
    for i in range(problem.count):
        sums = [0.0, 0.0, 0.0]
        for k in range(system.outer_indptr[i], system.outer_indptr[i + 1]):
            j, value = system.outer_ranks[k], system.outer_values[k]
            for axis in range(3):
                sums[axis] += value * x[j, axis]
                outer[j][axis] += value * (scale * x[i, axis])
        outer[i] = [scale * total for total in sums]
    expected = outer
    for i in range(problem.count):
        own, below = system.blocks[i], [[0.0, 0.0, 0.0] for _ in range(3)]
        for k in range(pattern.lower_indptr[i], pattern.lower_indptr[i + 1]):
            block, j = pattern.lower(system.blocks)[k], pattern.lower_ranks[k]
            for r in range(3):
                for q in range(3):
                    below[r][q] += block[r, q] * x[j, q]
                    expected[j][r] += block[q, r] * x[i, q]
        for r in range(3):
            for q in range(3):
                expected[i][r] += own[q, r] * x[i, q]
            expected[i][r] += below[r][0] + below[r][1] + below[r][2]
    assert product.tolist() == expected


def test_diagonal_blocks_equal_dense_twin() -> None:
    problem = Problem()
    dense = problem.dense.reshape(problem.count, 3, problem.count, 3)
    own = np.arange(problem.count)
    diagonal = problem.system.diagonal_blocks()[problem.pattern.rank]
    np.testing.assert_allclose(diagonal, dense[own, :, own, :], atol=1e-11)


def test_update_forgets_the_previous_iteration() -> None:
    problem = Problem()
    before = problem.system.diagonal_blocks()
    problem.system.update(2.0 * problem.element_blocks, problem.diagonal)
    problem.refresh()
    np.testing.assert_array_equal(problem.system.diagonal_blocks(), before)


def test_a_scene_without_bending_contacts_or_pins_stores_nothing_for_them() -> None:
    problem = Problem()
    system = LinearSystem(problem.pattern)
    system.update(problem.element_blocks, problem.diagonal)
    assert len(system.outer_values) == 0
    assert len(system.contacts.nodes) == 0
    assert not system.pinned.any()


def test_contacts_of_one_element_are_merged_into_the_blocks() -> None:
    problem = Problem(contact_count=39)
    assert len(problem.system.contacts.nodes) <= 13
