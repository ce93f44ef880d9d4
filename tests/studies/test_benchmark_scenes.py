"""The reference scenes: what they are, that their first frames run without crossings, how meshes compare."""

import numpy as np
import pytest

from toile.engine.film.simulate import Simulation
from toile.studies.adaptive.remesh import Rung, error_at
from toile.studies.scenes.scenes import FLAG_WIND, SCENES, SPHERE_RADIUS, flag, hang, sphere


@pytest.mark.parametrize("name", SCENES)
def test_first_frames_run_without_crossings(name: str) -> None:
    scene = SCENES[name](0.1)
    run = Simulation(scene.cloth, scene.avatar, scene.plan, lambda _: True)
    record = run.run(0.2)
    assert record.crossings == [(0, 0)] * 7
    assert max(record.stretch_max) < 0.1
    assert scene.seconds == 2.0


@pytest.mark.parametrize("name", SCENES)
def test_meshes_follow_the_edge_length(name: str) -> None:
    cloth = SCENES[name](0.05).cloth
    corners = cloth.positions[cloth.face_nodes]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    assert edges.mean() == pytest.approx(0.05, rel=0.08)
    assert cloth.rest_area.sum() == pytest.approx(1.5 if name == "flag" else 1.0)


def test_the_sphere_is_round_to_a_third_of_a_millimetre() -> None:
    scene = sphere(0.1)
    assert scene.avatar is not None
    vertices, faces = scene.avatar
    assert np.linalg.norm(vertices, axis=1) == pytest.approx(SPHERE_RADIUS)
    assert np.linalg.norm(vertices[faces].mean(axis=1), axis=1).min() > SPHERE_RADIUS - 3e-4
    assert scene.cloth.positions[:, 1] == pytest.approx(0.3)


def test_the_flag_is_held_by_its_short_edge_in_wind_and_the_sheet_by_two_corners() -> None:
    held = flag(0.1)
    assert held.cloth.pinned.sum() == 11
    air = held.plan.step.air
    assert air is not None
    assert np.linalg.norm(air.velocity) == pytest.approx(FLAG_WIND)
    # Pressure of 60 Pa at 10 m/s.
    assert air.resistance * FLAG_WIND == pytest.approx(0.5 * 1.2 * FLAG_WIND**2)
    assert hang(0.1).cloth.pinned.sum() == 2


def test_a_uniform_mesh_of_some_time_lies_between_those_of_the_ladder_on_logarithmic_scales() -> None:
    ladder = tuple(
        Rung(edge=0.1, cpu=cpu, faces=100.0, error=error, distance=error, turn=0.0)
        for cpu, error in ((100.0, 1.0), (1.0, 100.0))
    )
    assert error_at(ladder, 10.0) == pytest.approx(10.0)
    assert error_at(ladder, 0.1) == pytest.approx(100.0)
    assert error_at(ladder, 1000.0) == pytest.approx(1.0)
