"""Goals: pins that give way, in proportion to their weight and, whatever the mesh, to the area they hold."""

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.film.test_simulate import film, level_sheet
from tests.engine.step.test_only_what_is_asked import GRAVITY, options
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.goals import Goals
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.film.plan import FilmPlan
from toile.engine.film.simulate import Simulation
from toile.engine.forces.goal import GoalPull
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.cloth_forces import cloth_forces, cloth_stepper
from toile.engine.step.state import Instant
from toile.geometry.arrays import Float
from toile.geometry.stage_clock import StageClock
from toile.remesh.sizing.sizing import SizingOptions

STIFFNESS = 100.0
FPS = 30.0


def drawn(cloth: Cloth, stiffness: Float | float = STIFFNESS) -> Cloth:
    count = len(cloth.positions)
    return replace(
        cloth, goals=Goals(stiffness=np.broadcast_to(stiffness, count).copy(), places=cloth.positions)
    )


def goal_energy(cloth: Cloth, x: Float) -> float:
    """Energy of the springs [J], by their definition."""
    assert cloth.goals is not None
    away = ((x - cloth.goals.places) ** 2).sum(axis=1)
    return 0.5 * float((cloth.node_area * cloth.goals.stiffness) @ away)


def test_the_step_has_the_derivatives_of_the_energy() -> None:
    """Gradient of a cloth's forces and stencils of the goals, pins aside, by central differences."""
    cloth = level_sheet(0.3, 0.2, 0.1, 0.0)
    generator = np.random.default_rng(1)
    count = len(cloth.positions)
    pinned = np.arange(count) < 2
    soft = drawn(replace(cloth, pinned=pinned), generator.uniform(0.0, 200.0, count))
    x = cloth.positions + generator.normal(scale=0.02, size=(count, 3))
    now = Instant(StepRequest(h=0.01, at_rest=False), np.zeros_like(x), x)
    gradients = [np.zeros_like(x), np.zeros_like(x)]
    for own, total in zip((soft, replace(soft, goals=None)), gradients, strict=True):
        for force in cloth_forces(own, options()):
            if force.begin(now, x):
                force.add_gradient(x, total)
    gradient = gradients[0] - gradients[1]
    springs = GoalPull.for_cloth(soft)
    assert springs is not None and springs.held.tolist() == list(range(2, count))
    assert springs.begin(now, x)
    stencils = springs.stencils()
    for row, node in enumerate(springs.held):
        for axis in range(3):
            step = np.zeros_like(x)
            step[node, axis] = 1e-4
            slope = (goal_energy(soft, x + step) - goal_energy(soft, x - step)) / 2e-4
            assert gradient[node, axis] == pytest.approx(slope, abs=1e-8)
            there, back = np.zeros_like(x), np.zeros_like(x)
            springs.add_gradient(x + step, there)
            springs.add_gradient(x - step, back)
            assert stencils.stiffness[row, :, axis] == pytest.approx((there - back)[node] / 2e-4, abs=1e-8)
    assert not gradient[:2].any()


@pytest.mark.parametrize("edge", [0.1, 0.03])
def test_cloth_sinks_by_its_weight_over_the_stiffness_on_any_mesh(edge: float) -> None:
    cloth = drawn(level_sheet(0.4, 0.3, edge, 0.0))
    stepper = cloth_stepper(cloth, None, options(), StageClock())
    for _ in range(30):
        stepper.step(StepRequest(h=0.25, at_rest=True, cg_tolerance=1e-8, motion_max=np.inf))
    sag = cloth.fabrics[0].areal_density * GRAVITY / STIFFNESS
    assert stepper.x[:, 1] == pytest.approx(-sag, rel=1e-6)
    assert stepper.x[:, [0, 2]] == pytest.approx(cloth.positions[:, [0, 2]], abs=1e-9)


@pytest.mark.parametrize("edge", [0.1, 0.03])
def test_cloth_swings_as_a_spring_does_on_any_mesh(edge: float) -> None:
    """Half a period of sqrt(density/k) takes it through the level of equilibrium to twice the sag."""
    cloth = drawn(level_sheet(0.4, 0.3, edge, 0.0))
    density = cloth.fabrics[0].areal_density
    period = 2.0 * np.pi * np.sqrt(density / STIFFNESS)
    plan = FilmPlan(
        step=options(), integrator=tr_bdf2, frame_seconds=period / 40.0, longest_step=period / 40.0,
        cg_tolerance=1e-8,
    )  # fmt: skip
    _, frames = film(cloth, period, plan)
    sag = density * GRAVITY / STIFFNESS
    heights = np.array([frame.cloth.positions[:, 1].mean() for frame in frames]) / sag
    assert heights == pytest.approx(np.cos(2.0 * np.pi * np.linspace(0.0, 1.0, 41)) - 1.0, abs=0.02)


def test_goals_go_where_handles_lead_and_weights_follow_onto_every_new_mesh() -> None:
    """A sheet, fixed at one side and drawn less and less towards the other, turns about the fixed side."""
    cloth = level_sheet(0.4, 0.3, 0.05, 0.0)
    away = cloth.positions[:, 0] + 0.2
    pinned = away < 1e-9
    cloth = drawn(replace(cloth, pinned=pinned), 4.0 * STIFFNESS * (1.0 - away / 0.4))
    everyone = replace(cloth, pinned=np.ones(len(away), bool)).led()
    cloth = replace(cloth, handles=everyone.handles)
    angles = np.linspace(0.0, 1.5, 31)
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    start = cloth.positions
    frames = np.stack(
        [away * c - 0.2, away * s, np.broadcast_to(start[:, 2], (31, len(away)))], axis=2
    )  # fmt: skip
    plan = FilmPlan(
        step=replace(options(self_contact=True), gravity=0.0), frame_seconds=1.0 / FPS, newton=4,
        remesh_frames=2, sizing=SizingOptions(size_min=0.02, size_max=0.4, refine_angle=0.2),
    )  # fmt: skip
    motion = VertexMotion(frames=frames, fps=FPS)
    run = Simulation(cloth, None, plan, lambda _: True, pin_motion=motion)
    record = run.run(1.0)
    after = run.cloth
    assert record.remeshings and after.goals is not None and after.handles is not None
    share = np.empty(len(after.positions))
    share[after.node] = after.uv[:, 0] / 0.4
    assert after.goals.stiffness == pytest.approx(4.0 * STIFFNESS * (1.0 - share), abs=1e-9)
    assert np.asarray(after.handles.sum(axis=1)).ravel() == pytest.approx(1.0)
    assert after.goals.places == pytest.approx(np.asarray(after.handles @ start), abs=1e-12)
    target = np.asarray(after.handles @ motion.pose(30))
    off = np.linalg.norm(after.positions - target, axis=1)
    assert off[after.pinned].max() < 1e-12 and off[share < 0.25].max() < 0.02
    still = np.linalg.norm(after.positions - after.goals.places, axis=1)
    assert still[share > 0.5].min() > 0.1


def test_a_merged_seam_has_the_energy_of_its_sides() -> None:
    cloth = level_sheet(0.4, 0.3, 0.1, 0.0)
    generator = np.random.default_rng(5)
    count = len(cloth.positions)
    stiffness = generator.uniform(0.0, 200.0, count)
    stiffness[[0, 7]] = 0.0
    cloth = replace(
        cloth, stitches=np.array([[0, 7], [1, 8], [2, 9]], np.int32), seam=np.zeros(3, np.int32),
        stitch_length=np.zeros(3), goals=Goals(stiffness=stiffness, places=generator.normal(size=(count, 3))),
    )  # fmt: skip
    everyone = replace(cloth, pinned=np.ones(count, bool)).led()
    cloth = replace(cloth, handles=everyone.handles)
    merged = cloth.merged(np.ones(3, bool))
    assert merged.goals is not None and merged.handles is not None
    label = merged.node
    here, there = generator.normal(size=(2, count - 3, 3))
    apart = goal_energy(cloth, here[label]) - goal_energy(cloth, there[label])
    assert goal_energy(merged, here) - goal_energy(merged, there) == pytest.approx(apart)
    assert cloth.goals is not None
    assert np.asarray(merged.handles @ cloth.goals.places) == pytest.approx(merged.goals.places)


def test_goals_that_hold_nothing_cost_nothing() -> None:
    """Where all is free or fixed there are no springs, and the run is the same to the last bit."""
    cloth = level_sheet(0.3, 0.2, 0.05, 0.0)
    cloth = replace(cloth, pinned=cloth.positions[:, 0] < -0.1)
    idle = drawn(cloth, np.where(cloth.pinned, STIFFNESS, 0.0))
    plan = FilmPlan(step=options(), newton=2)
    one, _ = film(cloth, 0.1, plan)
    other, _ = film(idle, 0.1, plan)
    assert other.stepper.force(GoalPull) is None and one.stepper.force(GoalPull) is None
    assert np.array_equal(one.stepper.x, other.stepper.x)


def test_pins_without_handles_stay_while_others_are_led() -> None:
    cloth = level_sheet(0.4, 0.3, 0.05, 0.0)
    left, right = cloth.positions[:, 0] < -0.2 + 1e-9, cloth.positions[:, 0] > 0.2 - 1e-9
    led = replace(cloth, pinned=left).led()
    cloth = replace(led, pinned=left | right)
    start = cloth.positions[left]
    frames = start[None] + np.linspace(0.0, 0.01, 4)[:, None, None] * np.array([1.0, 0.0, 0.0])
    plan = FilmPlan(step=options(self_contact=True), frame_seconds=1.0 / FPS)
    run = Simulation(cloth, None, plan, lambda _: True, pin_motion=VertexMotion(frames=frames, fps=FPS))
    record = run.run(3.0 / FPS)
    assert not record.failure
    assert np.allclose(run.cloth.positions[left], frames[-1], atol=1e-12)
    assert np.array_equal(run.cloth.positions[right], cloth.positions[right])
