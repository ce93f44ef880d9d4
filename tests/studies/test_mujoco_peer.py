"""MuJoCo beside toile: which node is which, what its model says, and a sheet that it lets fall."""

from importlib.util import find_spec

import numpy as np
import pytest

from toile.studies.scenes.scenes import GRAVITY, sphere
from toile.studies.scenes.swing import swing
from toile.studies.speed_error import mujoco_peer
from toile.studies.speed_error.mujoco_peer import MujocoFilm, at_nodes_of, crossings_in_all, side_strain
from toile.studies.speed_error.mujoco_worker import POISSON, model_text

JOB = {
    "scene": "swing", "cells": 4, "seconds": 0.1, "frame_seconds": 1.0 / 30.0, "step": 0.004,
    "stretch": 900.0, "bending": 2e-5, "areal_density": 0.12, "radius": 0.25, "drop": 0.05,
}  # fmt: skip


def test_nodes_are_found_again_by_where_they_start() -> None:
    start = swing(4).positions
    other = np.random.default_rng(1).permutation(len(start))
    moved = start + np.array([0.0, -0.5, 0.0])
    film = MujocoFilm(np.array([start[other], moved[other]]), np.zeros((0, 3), np.int32), 0.0)
    assert at_nodes_of(start, film) == pytest.approx(moved)


def test_strain_is_that_of_the_sides() -> None:
    ticks = np.linspace(0.0, 1.0, 4)
    level = np.array([(x, 0.0, -y) for x in ticks for y in ticks])
    pulled = level * (1.1, 1.0, 1.0)
    film = MujocoFilm(np.array([level, pulled]), np.array([[0, 1, 4], [1, 5, 4]], np.int32), 0.0)
    assert side_strain(film, 3) == pytest.approx(0.1)
    assert crossings_in_all(film, None) == 0
    ball = sphere(0.2).avatar
    assert ball is not None
    assert crossings_in_all(film, ball) > 0


def test_the_plate_has_both_stiffnesses() -> None:
    text = model_text(JOB)
    young, thickness = (float(text.split(f'{name}="')[1].split('"')[0]) for name in ("young", "thickness"))
    assert young * thickness == pytest.approx(JOB["stretch"])
    assert young * thickness**3 / (12.0 * (1.0 - POISSON**2)) == pytest.approx(JOB["bending"])
    assert 'gridrange="0 0 0 4"' in text and "ipc" not in text
    assert '<flag ipc="enable"/>' in model_text(JOB | {"scene": "sphere"})


def test_it_is_said_that_mujoco_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []
    monkeypatch.setattr(mujoco_peer, "find_spec", lambda name: None)
    assert not mujoco_peer.has_mujoco(said.append, "sphere")
    assert said == [f"sphere: {mujoco_peer.HOW_TO_INSTALL}"]


@pytest.mark.skipif(find_spec("mujoco") is None, reason="MuJoCo is not installed: pip install 'toile[peers]'")
def test_a_sheet_falls_in_seconds_and_swings_in_metres() -> None:
    film = mujoco_peer.mujoco_film("sphere", 10, 0.1, 0.002)
    fallen = film.positions[0, :, 1] - film.positions[-1, :, 1]
    assert np.median(fallen) == pytest.approx(0.5 * GRAVITY * 0.1**2, rel=0.05)
    start = swing(10).positions
    end = at_nodes_of(start, mujoco_peer.mujoco_film("swing", 10, 0.5, 0.002))
    pinned = swing(10).pinned
    assert end[pinned] == pytest.approx(start[pinned], abs=1e-9)
    assert end[~pinned][:, 1].min() < -0.5
