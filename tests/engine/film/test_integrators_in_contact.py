"""Integrators and contact: explicit ones refuse it, BDF2 lands and forgets with the mesh."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from tests.engine.film.test_simulate import level_sheet
from tests.engine.step.test_only_what_is_asked import options
from toile.engine.film.integrators.bdf2 import bdf2
from toile.engine.film.integrators.explicit_euler import explicit_euler
from toile.engine.film.integrators.integrator import Ask, Integrator
from toile.engine.film.integrators.symplectic_euler import symplectic_euler
from toile.engine.film.plan import FilmPlan
from toile.engine.film.simulate import Simulation
from toile.engine.step.options import StepOutcome
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Float, Int
from toile.remesh.sizing.sizing import SizingOptions


def ball() -> tuple[Float, Int]:
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=0.15)
    return np.ascontiguousarray(mesh.vertices, np.float64), np.ascontiguousarray(mesh.faces, np.int32)


@pytest.mark.parametrize(
    ("integrator", "name"), [(explicit_euler, "explicit Euler"), (symplectic_euler, "symplectic Euler")]
)
@pytest.mark.parametrize("self_contact", [True, False])
def test_explicit_steps_refuse_contact(integrator: Integrator, name: str, self_contact: bool) -> None:
    plan = FilmPlan(step=options(self_contact), integrator=integrator, frame_seconds=1e-4, longest_step=1e-5)
    cloth = level_sheet(0.2, 0.2, 0.1, 0.2)
    with pytest.raises(ValueError, match=f"{name} has no contact: take an implicit integrator"):
        Simulation(cloth, None if self_contact else ball(), plan, lambda _: True).run(1e-4)
    free = Simulation(cloth, None, replace(plan, step=options()), lambda _: True)
    assert free.run(1e-4).steps == 10


def test_bdf2_lands_on_a_ball_without_crossings_or_bounce() -> None:
    cloth = level_sheet(0.4, 0.4, 0.04, 0.17)
    plan = FilmPlan(step=options(self_contact=True), integrator=bdf2, newton=4, newton_tolerance=1e-4)
    top: list[float] = []
    touched: list[int] = []

    def watch(_: object) -> bool:
        top.append(float(run.stepper.x[:, 1].max()))
        memory = run.stepper.memory
        touched.append(0 if memory is None else int(memory.touched.sum()))
        return True

    run = Simulation(cloth, ball(), plan, watch)
    record = run.run(0.4)
    assert record.crossings == [(0, 0)] * 13 and record.forced == 0
    assert 0.0 < min(record.min_gap) < 0.002
    assert touched[0] == 0 and 0 < touched[-1] < len(cloth.positions)
    landed = next(k for k, y in enumerate(top) if y < 0.156)
    assert max(top[landed:]) < 0.156
    assert run.stepper.x[:, 1].min() < 0.08


def test_bdf2_forgets_the_last_step_with_the_mesh() -> None:
    """What it starts from then is a backward Euler step, which has no estimate of its error."""
    cloth = level_sheet(0.5, 0.3, 0.1, 0.0)
    cloth = replace(cloth, pinned=cloth.positions[:, 0] < -0.25 + 1e-9)
    forgot: list[tuple[int, bool]] = []

    def noted(stepper: ClothStepper, h: float, ask: Ask) -> StepOutcome:
        memory = stepper.memory
        forgot.append((len(stepper.x), memory is None or memory.before is None))
        outcome = bdf2(stepper, h, ask)
        assert outcome.error is None or not forgot[-1][1]
        return outcome

    sizing = SizingOptions(size_min=0.02, size_max=0.4, refine_angle=0.3)
    plan = FilmPlan(
        step=options(self_contact=True), integrator=noted, newton=8, newton_tolerance=1e-4, sizing=sizing,
        remesh_frames=3,
    )  # fmt: skip
    record = Simulation(cloth, None, plan, lambda _: True).run(0.5)
    assert record.remeshings and not any(map(sum, record.crossings))
    first = [k for k, (_, anew) in enumerate(forgot) if anew]
    changed = [k for k in range(1, len(forgot)) if forgot[k][0] != forgot[k - 1][0]]
    assert first == [0, *changed] and len(changed) == len(record.remeshings)
