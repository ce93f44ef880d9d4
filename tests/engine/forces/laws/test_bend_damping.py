"""Damping of bending: none in rigid motion, and a strip that swings dies away as theory says."""

import math
from dataclasses import replace
from functools import cache
from math import inf

import numpy as np
import pytest

from tests.engine.forces.moving_step import MovingStep
from tests.engine.step.test_only_what_is_asked import SLACK, options, sheet
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.film.plan import FilmFrame, FilmPlan
from toile.engine.film.simulate import Simulation
from toile.engine.forces.bend import Bending, bending_tensor
from toile.engine.forces.laws.bend_damping import BendDamping
from toile.engine.forces.step_request import StepRequest
from toile.engine.solve.hessian import Hessian
from toile.engine.step.cloth_forces import cloth_stepper
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float
from toile.geometry.stage_clock import StageClock
from toile.remesh.panel.rectangle import rectangle
from toile.studies.scenes.flat_meshes import mesh
from toile.studies.validation.validate_curvature import rolled

LENGTH, RIGIDITY, DENSITY, DAMPING = 0.1, 1e-4, 0.1, 0.02
MODE = 1.8751041 / LENGTH
"""Of the first mode of a cantilever [1/m]."""
OMEGA = MODE**2 * math.sqrt(RIGIDITY / DENSITY)
PLUCKED = 1e-4
"""Of the tip at the start [m]."""
REQUEST = StepRequest(h=0.02, at_rest=False)


def rolled_sheet() -> tuple[Float, BendDamping]:
    points, faces = mesh("random", 1.0, 1.0, 0.2)
    ones = np.ones(len(faces))
    tensor = bending_tensor(ones, 1.5 * ones, 1.2 * ones)
    bending = Bending(faces, np.ascontiguousarray(points[faces]), tensor, len(points))
    return rolled(points, 0.4, 0.5), BendDamping(bending, 0.01 * ones)


def test_rigid_motion_costs_nothing() -> None:
    x, damping = rolled_sheet()
    turn, shift, h = np.array([1.0, -2.0, 0.5]), np.array([3.0, 1.0, -2.0]), REQUEST.h
    end = x + h * (np.cross(turn, x) + shift)
    damping.begin(MovingStep(REQUEST, x), x)
    gradient, other = np.zeros_like(x), np.zeros_like(x)
    damping.add_gradient(end, gradient)
    assert damping.energy(end) < 1e-20
    shaken = x + 0.01 * np.random.default_rng(1).normal(size=x.shape)
    damping.add_gradient(shaken, other)
    assert np.abs(gradient).max() < 1e-10 * np.abs(other).max()
    # and no force on the whole, and no torque
    assert np.abs(other.sum(axis=0)).max() < 1e-9 * np.abs(other).max()
    assert np.abs(np.cross(x, other).sum(axis=0)).max() < 1e-9 * np.abs(other).max()


def test_gradient_is_the_derivative_of_the_potential() -> None:
    x, damping = rolled_sheet()
    generator = np.random.default_rng(2)
    end, way = x + 0.01 * generator.normal(size=x.shape), generator.normal(size=x.shape)
    damping.begin(MovingStep(REQUEST, x), x)
    gradient = np.zeros_like(x)
    damping.add_gradient(end, gradient)
    slope = (damping.energy(end + 1e-6 * way) - damping.energy(end - 1e-6 * way)) / 2e-6
    assert slope == pytest.approx(float(np.vdot(gradient, way)), rel=1e-6)


def test_hessian_is_that_of_flat_cloth() -> None:
    points, faces = mesh("random", 1.0, 1.0, 0.25)
    ones = np.ones(len(faces))
    tensor = bending_tensor(ones, ones, ones)
    bending = Bending(faces, np.ascontiguousarray(points[faces]), tensor, len(points))
    damping = BendDamping(bending, 0.01 * ones)
    x = np.pad(points, ((0, 0), (0, 1)))
    step = MovingStep(REQUEST, x)
    hessian = Hessian(len(x), [])
    for force in (bending, damping):
        force.begin(step, x)
        force.linearise(x, np.zeros_like(x), hessian)
    assert hessian.constant_scale == pytest.approx(1.0 + 0.01 / REQUEST.h)
    along = np.zeros_like(x)
    along[:, 2] = np.random.default_rng(3).normal(size=len(x))
    change = np.zeros_like(x)
    damping.add_gradient(x + along, change)
    np.testing.assert_allclose(change, 0.01 / REQUEST.h * (bending.stiffness @ along), atol=1e-9)


def test_steps_at_rest_and_fabrics_without_it_do_without() -> None:
    x, damping = rolled_sheet()
    assert not damping.begin(MovingStep(replace(REQUEST, at_rest=True), x), x)
    bent = replace(SLACK, bending_warp=1e-6, bending_weft=1e-6, bending_bias=1e-6)
    assert cloth_stepper(sheet(bent), None, options(), StageClock()).force(BendDamping) is None
    damped = replace(bent, bending_damping=0.01)
    assert cloth_stepper(sheet(damped), None, options(), StageClock()).force(BendDamping) is not None


@cache
def decrement(edge: float, h: float) -> float:
    """Twice the logarithm of the ratio of the first two peaks of a cantilever in its first mode."""
    fabric = replace(
        SLACK, areal_density=DENSITY, bending_warp=RIGIDITY, bending_weft=RIGIDITY, bending_bias=RIGIDITY,
        stretch_warp=100.0, stretch_weft=100.0, shear=50.0, compression=1.0, bending_damping=DAMPING,
    )  # fmt: skip
    points, faces = rectangle(LENGTH + edge, 0.02, edge)
    points[:, 0] -= edge
    s = MODE * np.maximum(points[:, 0], 0.0)
    shape = np.cosh(s) - np.cos(s) - 0.734096 * (np.sinh(s) - np.sin(s))
    start = np.column_stack((points, 0.5 * PLUCKED * shape))
    cloth = flat_cloth(points, faces, start, fabric, pinned=points[:, 0] < 1e-9)
    plan = FilmPlan(
        step=StepOptions(gravity=0.0, self_contact=False), integrator=tr_bdf2, frame_seconds=h,
        longest_step=h, shortest_step=h, stretch_rise=inf, newton=10, newton_tolerance=1e-9,
        cg_tolerance=1e-6,
    )  # fmt: skip
    free = points[:, 0] > LENGTH - 1e-9
    tips: list[float] = [PLUCKED]

    def watch(frame: FilmFrame) -> bool:
        tips.append(float(frame.cloth.positions[free, 2].mean()))
        return True

    Simulation(cloth, None, plan, watch).run(1.2 * 2.0 * math.pi / OMEGA)
    tip = np.array(tips)
    low = int(tip[: len(tip) * 3 // 4].argmin())
    return 2.0 * math.log(-tip[low] / tip[low:].max())


@pytest.mark.parametrize(
    ("edge", "h"),
    [(0.01, 0.008), (0.01, 0.004), (0.005, 0.008), pytest.param(0.005, 0.004, marks=pytest.mark.slow)],
)
def test_a_strip_that_swings_has_the_decrement_of_theory(edge: float, h: float) -> None:
    ratio = 0.5 * DAMPING * OMEGA
    theory = 2.0 * math.pi * ratio / math.sqrt(1.0 - ratio**2)
    assert decrement(edge, h) == pytest.approx(theory, rel=0.05)
