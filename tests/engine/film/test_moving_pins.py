"""Pins that move: cloth follows them, through remeshing and merging, and jumps are told."""

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.film.test_simulate import level_sheet
from tests.engine.step.test_only_what_is_asked import options
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.film.plan import FilmFrame, FilmPlan
from toile.engine.film.simulate import Simulation
from toile.geometry.arrays import Float
from toile.remesh.sizing.sizing import SizingOptions

FPS = 30.0


def held_sheet() -> Cloth:
    """A level sheet held along one side."""
    cloth = level_sheet(0.4, 0.3, 0.05, 0.0)
    return replace(cloth, pinned=cloth.positions[:, 0] < -0.2 + 1e-9)


def turned(points: Float, angles: Float) -> Float:
    """Turn points, shape (p, 3), about the x axis: shape (k, p, 3)."""
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    y, z = points[:, 1], points[:, 2]
    return np.stack((np.broadcast_to(points[:, 0], (len(c), len(y))), c * y - s * z, s * y + c * z), axis=2)


def plan(newton: int = 4, sizing: SizingOptions | None = None) -> FilmPlan:
    step = replace(options(self_contact=True), gravity=0.0)
    return FilmPlan(step=step, frame_seconds=1.0 / FPS, newton=newton, sizing=sizing, remesh_frames=2)


@pytest.mark.parametrize("newton", [1, 4])
def test_pins_are_where_they_shall_be_and_the_cloth_comes_along(newton: int) -> None:
    cloth = held_sheet()
    start = cloth.positions[cloth.pinned]
    frames = start[None] + np.linspace(0.0, 0.5, 11)[:, None, None] * np.array([-1.0, 0.5, 0.0])
    places: list[Float] = []

    def keep(frame: FilmFrame) -> bool:
        places.append(frame.cloth.positions)
        return True

    motion = VertexMotion(frames=frames, fps=FPS)
    run = Simulation(cloth.led(), None, plan(newton), keep, pin_motion=motion)
    record = run.run(10.0 / FPS)
    assert not record.failure and max(record.lag) < 1e-12
    for place, expected in zip(places, frames, strict=True):
        assert np.allclose(place[cloth.pinned], expected, rtol=0.0, atol=1e-12)
    away = places[-1].mean(axis=0) - cloth.positions.mean(axis=0)
    assert np.linalg.norm(away) > 0.3
    assert max(record.stretch_max) < 0.05


def test_handles_lead_pins_on_every_new_mesh() -> None:
    """Pins turn about their row by a whole turn while the sheet rolls and is meshed anew."""
    cloth = held_sheet().led()
    start = cloth.positions[cloth.pinned]
    motion = VertexMotion(frames=turned(start, np.linspace(0.0, 2.0 * np.pi, 31)), fps=FPS)
    sizing = SizingOptions(size_min=0.02, size_max=0.4, refine_angle=0.2)
    run = Simulation(cloth, None, plan(sizing=sizing), lambda _: True, pin_motion=motion)
    record = run.run(20.0 / FPS)
    after = run.cloth
    assert record.remeshings and after.handles is not None
    rows = np.asarray(after.handles.sum(axis=1)).ravel()
    assert np.allclose(rows[after.pinned], 1.0) and not rows[~after.pinned].any()
    expected = turned(start, np.array([2.0 * np.pi * 20.0 / 30.0]))[0]
    assert np.allclose(after.positions[after.pinned], (after.handles @ expected)[after.pinned], atol=1e-12)
    assert not any(map(sum, record.crossings))


def test_a_pin_that_is_sewn_on_leads_the_seam() -> None:
    cloth = held_sheet().led()
    pins, free = np.flatnonzero(cloth.pinned), np.flatnonzero(~cloth.pinned)
    stitches = np.column_stack((free[:2], pins[:2])).astype(np.int32)
    sewn = replace(cloth, stitches=stitches, seam=np.zeros(2, np.int32), stitch_length=np.zeros(2))
    merged = sewn.merged(np.ones(2, bool))
    assert merged.handles is not None and merged.handles.shape == (len(merged.positions), len(pins))
    assert merged.pinned.sum() == len(pins)
    points = np.random.default_rng(3).normal(size=(len(pins), 3))
    led = {tuple(row) for row in (merged.handles @ points)[merged.pinned]}
    assert led == {tuple(row) for row in points}


def test_pins_that_jump_end_the_film() -> None:
    cloth = held_sheet()
    frames = np.repeat(cloth.positions[cloth.pinned][None], 6, axis=0)
    frames[4:, 3] += 5.0
    run = Simulation(
        cloth.led(), None, plan(), lambda _: True, pin_motion=VertexMotion(frames=frames, fps=FPS)
    )
    record = run.run(5.0 / FPS)
    assert "pins jump after frame 3" in record.failure and "handle 3" in record.failure
    assert len(record.crossings) == 4
