"""Forces that users give beside those of the cloth: they act, on every mesh that the cloth takes on."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from tests.engine.film.test_simulate import level_sheet
from tests.engine.step.test_only_what_is_asked import GRAVITY, options
from toile.engine.cloth.cloth import Cloth
from toile.engine.film.integrators.bdf2 import bdf2
from toile.engine.film.plan import FilmPlan
from toile.engine.film.simulate import Simulation
from toile.engine.forces.bend import Bending
from toile.engine.forces.force import NodalForce, StepState
from toile.engine.forces.step_request import StepRequest
from toile.engine.solve.hessian import Hessian
from toile.engine.step.cloth_forces import cloth_stepper
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float
from toile.geometry.stage_clock import StageClock
from toile.remesh.sizing.sizing import SizingOptions


class Lift(NodalForce):
    """Takes the weight off every node."""

    def __init__(self, cloth: Cloth) -> None:
        self.weight: Float = GRAVITY * cloth.mass
        self.sizes = len(cloth.positions)

    def begin(self, step: StepState, x: Float) -> bool:
        return step.request.gravity > 0.0

    def energy(self, x: Float) -> float:
        return -float(self.weight @ x[:, 1])

    def add_gradient(self, x: Float, gradient: Float) -> None:
        gradient[:, 1] -= self.weight

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        self.add_gradient(x, gradient)


class Idle(Lift):
    """Says that it does not act."""

    def begin(self, step: StepState, x: Float) -> bool:
        return False


def lifted(*made: type[Lift]) -> StepOptions:
    return replace(options(), more_forces=made)


@pytest.mark.parametrize("newton", [1, 4])
def test_a_lifted_sheet_hovers_and_others_fall(newton: int) -> None:
    plan = FilmPlan(step=lifted(Lift), newton=newton, motion_max=inf, cg_tolerance=1e-10)
    cloth = level_sheet(0.3, 0.3, 0.1, 0.0)
    for step, speed in ((lifted(Lift), 0.0), (lifted(Idle), -GRAVITY * 0.1), (options(), -GRAVITY * 0.1)):
        run = Simulation(cloth, None, replace(plan, step=step, frame_seconds=0.1), lambda _: True)
        run.run(0.1)
        assert run.stepper.v[:, 1] == pytest.approx(speed, rel=1e-9, abs=1e-12)
        assert run.stepper.acceleration(0.0)[:, 1] == pytest.approx(10.0 * speed, abs=1e-9)


def test_it_is_made_anew_for_every_mesh_and_keeps_its_share_of_the_motion() -> None:
    """A thrown sheet without weight keeps its momentum, through remeshings."""
    cloth = level_sheet(0.5, 0.3, 0.05, 0.0)
    velocities = np.zeros_like(cloth.positions)
    velocities[:, 1] = 1.0 + 2.0 * np.cos(12.0 * cloth.positions[:, 0])
    made: list[Lift] = []

    def lift(now: Cloth) -> Lift:
        made.append(Lift(now))
        return made[-1]

    plan = FilmPlan(
        step=replace(options(), more_forces=(lift,)), integrator=bdf2, newton=8, cg_tolerance=1e-9,
        sizing=SizingOptions(size_min=0.02, size_max=0.4, refine_angle=0.2), remesh_frames=2,
    )  # fmt: skip
    run = Simulation(replace(cloth, velocities=velocities), None, plan, lambda _: True)
    record = run.run(0.3)
    assert record.remeshings and len(set(record.faces)) > 1
    assert len(made) > len(record.remeshings)
    acting = run.stepper.force(Lift)
    assert acting is made[-1] and acting.sizes == len(run.stepper.x)
    assert run.cloth.mass @ run.stepper.v == pytest.approx(cloth.mass @ velocities, rel=1e-6, abs=1e-9)


def test_a_step_at_rest_asks_it_too() -> None:
    cloth = level_sheet(0.3, 0.3, 0.1, 0.0)
    stepper = cloth_stepper(cloth, None, lifted(Lift), StageClock())
    stepper.step(StepRequest(h=0.1, at_rest=True, cg_tolerance=1e-10))
    assert stepper.x == pytest.approx(cloth.positions, abs=1e-12)


def test_two_constant_matrices_are_refused() -> None:
    """The cloth bends already."""
    twice = replace(options(), more_forces=(Bending.for_cloth,))
    with pytest.raises(ValueError, match="2 forces have a constant matrix; at most one may"):
        cloth_stepper(level_sheet(0.3, 0.3, 0.1, 0.0), None, twice, StageClock())
