"""Conjugate gradients and every preconditioner on a small stiff cloth, against a direct solver."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay

from toile.engine.solve.assembly import scatter_hessians
from toile.engine.solve.block_pattern import BlockPattern
from toile.engine.solve.cg import solve
from toile.engine.solve.linear_system import ContactStencils, LinearSystem
from toile.engine.solve.preconditioner.aggregates import aggregate_nodes
from toile.engine.solve.preconditioner.band_cholesky import factorise, substitute
from toile.engine.solve.preconditioner.base import Preconditioner
from toile.engine.solve.preconditioner.block_jacobi import BlockJacobi
from toile.engine.solve.preconditioner.choice import make_preconditioner
from toile.engine.solve.preconditioner.gauss_seidel import SymmetricGaussSeidel
from toile.engine.solve.preconditioner.two_level import TwoLevel
from toile.geometry.arrays import Bool, Float

PRECONDITIONERS: dict[str, Callable[[LinearSystem], Preconditioner]] = {
    "block_jacobi": lambda system: BlockJacobi(),
    "gauss_seidel": lambda system: SymmetricGaussSeidel(system.pattern),
    "two_level": lambda system: TwoLevel(system, group_size=20),
}


class StiffCloth:
    """A wavy random mesh whose edges are springs: 3000 N/m along, 3 N/m across; body contact on one half."""

    def __init__(self, count: int = 500, *, step: float = 0.02, seed: int = 5) -> None:
        rng = np.random.default_rng(seed)
        side = 0.01 * np.sqrt(count)
        plane = rng.uniform(0.0, side, (count, 2))
        triangles = Delaunay(plane).simplices.astype(np.int32)
        height = 0.02 * np.sin(40.0 * plane[:, 0]) * np.cos(25.0 * plane[:, 1])
        self.positions: Float = np.column_stack([plane, height])
        pairs = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        edges = np.unique(np.sort(pairs, axis=1), axis=0).astype(np.int32)
        self.pattern = BlockPattern(count, [triangles, edges])
        along = self.positions[edges[:, 1]] - self.positions[edges[:, 0]]
        along /= np.linalg.norm(along, axis=1)[:, None]
        stiffness = 3000.0 * along[:, :, None] * along[:, None, :] + 3.0 * np.eye(3)
        self.element_blocks = self.pattern.zeros()
        hessians = np.ascontiguousarray(np.stack([stiffness, stiffness, -stiffness], axis=1))
        scatter_hessians(self.pattern.slots[1], hessians, self.element_blocks)
        self.node_diagonal: Float = np.full(count, 1.5e-5 / step**2)
        self.pinned: Bool = plane[:, 1] > 0.97 * side
        ends = np.ones(len(edges))
        graph = coo_array((ends, (edges[:, 0], edges[:, 1])), shape=(count, count)).tocsr()
        graph = graph + graph.T
        laplacian = csr_array(np.diag(graph.sum(axis=1))) - graph
        self.bending = csr_array(laplacian @ laplacian)
        self.system = LinearSystem(self.pattern, self.bending)
        touching = np.flatnonzero(plane[:, 0] < 0.5 * side)
        nodes = np.full((len(touching) + 20, 4), -1, np.int32)
        nodes[: len(touching), 0] = touching
        nodes[len(touching) :] = rng.integers(0, count, (20, 4))
        normals = rng.normal(size=(len(nodes), 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        weights = np.tile([1.0, -0.3, -0.3, -0.4], (len(nodes), 1))
        self.contacts = ContactStencils(nodes, weights, 50.0 * normals[:, :, None] * normals[:, None, :])
        self.system.update(
            self.element_blocks,
            self.node_diagonal,
            bending_scale=0.05,
            contacts=self.contacts,
            pinned=self.pinned,
        )
        self.right_hand_side: Float = rng.normal(size=(count, 3))

    def matrix(self) -> Float:
        """Dense twin of A, restricted to free nodes with the identity at pins."""
        total = self.pattern.to_dense(self.element_blocks)
        total += np.kron(0.05 * self.bending.toarray() + np.diag(self.node_diagonal), np.eye(3))
        for nodes, weights, stiffness in zip(*self.contacts, strict=True):
            used = nodes >= 0
            scaled = np.concatenate([w * np.eye(3) for w in weights[used]])
            rows = (3 * nodes[used][:, None] + np.arange(3)).ravel()
            np.add.at(total, (rows[:, None], rows), scaled @ stiffness @ scaled.T)
        fixed = np.repeat(self.pinned, 3)
        total[fixed] = 0.0
        total[:, fixed] = 0.0
        total[fixed, fixed] = 1.0
        return total

    def exact(self) -> Float:
        free = np.where(self.pinned[:, None], 0.0, self.right_hand_side)
        return np.asarray(np.linalg.solve(self.matrix(), free.ravel()), dtype=np.float64).reshape(-1, 3)


@pytest.fixture(scope="module")
def cloth() -> StiffCloth:
    return StiffCloth()


@pytest.fixture(params=list(PRECONDITIONERS))
def preconditioner(request: pytest.FixtureRequest, cloth: StiffCloth) -> Preconditioner:
    made = PRECONDITIONERS[request.param](cloth.system)
    made.update(cloth.system, cloth.positions)
    return made


def by_rank(cloth: StiffCloth, matrix: Float) -> Float:
    """A matrix whose rows and columns are nodes, in the order of the pattern."""
    rows = (3 * cloth.pattern.order[:, None] + np.arange(3)).ravel()
    return np.asarray(matrix[np.ix_(rows, rows)])


def as_matrix(preconditioner: Preconditioner, residuals: Float) -> Float:
    """Apply the preconditioner to each column."""
    columns = np.zeros_like(residuals)
    out = np.empty((len(residuals) // 3, 3))
    for k in range(residuals.shape[1]):
        preconditioner.apply(np.ascontiguousarray(residuals[:, k]).reshape(-1, 3), out)
        columns[:, k] = out.ravel()
    return columns


def corrected_residuals(preconditioner: Preconditioner, matrix: Float) -> Float:
    """Columns: every unit residual, less what the preconditioner solves exactly."""
    residuals = np.eye(len(matrix))
    correction = np.zeros((len(matrix) // 3, 3))
    for k in range(len(matrix)):
        if preconditioner.correct(residuals[:, k].reshape(-1, 3).copy(), correction):
            residuals[:, k] -= matrix @ correction.ravel()
    return residuals


def test_solution_equals_direct_solver(cloth: StiffCloth, preconditioner: Preconditioner) -> None:
    result = solve(cloth.system, cloth.right_hand_side, preconditioner, tolerance=1e-10, max_iterations=5000)
    assert result.converged
    assert result.residual <= 1e-10
    exact = cloth.exact()
    np.testing.assert_allclose(result.solution, exact, atol=1e-7 * np.abs(exact).max())


def test_pins_stay(cloth: StiffCloth, preconditioner: Preconditioner) -> None:
    start = np.ones_like(cloth.right_hand_side)
    result = solve(cloth.system, cloth.right_hand_side, preconditioner, start=start)
    assert cloth.pinned.any()
    assert (result.solution[cloth.pinned] == 0.0).all()


def test_same_input_same_bytes(cloth: StiffCloth, preconditioner: Preconditioner) -> None:
    first = solve(cloth.system, cloth.right_hand_side, preconditioner)
    preconditioner.update(cloth.system, cloth.positions)
    second = solve(cloth.system, cloth.right_hand_side, preconditioner)
    assert first.solution.tobytes() == second.solution.tobytes()
    assert first.iterations == second.iterations


def test_start_at_the_solution_needs_no_iteration(cloth: StiffCloth, preconditioner: Preconditioner) -> None:
    result = solve(cloth.system, cloth.right_hand_side, preconditioner, tolerance=1e-4, start=cloth.exact())
    assert result.iterations == 0
    assert result.converged


def test_a_known_reference_gives_the_same_solution(cloth: StiffCloth, preconditioner: Preconditioner) -> None:
    first = solve(cloth.system, cloth.right_hand_side, preconditioner, tolerance=1e-3)
    for reference in (first.reference, 0.0):
        again = solve(
            cloth.system, cloth.right_hand_side, preconditioner, tolerance=1e-8, start=first.solution,
            reference=reference,
        )  # fmt: skip
        exact = cloth.exact()
        np.testing.assert_allclose(again.solution, exact, atol=1e-5 * np.abs(exact).max())
        assert again.reference == pytest.approx(first.reference, rel=1e-6)


def test_no_load_moves_nothing(cloth: StiffCloth, preconditioner: Preconditioner) -> None:
    none = np.zeros_like(cloth.right_hand_side)
    result = solve(cloth.system, none, preconditioner, start=np.ones_like(none), reference=0.0)
    assert result.converged and not result.solution.any()


def test_too_few_iterations_are_reported(cloth: StiffCloth, preconditioner: Preconditioner) -> None:
    result = solve(cloth.system, cloth.right_hand_side, preconditioner, tolerance=1e-12, max_iterations=2)
    assert result.iterations == 2
    assert not result.converged
    assert result.residual > 1e-12


def test_zero_right_hand_side_gives_zero(cloth: StiffCloth, preconditioner: Preconditioner) -> None:
    result = solve(cloth.system, np.zeros_like(cloth.right_hand_side), preconditioner)
    assert result.converged
    assert not result.solution.any()


def test_indefinite_matrix_is_an_error(cloth: StiffCloth) -> None:
    system = LinearSystem(cloth.pattern)
    blocks = cloth.pattern.zeros()
    blocks[cloth.pattern.rank] = np.eye(3)
    blocks[cloth.pattern.rank[7]] = -np.eye(3)
    system.update(blocks, np.zeros(cloth.pattern.node_count))
    good = BlockJacobi()
    good.update(cloth.system, cloth.positions)
    with pytest.raises(FloatingPointError, match="not positive definite"):
        solve(system, cloth.right_hand_side, good, tolerance=1e-9)


def test_preconditioner_is_symmetric_positive_definite() -> None:
    cloth = StiffCloth(120)
    for make in PRECONDITIONERS.values():
        made = make(cloth.system)
        made.update(cloth.system, cloth.positions)
        residuals = corrected_residuals(made, by_rank(cloth, cloth.matrix()))
        form = residuals.T @ as_matrix(made, residuals)
        scale = np.abs(form).max()
        np.testing.assert_allclose(form, form.T, atol=1e-6 * scale)
        values = np.linalg.eigvalsh(0.5 * (form + form.T))
        rank = np.linalg.matrix_rank(residuals, tol=1e-5)
        assert values.min() > -1e-9 * scale
        assert (values > 1e-9 * scale).sum() >= rank - 1


def test_a_sweep_knows_all_contacts() -> None:
    """(D + L) D^-1 (D + L^T) of all but the outer part of bending: contacts of distant nodes are in L."""
    cloth = StiffCloth(120)
    system = LinearSystem(cloth.pattern)
    system.update(cloth.element_blocks, cloth.node_diagonal, contacts=cloth.contacts, pinned=cloth.pinned)
    assert system.has_distant_contacts
    smoother = SymmetricGaussSeidel(system.pattern)
    smoother.update(system, cloth.positions)
    dense = cloth.matrix()
    free = np.repeat(~cloth.pinned, 3)
    dense -= np.where(free[:, None] & free, np.kron(0.05 * cloth.bending.toarray(), np.eye(3)), 0.0)
    swept = by_rank(cloth, dense).reshape(120, 3, 120, 3)
    node = np.arange(120)
    diagonal = np.where((node[:, None] == node)[:, None, :, None], swept, 0.0).reshape(360, 360)
    lower = np.where((node[:, None] > node)[:, None, :, None], swept, 0.0).reshape(360, 360)
    both = (diagonal + lower) @ np.linalg.solve(diagonal, diagonal + lower.T)
    np.testing.assert_allclose(both @ as_matrix(smoother, np.eye(360)), np.eye(360), atol=1e-9)


def test_rigid_motions_of_a_group_are_solved_exactly(cloth: StiffCloth) -> None:
    two_level = TwoLevel(cloth.system, group_size=20)
    two_level.update(cloth.system, cloth.positions)
    correction = np.empty_like(cloth.right_hand_side)
    assert two_level.correct(cloth.right_hand_side, correction)
    product = np.empty_like(correction)
    cloth.system.apply(correction, product)
    again = np.empty_like(correction)
    two_level.correct(cloth.right_hand_side - product, again)
    assert np.abs(again).max() < 1e-5 * np.abs(correction).max()


def test_band_factor_equals_dense_cholesky() -> None:
    rng = np.random.default_rng(2)
    size, width = 42, 18
    root = np.tril(np.triu(rng.normal(size=(size, size)), -width + 1)) + 5.0 * np.eye(size)
    block = np.arange(size) // 6
    root[np.abs(block[:, None] - block) > width // 6 - 1] = 0.0
    matrix = root @ root.T
    band = np.zeros((size, width))
    for column in range(size):
        for row in range(column, min(size, column - column % 6 + width)):
            band[column, row - column] = matrix[row, column]
    assert factorise(band) == -1
    exact = np.linalg.cholesky(matrix)
    for column in range(size):
        rows = np.arange(column, min(size, column - column % 6 + width))
        np.testing.assert_allclose(band[column, rows - column], exact[rows, column], atol=1e-11)
    vector = rng.normal(size=size)
    solution = vector.copy()
    substitute(band, solution)
    np.testing.assert_allclose(matrix @ solution, vector, atol=1e-10)
    assert factorise(-np.ones((6, 6))) == 0


def test_groups_are_connected_and_of_bounded_size(cloth: StiffCloth) -> None:
    pattern = cloth.pattern
    group = aggregate_nodes(pattern.indptr, pattern.indices, 20)
    sizes = np.bincount(group)
    assert sizes.min() >= 1
    assert sizes.max() <= 60
    assert 500 / 20 * 0.7 < len(sizes) < 500 / 20 * 2.5
    graph = csr_array((np.ones(len(pattern.indices)), pattern.indices, pattern.indptr), shape=(500, 500))
    for g in range(len(sizes)):
        nodes = np.flatnonzero(group == g)
        assert connected_components(graph[nodes][:, nodes])[0] == 1


def test_groups_of_separate_pieces_do_not_mix() -> None:
    pattern = BlockPattern(9, [np.array([[0, 1, 2], [3, 4, 5], [6, 7, 8]], np.int32)])
    group = aggregate_nodes(pattern.indptr, pattern.indices, 20)
    np.testing.assert_array_equal(group, [0, 0, 0, 1, 1, 1, 2, 2, 2])


def test_apply_returns_the_inner_product(cloth: StiffCloth, preconditioner: Preconditioner) -> None:
    out = np.empty_like(cloth.right_hand_side)
    product = preconditioner.apply(cloth.right_hand_side, out)
    assert product == pytest.approx(float((cloth.right_hand_side * out).sum()), rel=1e-12)


def test_small_systems_get_block_jacobi_and_large_ones_two_levels(cloth: StiffCloth) -> None:
    assert isinstance(make_preconditioner(cloth.system), TwoLevel)
    assert isinstance(make_preconditioner(StiffCloth(60).system), BlockJacobi)
