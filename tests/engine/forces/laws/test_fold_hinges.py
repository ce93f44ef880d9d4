"""Folds: derivatives, and strips that close to their angle, return after a pull and keep their line."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.engine.step.test_only_what_is_asked import SLACK, options, sheet
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.pattern import Edge, Fold, Panel, Pattern
from toile.dressing.wear.assemble_cloth import FOLD_WIDTH, assemble_cloth
from toile.engine.adapt.remeshing import carried_over, cloth_mesh
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.forces.laws.fold_hinges import FoldHinges
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.cloth_forces import cloth_stepper
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Float
from toile.geometry.stage_clock import StageClock
from toile.remesh.adapt.adapt import adapt

LENGTH, WIDTH = 0.08, 0.04
STIFF = Fabric(
    name="stiff", areal_density=0.1, thickness=2e-4, bending_warp=1e-4, bending_weft=1e-4, bending_bias=1e-4,
    stretch_warp=500.0, stretch_weft=500.0, shear=200.0,
)  # fmt: skip


def folded_strip(
    degrees: float, edge: float, slant: float = 0.0, points: tuple[tuple[float, float], ...] = ()
) -> Cloth:
    """A strip folded across its middle, or along `points`, its left end held."""
    corners = ((0.0, 0.0), (LENGTH, 0.0), (LENGTH, WIDTH), (0.0, WIDTH))
    middle = ((0.5 * LENGTH - slant, 0.0), (0.5 * LENGTH + slant, WIDTH))
    panel = Panel(
        name="strip", vertices=corners, edges=tuple(Edge(i, (i + 1) % 4) for i in range(4)),
        folds=(Fold(points or middle, degrees),),
    )  # fmt: skip
    mesh = mesh_pattern(Pattern(name="strip", panels=(panel,), stitches=()), edge_length=edge)
    held = np.flatnonzero(mesh.positions[:, 0] < 1.01 * edge).astype(np.int32)
    return assemble_cloth([(mesh, STIFF)], [held])


def between_wings(cloth: Cloth, x: Float) -> float:
    """Angle between the mean planes of both sides of the fold [degrees]."""
    normals = []
    assert cloth.folds is not None
    for part in (0, 1):
        a, b, c = x[cloth.face_nodes[cloth.folds.part == part]].swapaxes(0, 1)
        normal = np.cross(b - a, c - a).sum(axis=0)
        normals.append(normal / np.linalg.norm(normal))
    return math.degrees(math.acos(float(np.clip(normals[0] @ normals[1], -1.0, 1.0))))


def settle(stepper: ClothStepper, steps: int = 150) -> None:
    for number in range(steps):
        stepper.step(StepRequest(h=min(2e-3 * 1.2**number, 1.0), at_rest=True, cg_tolerance=1e-3))


@pytest.mark.parametrize("degrees", [70.0, -150.0, 180.0, -180.0])
def test_gradient_is_the_derivative_of_the_energy(degrees: float) -> None:
    cloth = folded_strip(degrees, 0.02, 0.01)
    force = FoldHinges.for_cloth(cloth)
    assert force is not None
    generator = np.random.default_rng(1)
    for turn in (0.0, 0.4, 1.5):
        x = cloth.positions.copy()
        beyond = x[:, 0] > 0.5 * LENGTH
        x[beyond, 2] += math.tan(turn) * (x[beyond, 0] - 0.5 * LENGTH)
        x += 0.002 * generator.normal(size=x.shape)
        gradient, way = np.zeros_like(x), generator.normal(size=x.shape)
        force.add_gradient(x, gradient)
        slope = (force.energy(x + 1e-8 * way) - force.energy(x - 1e-8 * way)) / 2e-8
        assert slope == pytest.approx(float(np.vdot(gradient, way)), rel=1e-5)
        # no force on the whole, no torque
        scale = np.abs(gradient).max()
        assert np.abs(gradient.sum(axis=0)).max() < 1e-9 * scale
        assert np.abs(np.cross(x, gradient).sum(axis=0)).max() < 1e-9 * scale


def test_the_sign_says_which_sides_face_each_other() -> None:
    cloth = folded_strip(0.0, 0.02)
    force = FoldHinges.for_cloth(cloth)
    assert force is not None
    x, beyond = cloth.positions.copy(), cloth.positions[:, 0] > 0.5 * LENGTH
    x[beyond, 2] += 0.5 * (x[beyond, 0] - 0.5 * LENGTH)
    assert force.angles(x) == pytest.approx(math.atan(0.5))
    x[:, 2] *= -1.0
    assert force.angles(x) == pytest.approx(-math.atan(0.5))


@pytest.mark.parametrize("edge", [0.01, 0.005])
@pytest.mark.parametrize(("degrees", "slant"), [(90.0, 0.0), (-120.0, 0.01)])
def test_a_fold_closes_to_its_angle_and_returns_after_a_pull(
    degrees: float, slant: float, edge: float
) -> None:
    cloth = folded_strip(degrees, edge, slant)
    stepper = cloth_stepper(cloth, None, replace(options(self_contact=True), gravity=0.0), StageClock())
    settle(stepper)
    assert between_wings(cloth, stepper.x) == pytest.approx(abs(degrees), abs=2.0)
    hinges = stepper.force(FoldHinges)
    assert hinges is not None
    assert np.degrees(hinges.angles(stepper.x)) == pytest.approx(degrees, abs=2.0)
    # Pulled flat, and let go.
    end, away = cloth.positions[:, 0] > LENGTH - 1e-9, stepper.x.copy()
    stepper.pinned = cloth.pinned | end
    for share in np.linspace(0.1, 1.0, 10):
        stepper.x[end] = (1.0 - share) * away[end] + share * cloth.positions[end]
        settle(stepper, 5)
    assert between_wings(cloth, stepper.x) < 20.0
    stepper.pinned = cloth.pinned
    settle(stepper)
    assert between_wings(cloth, stepper.x) == pytest.approx(abs(degrees), abs=2.0)


@pytest.mark.parametrize("degrees", [180.0, -180.0])
def test_a_fold_shuts(degrees: float) -> None:
    """Both halves lie on each other, as near as contact lets them: a millimetre apart over 4 cm."""
    cloth = folded_strip(degrees, 0.01)
    stepper = cloth_stepper(cloth, None, replace(options(self_contact=True), gravity=0.0), StageClock())
    settle(stepper, 250)
    hinges = stepper.force(FoldHinges)
    assert hinges is not None
    assert np.degrees(hinges.angles(stepper.x)) == pytest.approx(degrees, abs=2.0)
    assert between_wings(cloth, stepper.x) > 175.0


def test_its_stiffness_is_that_of_cloth_bent_over_a_millimetre() -> None:
    cloth = folded_strip(90.0, 0.02)
    assert cloth.folds is not None
    assert cloth.folds.lines[0].stiffness == pytest.approx(STIFF.bending_warp / FOLD_WIDTH)


def test_remeshing_keeps_the_fold_where_it_was_drawn() -> None:
    """Refined and coarsened again and again: the same length, the same two areas, on the same line."""
    cloth = folded_strip(90.0, 0.02, points=((0.035, 0.0), (0.045, 0.018), (0.041, WIDTH)))
    assert cloth.folds is not None
    hinges = cloth.folds.hinges(cloth.faces, cloth.uv)
    length = hinges.length.sum()
    drawn = np.linalg.norm(np.diff(cloth.folds.lines[0].points, axis=0), axis=1).sum()
    assert length == pytest.approx(drawn, abs=1e-12)
    area = np.bincount(cloth.folds.part, cloth.rest_area)
    counts = []
    for number in range(12):
        wanted = 0.006 if number % 2 == 0 else 0.02
        mesh = cloth_mesh(cloth, cloth.positions)
        result = adapt(mesh, np.tile(np.eye(3) / wanted**2, (len(mesh.rest), 1, 1)))
        cloth = carried_over(cloth, result.mesh, result.transfer)
        assert cloth.folds is not None
        counts.append(len(cloth.faces))
        hinges = cloth.folds.hinges(cloth.faces, cloth.uv)
        assert hinges.length.sum() == pytest.approx(length, abs=1e-9)
        np.testing.assert_allclose(np.bincount(cloth.folds.part, cloth.rest_area), area, rtol=1e-12)
        inner = np.linalg.norm(cloth.uv[:, None] - cloth.folds.lines[0].points[None, 1], axis=2).min()
        assert inner < 1e-12
    assert counts[0] > 2 * counts[1]


def test_cloth_without_folds_has_no_hinges() -> None:
    assert cloth_stepper(sheet(SLACK), None, options(), StageClock()).force(FoldHinges) is None
