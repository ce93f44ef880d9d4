from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.forces.bend import Bending, bending_tensor
from toile.geometry.arrays import Float, Int
from toile.studies.scenes.flat_meshes import KINDS, mesh
from toile.studies.validation.validate_curvature import EDGE, bending_of, rigidity_when_rolled, rolled


@pytest.mark.parametrize("kind", KINDS)
def test_a_rolled_sheet_has_the_fabrics_rigidity_in_every_direction(kind: str) -> None:
    """Whole sheet, borders included: energy = D area / (2 R^2) within 0.5 % (the bar is 2 %)."""
    points, faces = mesh(kind, 1.0, 1.0, EDGE)
    bending = bending_of(points, faces, (1.0, 1.0, 1.0), 0.3)
    for degrees in range(0, 180, 15):
        found = rigidity_when_rolled(bending, points, degrees)
        assert found == pytest.approx(1.0, abs=0.005), degrees


@pytest.mark.parametrize("kind", KINDS)
def test_twist_and_saddle_show_the_poisson_ratio(kind: str) -> None:
    points, faces = mesh(kind, 1.0, 1.0, EDGE)
    bending = bending_of(points, faces, (1.0, 1.0, 1.0), 0.3)
    u, v = points.T
    for height, exact in (
        (u * v, 2 * (1 - 0.3)),
        (0.5 * (u * u - v * v), 2 - 2 * 0.3),
        (0.5 * (u * u + v * v), 2.6),
    ):
        x = np.column_stack((points, height))
        assert 2 * bending.energy(x) == pytest.approx(exact, abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_an_orthotropic_sheet_has_its_three_rigidities(kind: str) -> None:
    points, faces = mesh(kind, 1.0, 1.0, EDGE)
    rigidity = (12e-6, 5e-6, 7e-6)
    bending = bending_of(points, faces, rigidity)
    for degrees, expected in zip((0, 90, 45, 135), (*rigidity, rigidity[2]), strict=True):
        found = rigidity_when_rolled(bending, points, degrees)
        assert found == pytest.approx(expected, rel=0.005)


def test_tensor_stays_positive_for_any_bias_rigidity() -> None:
    warp, weft = np.array([1.0, 2.0, 5.0]), np.array([3.0, 2.0, 0.1])
    tensor = bending_tensor(warp, weft, np.array([0.0, 0.5, 1.0]), 0.3)
    assert (np.linalg.eigvalsh(tensor)[:, 0] > 0).all()


@pytest.mark.parametrize("kind", KINDS)
def test_only_planes_are_free(kind: str) -> None:
    """S is symmetric and positive but for constant and linear functions: no hidden soft modes."""
    points, faces = mesh(kind, 1.0, 1.0, 0.12)
    matrix = bending_of(points, faces, (1.0, 1.0, 1.0)).stiffness
    assert matrix.indices.dtype == np.int32 and matrix.has_sorted_indices
    dense = matrix.toarray()
    assert np.abs(dense - dense.T).max() < 1e-12 * np.abs(dense).max()
    values = np.linalg.eigvalsh(dense)
    assert np.abs(values[:3]).max() < 1e-11 * values[-1]


@pytest.mark.parametrize("kind", KINDS)
def test_a_free_plate_vibrates_at_one_frequency_on_every_mesh(kind: str) -> None:
    """Softest mode (twist) of a free unit square with D = density = 1, nu = 0: omega = 15.83, from below."""
    points, faces = mesh(kind, 1.0, 1.0, 0.08)
    bending = bending_of(points, faces, (1.0, 1.0, 1.0))
    area = bending.rigidity[:, 0, 0]
    mass = np.bincount(faces.ravel(), np.repeat(area / 3, 3), len(points))
    squares = eigh(bending.stiffness.toarray(), np.diag(mass), eigvals_only=True, subset_by_index=(0, 4))
    assert np.sqrt(squares[3]) == pytest.approx(15.83, rel=0.015)


def test_rigid_motions_are_free() -> None:
    points, faces = mesh("random", 1.0, 1.0, 0.1)
    bending = bending_of(points, faces, (1.0, 2.0, 1.4))
    x = Rotation.from_rotvec((1.0, -2.0, 0.5)).apply(np.column_stack((points, np.zeros(len(points))))) + 3.0
    assert np.abs(bending.gradient(x)).max() < 1e-12 * np.abs(bending.stiffness.data).max()


def test_gradient_is_the_derivative_of_the_energy_and_has_no_net_force_or_torque() -> None:
    points, faces = mesh("random", 1.0, 1.0, 0.2)
    generator = np.random.default_rng(5)
    u, v = points.T
    shape = np.column_stack((u, 0.3 * np.sin(2 * u) * np.cos(v), v))
    rest = unrolled_corners(shape, faces)
    ones = np.ones(len(faces))
    tensor = bending_tensor(ones, 1.5 * ones, 1.2 * ones)
    half = points[faces].mean(axis=1)[:, 0] > 0.5
    for rest_positions, rest_curved in ((None, None), (shape, None), (shape, half)):
        bending = Bending(
            faces, rest, tensor, len(points), rest_positions=rest_positions, rest_curved=rest_curved
        )
        x = shape + 0.03 * generator.standard_normal(shape.shape)
        step = 1e-6 * generator.standard_normal(shape.shape)
        gradient = bending.gradient(x)
        change = bending.energy(x + step) - bending.energy(x - step)
        assert change == pytest.approx(2 * float(np.vdot(gradient, step)), rel=1e-6)
        assert np.abs(gradient.sum(axis=0)).max() < 1e-9
        assert np.abs(np.cross(x, gradient).sum(axis=0)).max() < 1e-9


def test_a_curved_rest_shape_is_force_free_wherever_it_is() -> None:
    points, faces = mesh("random", 1.0, 1.0, 0.2)
    shape = rolled(points, 0.4, 0.5)
    ones = np.ones(len(faces))
    bending = Bending(
        faces,
        unrolled_corners(shape, faces),
        bending_tensor(ones, ones, ones),
        len(points),
        rest_positions=shape,
    )
    for x in (shape, Rotation.from_rotvec((0.3, -1.0, 2.0)).apply(shape) + 1.0):
        assert bending.energy(x) < 1e-20
        assert np.abs(bending.gradient(x)).max() < 1e-10
    flat = np.column_stack((points, np.zeros(len(points))))
    assert bending.energy(flat) == pytest.approx(0.5 / 0.5**2, rel=0.02)


def test_an_unresolved_crease_of_the_rest_shape_bears_little_and_curves_bear_all() -> None:
    points, faces = mesh("right", 1.0, 1.0, 0.1)
    ones = np.ones(len(faces))
    tensor = bending_tensor(ones, ones, ones)

    def share(shape: Float) -> Float:
        rest = unrolled_corners(shape, faces)
        curved = Bending(faces, rest, tensor, len(points), rest_positions=shape).rigidity[:, 0, 0]
        flat = Bending(faces, rest, tensor, len(points)).rigidity[:, 0, 0]
        return np.asarray(curved / flat)

    assert share(rolled(points, 0.4, 0.5)) == pytest.approx(1.0, abs=1e-12)
    # Folded back upon itself along u = 0.5, within one row of faces.
    u, v = points.T
    folded = np.column_stack((np.minimum(u, 1.0 - u), v, np.where(u > 0.55, 0.01, 0.0)))
    found = share(folded)
    at_fold = np.abs(points[faces].mean(axis=1)[:, 0] - 0.5) < 0.1
    assert np.median(found[at_fold]) < 0.5
    assert found[np.abs(points[faces].mean(axis=1)[:, 0] - 0.5) > 0.3].min() == 1.0


def unrolled_corners(shape: Float, faces: Int) -> Float:
    """Rest corners (t, 3, 2) of a mesh in space: each face in a plane of its own."""
    corners = shape[faces]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    length = np.linalg.norm(first, axis=1)
    along = np.einsum("ti,ti->t", second, first) / length
    rest = np.zeros((len(faces), 3, 2))
    rest[:, 1, 0], rest[:, 2, 0] = length, along
    rest[:, 2, 1] = np.sqrt(np.sum(second**2, axis=1) - along**2)
    return rest


def test_for_cloth_takes_fabrics_pins_and_rest_shapes_of_the_cloth() -> None:
    points, faces = mesh("random", 1.0, 1.0, 0.25)
    count = len(points)
    thin = Fabric(
        name="thin", areal_density=0.1, thickness=2e-4, bending_warp=2.0, bending_weft=3.0, bending_bias=2.4,
        stretch_warp=100.0, stretch_weft=100.0, shear=10.0,
    )  # fmt: skip
    thick = replace(thin, name="thick", bending_warp=20.0)
    which = (points[faces].mean(axis=1)[:, 0] > 0.5).astype(np.int32)
    pinned = points[:, 0] < 0.3
    start = rolled(points, 0.4, 0.5)
    rest = unrolled_corners(start, faces)
    cloth = Cloth(
        positions=start, velocities=np.zeros_like(start), node=np.arange(count, dtype=np.int32), faces=faces,
        rest_corners=rest, fabrics=(thin, thick), fabric=which, garment=np.zeros_like(which),
        panel=np.zeros_like(which), uv=points,
        stitches=np.empty((0, 2), np.int32), seam=np.empty(0, np.int32), stitch_length=np.empty(0),
        held=np.empty(0, np.int32), waist=np.empty(0, np.int32), pinned=pinned,
        rest_curved=np.ones(len(faces), bool), start_positions=start,
    )  # fmt: skip
    found = Bending.for_cloth(cloth)
    ones = np.ones(len(faces))
    tensor = bending_tensor(np.where(which == 1, 20.0, 2.0), 3 * ones, 2.4 * ones)
    expected = Bending(faces, rest, tensor, count, pinned=pinned, rest_positions=start)
    assert np.array_equal(found.stiffness.toarray(), expected.stiffness.toarray())
    assert np.abs(found.gradient(start)).max() < 1e-9
