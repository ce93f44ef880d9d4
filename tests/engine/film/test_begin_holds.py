"""Cloth that a film holds for a time, and fields keyed over it."""

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.film.test_simulate import film, level_sheet
from tests.engine.step.test_only_what_is_asked import GRAVITY, options
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fields.fields import Fields, Value
from toile.engine.cloth.fields.keyed import Keyed
from toile.engine.cloth.fields.timed_pins import RunHold
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.film.begin_holds import at_start
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.film.plan import FilmPlan
from toile.engine.film.simulate import Simulation
from toile.remesh.sizing.sizing import SizingOptions

FPS = 24.0
HELD = 10
"""Frames."""


def plan(**more: object) -> FilmPlan:
    return FilmPlan(
        step=options(), integrator=tr_bdf2, frame_seconds=1.0 / FPS, longest_step=1.0 / 60.0,
        cg_tolerance=1e-6, newton=4, **more,  # type: ignore[arg-type]
    )  # fmt: skip


def hold(**more: object) -> RunHold:
    """Along x = 0 of the sheet, for the first frames."""
    line = np.array([[(0.0, 0.0, 0.0), (0.0, 0.3, 0.0)]])
    share = Keyed((0.0, (HELD - 1) / FPS, HELD / FPS), (1.0, 1.0, 0.0))
    given = {"lines": line, "share": share, "stiffness": 1e6, "follow": False, **more}
    return RunHold(garment=0, panel=0, **given)  # type: ignore[arg-type]


def sheet() -> Cloth:
    cloth = level_sheet(0.4, 0.3, 0.05, 0.0)
    return replace(cloth, uv=cloth.uv - cloth.uv.min(axis=0))


def test_it_is_held_for_ten_frames_and_falls_then() -> None:
    cloth = sheet()
    edge = cloth.uv[:, 0] < 1e-9
    _, frames = film(at_start(replace(cloth, holds=(hold(),)), None), 18 / FPS, plan())
    heights = np.array([frame.cloth.positions[edge, 1].mean() for frame in frames])
    away = [np.abs(frame.cloth.positions[edge] - cloth.positions[edge]).max() for frame in frames[:HELD]]
    assert max(away) < 1e-3
    seconds = 7 / FPS
    assert heights[HELD + 7] < heights[HELD] - 0.4 * 0.5 * GRAVITY * seconds**2


def test_it_goes_with_the_body_and_onto_other_meshes() -> None:
    """The body beside it moves by 0.2 m/s; the sheet is remeshed on the way."""
    cloth = sheet()
    body = cloth.positions[::3] - np.array([0.0, 0.01, 0.0])
    way = np.arange(13)[:, None, None] / FPS * np.array([0.2, 0.0, 0.0])
    motion = VertexMotion(frames=body + way, fps=FPS)
    held = at_start(replace(cloth, holds=(hold(follow=True),)), motion)
    sizing = SizingOptions(size_min=0.02, size_max=0.1, refine_angle=0.2)
    run, frames = film(held, 9 / FPS, plan(sizing=sizing, remesh_frames=2))
    assert run.record.remeshings
    after = frames[-1].cloth
    edge = after.uv[:, 0] < 1e-9
    assert after.positions[after.node[edge]][:, 0] == pytest.approx(
        cloth.positions[cloth.uv[:, 0] < 1e-9][0, 0] + 0.2 * 9 / FPS, abs=2e-3
    )
    (pins,) = after.timed_pins
    assert set(np.flatnonzero(pins.stiffness > 0.0)) == set(after.node[edge])


def test_a_whole_panel_is_held_softly() -> None:
    """It sinks by its weight over the stiffness, and springs back and forth about that."""
    cloth = sheet()
    always = Keyed((0.0,), (1.0,))
    whole = hold(lines=None, share=always, stiffness=200.0)
    _, frames = film(at_start(replace(cloth, holds=(whole,)), None), 60 / FPS, plan())
    sag = cloth.fabrics[0].areal_density * GRAVITY / 200.0
    heights = np.array([frame.cloth.positions[:, 1].mean() for frame in frames])
    assert heights.mean() - cloth.positions[:, 1].mean() == pytest.approx(-sag, rel=0.1)


def test_keyed_pressure_lifts_it_from_its_time_on() -> None:
    """Twice its weight from a quarter of a second on, in a film that has a lead-in of as long."""
    cloth = sheet()
    weight = cloth.fabrics[0].areal_density * GRAVITY
    normal = np.cross(*(cloth.positions[cloth.face_nodes][0, 1:] - cloth.positions[cloth.face_nodes][0, 0]))
    sign = np.sign(normal[1])
    keyed = Keyed((0.25, 0.2501), (sign * weight, 2.0 * sign * weight))
    fields = Fields(region=np.zeros(len(cloth.faces), np.int32), values=({"pressure": keyed},))
    motion = VertexMotion(frames=np.zeros((60, 4, 3)), fps=FPS, lead=6)
    begun = at_start(replace(cloth, fields=fields), motion)
    _, frames = film(begun, 24 / FPS, plan())
    heights = np.array([frame.cloth.positions[:, 1].mean() for frame in frames])
    heights -= heights[0]
    assert np.abs(heights[:13]).max() < 2e-3
    assert heights[24] == pytest.approx(0.5 * GRAVITY * 0.5**2, rel=0.05)


def test_cloth_without_any_of_it_begins_as_it_is() -> None:
    cloth = sheet()
    assert at_start(cloth, None) is cloth


def test_a_film_that_is_resumed_gives_the_same_cloth() -> None:
    """With pins that let go, a keyed rest shape and remeshing."""
    cloth = sheet()
    values: dict[str, Value] = {"rest_warp": Keyed((0.0, 0.4), (1.0, 0.8))}
    fields = Fields(region=np.zeros(len(cloth.faces), np.int32), values=(values,))
    begun = at_start(replace(cloth, holds=(hold(),), fields=fields), None)
    own = plan(sizing=SizingOptions(size_min=0.02, size_max=0.1, refine_angle=0.2), remesh_frames=2)
    whole, frames = film(begun, 12 / FPS, own)
    assert whole.record.remeshings
    first, _ = film(begun, 5 / FPS, own)
    second = Simulation(begun, None, own, lambda frame: True)
    second.go_on_from(first.state())
    second.run(7 / FPS)
    assert np.array_equal(second.cloth.positions, frames[-1].cloth.positions)
    assert np.array_equal(second.cloth.faces, frames[-1].cloth.faces)
