import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from toile.engine.forces.membrane import Membrane
from toile.engine.solve.assembly import node_pairs
from toile.geometry.arrays import Float, as_positions
from toile.geometry.topology import triangle_topology
from toile.studies.scenes.flat_meshes import KINDS, mesh
from toile.studies.validation.validate_patch import SHEAR, WARP, WEFT, membrane_of

REST = np.array([[[0.1, 0.0], [1.1, 0.3], [0.4, 0.9]]])
FACE = np.array([[0, 1, 2]], np.int32)


def full_hessian(membrane: Membrane) -> Float:
    blocks = np.zeros((3, 3, 3, 3))
    for pair, (a, b) in enumerate(node_pairs(3)):
        blocks[a, :, b, :] = membrane.element_hessian[0, pair]
        blocks[b, :, a, :] = membrane.element_hessian[0, pair].T
    return blocks.reshape(9, 9)


def states() -> list[Float]:
    generator = np.random.default_rng(3)
    flat = np.column_stack((REST[0], np.zeros(3)))
    return [flat * scale + 0.3 * generator.standard_normal((3, 3)) for scale in (0.3, 0.9, 1.0, 1.5, 3.0)]


@pytest.mark.parametrize("state", range(5))
def test_gradient_is_the_derivative_of_the_energy(state: int) -> None:
    x = states()[state]
    membrane = membrane_of(FACE, REST)
    membrane.evaluate(x)
    gradient, size = membrane.element_gradient[0].copy(), 1e-6
    assert membrane.element_energy[0] == pytest.approx(membrane.energy(x))
    for corner in range(3):
        for axis in range(3):
            step = np.zeros((3, 3))
            step[corner, axis] = size
            slope = (membrane.energy(x + step) - membrane.energy(x - step)) / (2 * size)
            assert slope == pytest.approx(gradient[corner, axis], rel=1e-6, abs=1e-4)


def condition_hessian(f: Float, term: int) -> Float:
    """Hessian of one term of the energy density in (f_u, f_v) by finite differences, shape (6, 6)."""

    def density(y: Float) -> float:
        u, v = y[:3], y[3:]
        values = (
            0.5 * WARP * (np.linalg.norm(u) - 1) ** 2,
            0.5 * WEFT * (np.linalg.norm(v) - 1) ** 2,
            0.5 * SHEAR * (u @ v) ** 2,
        )
        return float(values[term])

    size, result = 1e-4, np.empty((6, 6))
    unit = np.eye(6) * size
    for i in range(6):
        for j in range(6):
            corners = [density(f + s * unit[i] + r * unit[j]) * s * r for s in (1, -1) for r in (1, -1)]
            result[i, j] = sum(corners) / (4 * size * size)
    return result


@pytest.mark.parametrize("state", range(5))
def test_hessian_is_the_positive_part_of_the_finite_difference_one(state: int) -> None:
    """Each of the three terms, differentiated twice and its negative eigenvalues dropped, then summed."""
    x = states()[state]
    membrane = membrane_of(FACE, REST)
    membrane.evaluate(x)
    rest = np.stack((REST[0, 1] - REST[0, 0], REST[0, 2] - REST[0, 0]), axis=1)
    shape = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]) @ np.linalg.inv(rest)
    f = np.concatenate((shape[:, 0] @ x, shape[:, 1] @ x))
    projected = np.zeros((6, 6))
    for term in range(3):
        values, vectors = np.linalg.eigh(condition_hessian(f, term))
        projected += (vectors * np.maximum(values, 0)) @ vectors.T
    to_corners = np.kron(shape.T, np.eye(3))
    expected = 0.5 * abs(np.linalg.det(rest)) * to_corners.T @ projected @ to_corners
    found = full_hessian(membrane)
    assert np.abs(found - expected).max() < 1e-5 * np.abs(expected).max()
    assert np.linalg.eigvalsh(found).min() > -1e-10 * np.abs(found).max()


def test_hessian_is_exact_where_nothing_is_clamped() -> None:
    """Stretched along both threads without shear every eigenvalue is positive: finite differences."""
    flat = np.column_stack((REST[0] * (1.2, 1.1), np.zeros(3)))
    x = as_positions(Rotation.from_rotvec((0.3, 0.2, -1)).apply(flat))
    membrane = membrane_of(FACE, REST)
    membrane.evaluate(x)
    found, size = full_hessian(membrane), 1e-6
    columns = []
    for entry in range(9):
        step = np.zeros(9)
        step[entry] = size
        membrane.evaluate(x + step.reshape(3, 3))
        ahead = membrane.element_gradient[0].ravel().copy()
        membrane.evaluate(x - step.reshape(3, 3))
        columns.append((ahead - membrane.element_gradient[0].ravel()) / (2 * size))
    assert np.abs(found - np.array(columns)).max() < 1e-7 * np.abs(found).max()


def test_collapsed_faces_stay_finite_and_positive() -> None:
    membrane = membrane_of(FACE, REST)
    for x in (np.zeros((3, 3)), np.outer(np.arange(3.0), (1.0, 0.0, 0.0)), 1e-12 * states()[2]):
        membrane.evaluate(x)
        assert np.isfinite(membrane.element_gradient).all()
        assert np.linalg.eigvalsh(full_hessian(membrane)).min() > -1e-9
    flat = membrane_of(FACE, np.zeros((1, 3, 2)))
    flat.evaluate(states()[0])
    assert not flat.element_hessian.any() and not flat.element_gradient.any()


@pytest.mark.parametrize("kind", KINDS)
def test_uniform_strain_is_in_equilibrium_and_its_energy_does_not_depend_on_the_mesh(kind: str) -> None:
    points, faces = mesh(kind, 1.0, 0.8, 0.1)
    membrane = membrane_of(faces, points[faces])
    stretch = np.array([[1.1, 0.05, 0.2], [-0.03, 0.97, 0.1]])
    x = points @ stretch
    membrane.evaluate(x)
    forces = np.zeros_like(x)
    np.add.at(forces, faces, membrane.element_gradient)
    inside = np.setdiff1d(np.arange(len(points)), triangle_topology(faces).border_edges)
    assert np.abs(forces[inside]).max() < 1e-12 * WARP
    u, v = stretch
    density = WARP * (np.linalg.norm(u) - 1) ** 2 + WEFT * (np.linalg.norm(v) - 1) ** 2 + SHEAR * (u @ v) ** 2
    assert membrane.energy(x) == pytest.approx(0.5 * density * 0.8, rel=1e-12)
    strain = membrane.warp_weft_strain(x)
    assert np.abs(strain - [np.linalg.norm(u) - 1, np.linalg.norm(v) - 1]).max() < 1e-12


def test_rigid_motions_are_free() -> None:
    points, faces = mesh("random", 1.0, 1.0, 0.1)
    membrane = membrane_of(faces, points[faces])
    for turn in ((0.0, 0.0, 0.0), (1.0, -2.0, 0.5)):
        x = as_positions(
            Rotation.from_rotvec(turn).apply(np.column_stack((points, np.zeros(len(points))))) + 2
        )
        membrane.evaluate(x)
        assert np.abs(membrane.element_gradient).max() < 1e-13 * WARP
