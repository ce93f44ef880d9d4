"""Cloth in motion: free fall, free flight, a hanging strip, impact, and going on with another mesh."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest
import trimesh

from tests.engine.step.test_only_what_is_asked import GRAVITY, SLACK, forbidden, options, sheet
from toile.engine.cloth.cloth import Cloth
from toile.engine.film.integrators.backward_euler import backward_euler
from toile.engine.film.integrators.integrator import Integrator
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.film.plan import FilmFrame, FilmPlan
from toile.engine.film.simulate import Simulation
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Float
from toile.remesh.sizing.sizing import SizingOptions
from toile.studies.scenes.flat_meshes import right_grid

WOVEN = replace(
    SLACK, stretch_warp=3000.0, stretch_weft=3000.0, shear=100.0, bending_warp=5e-6, bending_weft=5e-6,
    bending_bias=5e-6,
)  # fmt: skip


def level_sheet(length: float, width: float, edge: float, height: float) -> Cloth:
    """A rectangle of woven cloth around the y axis, level at `height` [m]."""
    flat, faces = right_grid(length, width, edge)
    count = len(flat)
    positions = np.column_stack((flat[:, 0] - 0.5 * length, np.full(count, height), 0.5 * width - flat[:, 1]))
    return replace(
        sheet(WOVEN), positions=positions, velocities=np.zeros((count, 3)),
        node=np.arange(count, dtype=np.int32), faces=faces, rest_corners=np.ascontiguousarray(flat[faces]),
        fabric=np.zeros(len(faces), np.int32), garment=np.zeros(len(faces), np.int32),
        panel=np.zeros(len(faces), np.int32), uv=flat,
        pinned=np.zeros(count, bool), rest_curved=np.zeros(len(faces), bool), start_positions=positions,
    )  # fmt: skip


def film(cloth: Cloth, seconds: float, plan: FilmPlan) -> tuple[Simulation, list[FilmFrame]]:
    frames: list[FilmFrame] = []

    def keep(frame: FilmFrame) -> bool:
        frames.append(frame)
        return True

    run = Simulation(cloth, None, plan, keep)
    run.run(seconds)
    return run, frames


def energy(stepper: ClothStepper, gravity: float) -> float:
    """Kinetic, elastic and gravitational energy [J]."""
    kinetic = 0.5 * float(stepper.mass @ np.einsum("ij,ij->i", stepper.v, stepper.v))
    height = float(stepper.mass @ stepper.x[:, 1])
    return kinetic + stepper.elastic_energy() + gravity * height


@pytest.mark.parametrize("steps_per_second", [60, 120, 240])
def test_free_fall_errs_by_half_a_step_of_speed(steps_per_second: int) -> None:
    """Backward Euler: speeds are exact, the fall is g t (t + h) / 2."""
    h, seconds = 1.0 / steps_per_second, 0.2
    plan = FilmPlan(step=options(), longest_step=h, motion_max=inf, cg_tolerance=1e-10)
    run, frames = film(level_sheet(0.3, 0.3, 0.1, 0.0), seconds, plan)
    assert len(frames) == 7
    assert run.record.steps == round(seconds / h)
    assert run.stepper.x[:, 1] == pytest.approx(-0.5 * GRAVITY * seconds * (seconds + h), rel=1e-9)
    assert run.stepper.v[:, 1] == pytest.approx(-GRAVITY * seconds, rel=1e-9)


def test_momentum_is_kept_in_free_flight() -> None:
    cloth = level_sheet(0.4, 0.4, 0.05, 0.0)
    generator = np.random.default_rng(3)
    velocities = np.array([1.0, 2.0, -1.0]) + 0.5 * generator.normal(size=cloth.positions.shape)
    before = cloth.mass @ velocities
    plan = FilmPlan(step=replace(options(), gravity=0.0), cg_tolerance=1e-9)
    run, _ = film(replace(cloth, velocities=velocities), 0.2, plan)
    assert cloth.mass @ run.stepper.v == pytest.approx(before, rel=1e-6)
    assert run.record.cg_iterations > 0


@pytest.mark.parametrize("newton", [1, 4])
def test_a_hanging_strip_loses_energy_all_the_time(newton: int) -> None:
    cloth = level_sheet(0.5, 0.1, 0.025, 0.0)
    cloth = replace(cloth, pinned=cloth.positions[:, 0] < -0.25 + 1e-9)
    plan = FilmPlan(step=options(), newton=newton, newton_tolerance=1e-3, cg_tolerance=1e-6)
    levels: list[float] = []

    def weigh(_: FilmFrame) -> bool:
        levels.append(energy(run.stepper, GRAVITY))
        return True

    run = Simulation(cloth, None, plan, weigh)
    record = run.run(1.0)
    assert np.diff(levels).max() < 1e-9
    assert levels[-1] < levels[0] - 0.2 * GRAVITY * cloth.mass.sum() * 0.25
    assert np.array_equal(run.stepper.x[cloth.pinned], cloth.positions[cloth.pinned])
    assert max(record.stretch_max) < 0.1


def energy_kept(cloth: Cloth, integrator: Integrator, h: float, seconds: float) -> Float:
    """Energy of cloth that swings about its pins in a vacuum, less that at the start, per frame [J]."""
    plan = FilmPlan(
        step=replace(options(), self_contact=False), integrator=integrator, longest_step=h, newton=8,
        newton_tolerance=1e-5, cg_tolerance=1e-4, motion_max=inf,
    )  # fmt: skip
    levels: list[float] = []

    def weigh(_: FilmFrame) -> bool:
        levels.append(energy(run.stepper, GRAVITY))
        return True

    run = Simulation(cloth, None, plan, weigh)
    run.run(seconds)
    return np.array(levels) - levels[0]


def test_tr_bdf2_keeps_what_backward_euler_takes() -> None:
    """A strip swings down from level in 0.7 s: at equal steps 2 % are lost instead of 30."""
    cloth = level_sheet(0.5, 0.1, 0.025, 0.0)
    cloth = replace(cloth, pinned=cloth.positions[:, 0] < -0.25 + 1e-9)
    available = GRAVITY * cloth.mass.sum() * 0.25
    first = energy_kept(cloth, backward_euler, 1.0 / 120.0, 0.7)
    second = energy_kept(cloth, tr_bdf2, 1.0 / 120.0, 0.7)
    assert max(first) <= 1e-9 and max(second) < 1e-4 * available
    assert first[-1] < -0.3 * available
    assert second[-1] > -0.03 * available


def test_energy_drifts_by_less_than_one_percent_in_five_seconds() -> None:
    """And it never grows: a strip swings by 0.2 rad."""
    level = level_sheet(0.5, 0.1, 0.025, 0.0)
    along = level.positions[:, 0] + 0.25
    leaning = np.column_stack((along * np.sin(0.2), -along * np.cos(0.2), level.positions[:, 2]))
    cloth = replace(level, positions=leaning, pinned=along < 1e-9)
    available = GRAVITY * cloth.mass.sum() * 0.25 * (1.0 - np.cos(0.2))
    kept = energy_kept(cloth, tr_bdf2, 1.0 / 120.0, 5.0)
    assert kept.min() > -0.01 * available
    assert kept.max() < 1e-4 * available


def test_a_fall_is_exact_with_tr_bdf2() -> None:
    """From the first stage on: it starts from the acceleration, where nothing can be touched."""
    plan = FilmPlan(step=options(), integrator=tr_bdf2, motion_max=inf, cg_tolerance=1e-10)
    run, _ = film(level_sheet(0.3, 0.3, 0.1, 0.0), 0.2, plan)
    assert run.stepper.x[:, 1] == pytest.approx(-0.5 * GRAVITY * 0.2**2, rel=1e-9)
    assert run.stepper.v[:, 1] == pytest.approx(-GRAVITY * 0.2, rel=1e-9)


def test_tr_bdf2_does_not_make_what_lands_bounce() -> None:
    scene = level_sheet(0.3, 0.3, 0.05, 0.0)
    ground = np.array([[-1.0, -0.1, -1.0], [1.0, -0.1, -1.0], [1.0, -0.1, 1.0], [-1.0, -0.1, 1.0]])
    plan = FilmPlan(step=options(), integrator=tr_bdf2, newton=4, newton_tolerance=1e-4)
    highest: list[float] = []

    def watch(frame: FilmFrame) -> bool:
        highest.append(float(frame.cloth.positions[:, 1].max()))
        return True

    run = Simulation(scene, (ground, np.array([[0, 2, 1], [0, 3, 2]], np.int32)), plan, watch)
    record = run.run(0.5)
    landed = next(k for k, y in enumerate(highest) if y < -0.095)
    assert max(highest[landed:]) < -0.09
    assert not any(map(sum, record.crossings))


def test_a_sheet_falls_on_a_sphere_without_crossings() -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.15)
    avatar = (np.ascontiguousarray(ball.vertices, np.float64), np.ascontiguousarray(ball.faces, np.int32))
    cloth = level_sheet(0.6, 0.6, 0.04, 0.2)
    gaps: list[float] = []

    def watch(frame: FilmFrame) -> bool:
        assert not len(frame.crossings.avatar) and not len(frame.crossings.cloth)
        gaps.append(frame.min_gap)
        return True

    run = Simulation(cloth, avatar, FilmPlan(step=options(self_contact=True)), watch)
    record = run.run(0.6)
    assert record.crossings == [(0, 0)] * 19
    assert record.faces == [len(cloth.faces)] * 19
    assert 0.0 < min(gaps) < 0.002
    assert record.forced == 0
    assert np.linalg.norm(run.stepper.x, axis=1).min() > 0.149
    # It has come to rest on top and hangs around the sphere.
    assert 0.149 < run.stepper.x[:, 1].max() < 0.155
    assert run.stepper.x[:, 1].min() < -0.05


def test_a_step_that_stretches_too_much_is_undone_and_shortened() -> None:
    cloth = level_sheet(0.4, 0.4, 0.1, 0.0)
    velocities = np.zeros_like(cloth.positions)
    velocities[:, 0] = 40.0 * np.sign(cloth.positions[:, 0])
    plan = FilmPlan(step=options(), stretch_rise=0.02)
    run, _ = film(replace(cloth, velocities=velocities), 1.0 / 30.0, plan)
    assert run.record.retries > 0
    assert run.record.steps > 4


def test_the_film_goes_on_with_a_mesh_that_follows_the_cloth() -> None:
    """A sheet that swings down from one edge: momentum and energy stay, the mesh changes."""
    cloth = level_sheet(0.5, 0.3, 0.1, 0.0)
    cloth = replace(cloth, pinned=cloth.positions[:, 0] < -0.25 + 1e-9)
    sizing = SizingOptions(size_min=0.02, size_max=0.4, refine_angle=0.3)
    plan = FilmPlan(step=options(self_contact=True), sizing=sizing, remesh_frames=3)
    run = Simulation(cloth, None, plan, lambda _: True)
    record = run.run(0.5)
    assert record.remeshings and len(set(record.faces)) > 1
    assert len(set(record.faces[:4])) == 1, "the mesh changed before the cloth had moved"
    assert run.cloth.mass.sum() == pytest.approx(cloth.mass.sum(), rel=1e-12)
    assert max(done.energy_jump for done in record.remeshings) < 0.01
    assert not any(map(sum, record.crossings))
    assert "remesh" in run.clock.spent


def test_without_sizing_the_mesh_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("toile.engine.step.cloth_run.ClothRun.restart", forbidden("restart"))
    run, _ = film(level_sheet(0.3, 0.3, 0.05, 0.0), 0.1, FilmPlan(step=options()))
    assert len(set(run.record.faces)) == 1 and "remesh" not in run.clock.spent


def test_on_frame_ends_the_film() -> None:
    run = Simulation(level_sheet(0.2, 0.2, 0.1, 0.0), None, FilmPlan(step=options()), lambda f: f.index < 2)
    record = run.run(1.0)
    assert record.cancelled and len(record.crossings) == 3
    assert record.min_gap == [inf] * 3


@pytest.mark.parametrize(
    "name",
    [
        "cloth_forces.Collisions", "cloth_forces.Wind", "collisions.ContactSearch",
        "collisions.evaluate_contacts", "collisions.safe_factors", "collisions.safe_in_motion",
    ],
)  # fmt: skip
def test_free_flight_needs_no_search_and_no_wind(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"toile.engine.step.{name}", forbidden(name))
    run, frames = film(level_sheet(0.2, 0.2, 0.1, 0.0), 0.1, FilmPlan(step=options()))
    assert len(frames) > 1 and (run.cloth.velocities[:, 1] < 0.0).all()
