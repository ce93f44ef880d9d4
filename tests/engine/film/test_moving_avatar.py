"""Cloth on an avatar that moves: pushed, carried, dragged by friction, and taken up again."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from tests.engine.film.test_simulate import level_sheet
from tests.engine.step.test_only_what_is_asked import options
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.film.plan import PUSHED_NEWTON, PUSHED_TOLERANCE, FilmFrame, FilmPlan
from toile.engine.film.simulate import ARRIVED, Simulation
from toile.engine.forces.contact import ContactLaw
from toile.geometry.arrays import Float, Int

FPS = 30.0


def plan() -> FilmPlan:
    return FilmPlan(
        step=options(self_contact=True), frame_seconds=1.0 / FPS, newton=PUSHED_NEWTON,
        newton_tolerance=PUSHED_TOLERANCE,
    )  # fmt: skip


def film(
    vertices: Float, faces: Int, places: Float, height: float, film_plan: FilmPlan, speed: float = 0.0
) -> tuple[Simulation, list[FilmFrame]]:
    """Cloth level at a height, above a rigid body that goes through `places`, shape (k, 3)."""
    cloth = level_sheet(0.3, 0.3, 0.05, height)
    cloth = replace(cloth, velocities=cloth.velocities + np.array([0.0, speed, 0.0]))
    motion = VertexMotion(frames=vertices[None] + places[:, None, :], fps=FPS)
    frames: list[FilmFrame] = []

    def keep(frame: FilmFrame) -> bool:
        frames.append(frame)
        return True

    run = Simulation(cloth, (motion.pose(0), faces), film_plan, keep, motion)
    run.run(motion.seconds)
    return run, frames


def body(mesh: trimesh.Trimesh) -> tuple[Float, Int]:
    return np.ascontiguousarray(mesh.vertices, np.float64), np.ascontiguousarray(mesh.faces, np.int32)


def test_a_rising_ball_lifts_the_cloth_and_never_passes_through_it() -> None:
    vertices, faces = body(trimesh.creation.icosphere(subdivisions=3, radius=0.1))
    rise = np.linspace(0.0, 0.4, 9)[:, None] * np.array([0.0, 1.0, 0.0])
    run, frames = film(vertices, faces, rise, 0.105, plan())
    assert all(sum(found) == 0 for found in run.record.crossings)
    assert not run.record.failure and max(run.record.lag) <= ARRIVED
    assert run.cloth.positions[:, 1].max() > 0.4 + 0.1
    assert frames[-1].avatar == pytest.approx(vertices + rise[-1], abs=ARRIVED)


@pytest.mark.parametrize("pull", [2.0, 8.0])
def test_cloth_on_a_plate_sticks_below_the_friction_limit_and_slides_above(pull: float) -> None:
    """A plate accelerates sideways: the cloth follows, or is left with mu g."""
    friction = 0.35
    vertices, faces = body(trimesh.creation.box(extents=(6.0, 0.02, 1.0)))
    time = np.arange(16) / FPS
    # At rest first, so that cloth lies on the plate.
    along = 0.5 * pull * np.maximum(time - 0.1, 0.0) ** 2
    step = options(self_contact=False)
    step = replace(step, law_body=ContactLaw(stiffness=2e6, edge_share=0.5))
    run, frames = film(
        vertices, faces, along[:, None] * np.array([1.0, 0.0, 0.0]), 0.0118, replace(plan(), step=step)
    )
    moved = np.array([frame.cloth.positions[:, 0].mean() for frame in frames])
    if pull < friction * 9.81:
        assert moved[-1] == pytest.approx(along[-1], abs=2e-3)
    else:
        # The plate comes to a stop at its last frame.
        speed = np.diff(moved)[-9:-1] * FPS
        assert np.diff(speed).mean() * FPS == pytest.approx(friction * 9.81, rel=0.05)
    assert not run.record.failure


def test_a_film_taken_up_after_any_frame_ends_in_the_same_bytes() -> None:
    vertices, faces = body(trimesh.creation.icosphere(subdivisions=2, radius=0.1))
    rise = np.linspace(0.0, 0.2, 7)[:, None] * np.array([0.2, 1.0, 0.0])
    whole, _ = film(vertices, faces, rise, 0.105, plan())
    half, _ = film(vertices, faces, rise[:4], 0.105, plan())
    motion = VertexMotion(frames=vertices[None] + rise[:, None, :], fps=FPS)

    def begin(stop: Callable[[FilmFrame], bool]) -> Simulation:
        return Simulation(level_sheet(0.3, 0.3, 0.05, 0.105), (motion.pose(0), faces), plan(), stop, motion)

    first = begin(lambda frame: frame.index < 3)
    first.run(motion.seconds)
    state = first.state()
    state.record.cancelled = False
    second = begin(lambda _: True)
    second.go_on_from(state)
    second.run(motion.seconds - 3 / FPS)
    assert len(half.record.crossings) == 4
    assert np.array_equal(second.cloth.positions, whole.cloth.positions)
    assert np.array_equal(second.cloth.velocities, whole.cloth.velocities)
    assert second.record == whole.record


def test_an_avatar_that_jumps_ends_the_film_with_the_frame_and_the_vertex() -> None:
    vertices, faces = body(trimesh.creation.icosphere(subdivisions=1, radius=0.1))
    places = np.zeros((5, 3))
    places[3:, 0] = 3.0
    run, frames = film(vertices, faces, places, 0.3, plan())
    assert len(frames) == 3
    assert "after frame 2" in run.record.failure and "vertex" in run.record.failure


def test_an_avatar_that_cloth_holds_back_ends_the_film_with_the_place() -> None:
    """Cloth pinned at every node cannot give way to a ball that rises into it."""
    vertices, faces = body(trimesh.creation.icosphere(subdivisions=2, radius=0.1))
    motion = VertexMotion(
        frames=vertices[None] + np.linspace(0.0, 0.3, 5)[:, None, None] * [0, 1, 0], fps=FPS
    )
    cloth = level_sheet(0.3, 0.3, 0.05, 0.105)
    cloth = replace(cloth, pinned=np.ones(len(cloth.positions), bool))
    run = Simulation(cloth, (motion.pose(0), faces), plan(), lambda _: True, motion)
    run.run(motion.seconds)
    assert "back by" in run.record.failure and "near (0.00, 0.10, 0.00) m" in run.record.failure
    assert not any(map(sum, run.record.crossings))


def test_motion_goes_through_its_frames_smoothly() -> None:
    rng = np.random.default_rng(5)
    motion = VertexMotion(frames=rng.normal(size=(5, 4, 3)), fps=24.0)
    for index in range(5):
        assert np.array_equal(motion.at(index / 24.0), motion.frames[index])
    step = 1e-6
    before = (motion.at(2 / 24.0) - motion.at(2 / 24.0 - step)) / step
    after = (motion.at(2 / 24.0 + step) - motion.at(2 / 24.0)) / step
    assert np.allclose(before, after, rtol=1e-3, atol=1e-2)
    assert np.array_equal(motion.at(9.0), motion.frames[-1])


def test_a_vertex_that_stands_still_does_not_swing_back_before_it_jumps() -> None:
    places = np.zeros((6, 1, 3))
    places[3:, 0, 0] = 1.0
    motion = VertexMotion(frames=places, fps=10.0)
    along = np.array([motion.at(time)[0, 0] for time in np.linspace(0.0, 0.5, 200)])
    assert along.min() == 0.0 and along.max() == 1.0 and (np.diff(along) >= 0.0).all()
