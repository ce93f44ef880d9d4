"""Springs and the mass-spring cloth: derivatives, damping, mass and stiffness of its nets."""

from dataclasses import replace

import numpy as np
import pytest

from toile.dressing.garment.fabrics import fabric
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.forces.air_flow import AirFlow
from toile.engine.forces.gusts import Gusts
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.membrane_damping import MembraneDamping
from toile.engine.forces.spring import SpringDamping, Springs
from toile.engine.solve.assembly import scatter_gradients, scatter_hessians
from toile.engine.solve.block_pattern import BlockPattern
from toile.geometry.arrays import Float
from toile.studies.scenes.flat_meshes import KINDS, mesh
from toile.studies.scenes.motion import Solving, carried_on, free_options
from toile.studies.scenes.spring_cloth import grid_springs, mesh_springs, spring_stepper

COTTON = fabric("cotton-poplin")
STEP = 1e-6


def one_spring(length: float) -> tuple[Springs, Float]:
    x = np.random.default_rng(3).normal(size=(2, 3))
    return Springs(np.array([[0, 1]], np.int32), np.array([length]), np.array([20.0])), x


def gradient_at(springs: Springs, x: Float) -> Float:
    springs.evaluate_gradient(x)
    return np.array(springs.element_gradient[0].ravel())


def dense_hessian(springs: Springs, x: Float) -> Float:
    pattern = BlockPattern(2, [springs.pairs])
    blocks = pattern.zeros()
    springs.evaluate(x)
    scatter_hessians(pattern.slots[0], springs.element_hessian, blocks)
    return pattern.to_dense(blocks)


def by_differences(springs: Springs, x: Float) -> tuple[Float, Float]:
    """Gradient of the energy and Hessian from the gradient, by central differences."""
    gradient, hessian = np.zeros(6), np.zeros((6, 6))
    for k in range(6):
        way = np.zeros(6)
        way[k] = STEP
        ahead, behind = x + way.reshape(2, 3), x - way.reshape(2, 3)
        gradient[k] = (springs.energy(ahead) - springs.energy(behind)) / (2.0 * STEP)
        hessian[k] = (gradient_at(springs, ahead) - gradient_at(springs, behind)) / (2.0 * STEP)
    return gradient, hessian


@pytest.mark.parametrize("length", [0.0, 0.5])
def test_lengthened_spring_has_the_exact_derivatives(length: float) -> None:
    springs, x = one_spring(length)
    gradient, hessian = by_differences(springs, x)
    assert gradient_at(springs, x) == pytest.approx(gradient, abs=1e-7)
    assert dense_hessian(springs, x) == pytest.approx(hessian, abs=1e-6)


def test_shortened_spring_has_the_exact_gradient_and_the_positive_part_of_the_hessian() -> None:
    springs, x = one_spring(9.0)
    gradient, exact = by_differences(springs, x)
    assert gradient_at(springs, x) == pytest.approx(gradient, abs=1e-6)
    values, vectors = np.linalg.eigh(exact)
    positive = (vectors * np.maximum(values, 0.0)) @ vectors.T
    assert values.min() < -1.0
    assert dense_hessian(springs, x) == pytest.approx(positive, abs=1e-5)


def test_spring_whose_ends_meet_pushes_nowhere_and_is_solid() -> None:
    springs, x = one_spring(1.0)
    x[1] = x[0]
    assert not gradient_at(springs, x).any()
    assert np.linalg.eigvalsh(dense_hessian(springs, x)).min() > -1e-12


def rigid_velocity(x: Float) -> Float:
    return np.asarray(np.cross([0.3, -2.0, 1.0], x) + np.array([1.0, 2.0, -0.5]))


def test_spring_damping_takes_power_from_lengthening_only() -> None:
    springs, x = one_spring(0.5)
    damping = SpringDamping(springs, 0.01)
    damping.evaluate(x)
    blocks = damping.element_damping[0]
    matrix = np.block([[blocks[0], blocks[2]], [blocks[2].T, blocks[1]]])
    assert matrix @ rigid_velocity(x).ravel() == pytest.approx(np.zeros(6), abs=1e-12)
    away = (x[0] - x[1]) / np.linalg.norm(x[0] - x[1])
    assert matrix @ np.concatenate((away, -away)) == pytest.approx(0.4 * np.concatenate((away, -away)))


def test_membrane_damping_is_the_rate_of_the_conditions_and_vanishes_in_rigid_motion() -> None:
    rest = np.array([[[0.0, 0.0], [1.0, 0.2], [0.3, 0.8]]])
    faces = np.array([[0, 1, 2]], np.int32)
    membrane = Membrane(faces, rest, np.array([30.0]), np.array([20.0]), np.array([5.0]))
    generator = np.random.default_rng(5)
    x = np.pad(rest[0], ((0, 0), (0, 1))) + 0.1 * generator.normal(size=(3, 3))
    v = generator.normal(size=(3, 3))
    damping = MembraneDamping(membrane, 0.02)
    damping.evaluate(x)
    pattern = BlockPattern(3, [faces])
    blocks = pattern.zeros()
    scatter_hessians(pattern.slots[0], damping.element_damping, blocks)
    matrix = pattern.to_dense(blocks)
    assert matrix @ rigid_velocity(x).ravel() == pytest.approx(np.zeros(9), abs=1e-12)

    def conditions(at: Float) -> Float:
        f = membrane.gradient(at)[0]
        return np.array([np.linalg.norm(f[:, 0]), np.linalg.norm(f[:, 1]), f[:, 0] @ f[:, 1]])

    rate = (conditions(x + STEP * v) - conditions(x - STEP * v)) / (2.0 * STEP)
    power = 0.02 * float(membrane.shape[0, 0] * (np.array([30.0, 20.0, 5.0]) @ rate**2))
    assert v.ravel() @ matrix @ v.ravel() == pytest.approx(power, rel=1e-7)


def test_membrane_gradient_alone_is_the_one_beside_the_hessian() -> None:
    points, faces = mesh("random", 0.3, 0.2, 0.05)
    membrane = Membrane(
        faces,
        points[faces],
        np.full(len(faces), 30.0),
        np.full(len(faces), 20.0),
        np.full(len(faces), 5.0),
        0.1,
    )
    x = np.pad(points, ((0, 0), (0, 1))) + 0.01 * np.random.default_rng(1).normal(size=(len(points), 3))
    membrane.evaluate(x)
    beside = membrane.element_gradient.copy()
    membrane.evaluate_gradient(x)
    assert membrane.element_gradient == pytest.approx(beside, rel=1e-12, abs=1e-14)


def test_grid_has_the_mass_and_the_stiffness_of_the_fabric() -> None:
    """Stretched along warp by 1 % by structural springs, sheared by 1 % by shear springs."""
    width, height = 0.3, 0.2
    limp = replace(COTTON, bending_warp=0.0, bending_weft=0.0, bending_bias=0.0)
    net = grid_springs(width, height, 6, 5, replace(limp, shear=0.0))
    assert net.mass.sum() == pytest.approx(COTTON.areal_density * width * height)
    assert len(net.pairs) == 6 * 6 + 7 * 5
    points = grid_points(width, height, 6, 5)
    stretched = Springs(net.pairs, net.lengths, net.stiffness).energy(points * [1.01, 1.0, 1.0])
    assert stretched == pytest.approx(0.5 * COTTON.stretch_warp * 1e-4 * width * height)

    net = grid_springs(width, height, 6, 5, replace(limp, stretch_warp=1e-12, stretch_weft=1e-12))
    sheared = points + 1e-3 * points[:, [1, 0, 2]] * [1.0, 0.0, 0.0]
    energy = Springs(net.pairs, net.lengths, net.stiffness).energy(sheared)
    assert energy == pytest.approx(0.5 * COTTON.shear * 1e-6 * width * height, rel=5e-3)


def grid_points(width: float, height: float, columns: int, rows: int) -> Float:
    u, v = np.meshgrid(np.linspace(0.0, width, columns + 1), np.linspace(0.0, height, rows + 1))
    return np.column_stack((u.ravel(), v.ravel(), np.zeros(u.size)))


@pytest.mark.parametrize("kind", KINDS)
def test_net_of_a_triangle_mesh_rests_flat_and_resists_folds(kind: str) -> None:
    points, faces = mesh(kind, 0.3, 0.2, 0.05)
    net = mesh_springs(points, faces, COTTON)
    flat = np.pad(points, ((0, 0), (0, 1)))
    springs = Springs(net.pairs, net.lengths, net.stiffness)
    total = np.zeros_like(flat)
    springs.evaluate_gradient(flat)
    scatter_gradients(net.pairs, springs.element_gradient, total)
    assert total == pytest.approx(np.zeros_like(flat), abs=1e-10)
    assert net.mass.sum() == pytest.approx(COTTON.areal_density * 0.06)
    turn = flat[:, 0] / 0.2
    rolled = np.column_stack((0.2 * np.sin(turn), flat[:, 1], 0.2 * (1.0 - np.cos(turn))))
    assert springs.energy(rolled) > 0.0


def test_wind_carries_a_net_along() -> None:
    """A sheet across a wind reaches its speed: the drag is 0.5 kg/s on 6 g."""
    net = grid_springs(0.3, 0.2, 6, 4, COTTON)
    air = AirFlow(velocity=(0.0, 0.0, 2.0), resistance=8.0)
    free = np.zeros(len(net.mass), bool)
    points = grid_points(0.3, 0.2, 6, 4)
    stepper = spring_stepper(net, points, free, free_options(gravity=0.0, air=air), damping=1e-3)
    carried_on(stepper, tr_bdf2, Solving(), 0.2, 0.01)
    assert stepper.v.mean(axis=0) == pytest.approx([0.0, 0.0, 2.0], abs=1e-3)


def test_gusts_are_those_of_their_seed_and_have_their_intensity() -> None:
    mean = np.array([4.0, 0.0, 0.0])
    gusts = Gusts(intensity=0.2, length=2.0, seed=7)
    times = np.arange(0.0, 2000.0, 0.5)
    speeds = np.array([gusts.velocity(mean, t) for t in times])
    assert speeds.mean(axis=0) == pytest.approx(mean, abs=0.02)
    assert speeds.std(axis=0) == pytest.approx([0.8, 0.8, 0.8], rel=0.05)
    again = Gusts(intensity=0.2, length=2.0, seed=7).velocity(mean, 1.25)
    assert (again == gusts.velocity(mean, 1.25)).all()
    assert (again != Gusts(intensity=0.2, length=2.0, seed=8).velocity(mean, 1.25)).all()
    flow = AirFlow(velocity=(4.0, 0.0, 0.0), resistance=1.0, gusts=gusts)
    assert (flow.velocity_at(1.25) == again).all()
