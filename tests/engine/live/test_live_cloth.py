"""Cloth played with: a hand that cannot tear, pins, wind, obstacles, and never a crossing."""

import numpy as np
import pytest
import trimesh

from toile.dressing.garment.fabrics import fabric
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.forces.air_flow import AirFlow
from toile.engine.live.hand import SPEED
from toile.engine.live.live_cloth import STEP, LiveCloth
from toile.engine.live.obstacles import Surface
from toile.engine.step.options import StepOptions
from toile.geometry.errors import InputError
from toile.remesh.panel.grid import grid_mesh

CELLS, SIDE = 12, 0.5
MIDDLE = (CELLS + 1) ** 2 // 2
WEIGHTLESS = StepOptions(gravity=0.0)


def sheet(height: float = 0.0, pinned: bool = False) -> Cloth:
    grid = grid_mesh(SIDE, SIDE, CELLS, CELLS)
    x, z = grid.points.T - 0.5 * SIDE
    positions = np.column_stack([x, np.full(len(x), height), -z])
    return flat_cloth(grid.points, grid.faces, positions, fabric("cotton-poplin"), (x < -0.249) & pinned)


def ball(radius: float = 0.12) -> Surface:
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=radius)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces, dtype=np.int32)


def test_a_hand_takes_cloth_along_at_bounded_speed() -> None:
    live = LiveCloth(sheet(), {}, WEIGHTLESS)
    live.grip(MIDDLE)
    live.pull_to(np.array([0.0, 0.3, 0.0]))
    for _ in range(6):
        live.advance()
    assert 0.0 < live.frame.positions[MIDDLE, 1] <= SPEED * 6 * STEP
    for _ in range(90):
        live.advance()
    assert live.frame.positions[MIDDLE, 1] == pytest.approx(0.3, abs=0.01)
    live.release()
    speed = live.frame.velocities.copy()
    live.advance()
    assert np.abs(live.frame.velocities.mean(axis=0) - speed.mean(axis=0)).max() < 1e-2, (
        "nothing pulls any more"
    )


def test_a_hand_does_not_tear_cloth_that_is_held() -> None:
    live = LiveCloth(sheet(pinned=True), {}, WEIGHTLESS)
    live.grip(MIDDLE)
    live.pull_to(np.array([2.0, 0.0, 0.0]))
    most = max(live.advance().stretch for _ in range(120))
    assert most < 0.1
    assert live.frame.positions[MIDDLE, 0] < 0.05, "it stays where the pins let it"


def test_a_push_accelerates_as_newton_says() -> None:
    live = LiveCloth(sheet(), {}, WEIGHTLESS)
    mass = live.cloth.mass
    live.push.force[:] = mass[:, None] * [0.0, 0.0, 2.0]
    for _ in range(30):
        live.advance()
    assert live.frame.velocities[:, 2] == pytest.approx(2.0 * 30 * STEP, rel=1e-4)


def test_pins_hold_move_and_let_go() -> None:
    live = LiveCloth(sheet(), {}, StepOptions())
    corners = np.array([0, CELLS])
    live.pin(corners)
    place = live.frame.positions[corners].copy()
    for _ in range(10):
        live.advance()
    assert np.array_equal(live.frame.positions[corners], place)
    higher = place + np.array([0.0, 0.1, 0.0])
    live.move_pins(corners, higher)
    for _ in range(10):
        live.advance()
    assert live.frame.positions[corners] == pytest.approx(higher, abs=1e-6)
    live.unpin()
    for _ in range(10):
        live.advance()
    assert (live.frame.positions[corners, 1] < place[:, 1] + 0.1 - 1e-3).all()
    with pytest.raises(InputError, match="is not pinned"):
        live.move_pins(corners, place)
    with pytest.raises(InputError, match="there is no node"):
        live.pin(np.array([100000]))


def test_wind_fabric_and_gravity_change_as_it_goes() -> None:
    live = LiveCloth(sheet(pinned=True), {}, WEIGHTLESS)
    live.blow(AirFlow(velocity=(0.0, 3.0, 0.0), resistance=1.8))
    for _ in range(20):
        live.advance()
    risen = float(live.frame.positions[:, 1].mean())
    assert risen > 0.01
    live.blow(None)
    live.change_fabric(fabric("wool-coating"))
    assert live.cloth.mass.sum() == pytest.approx(0.481 * SIDE**2)
    assert np.array_equal(live.stepper.x, live.frame.positions), "the cloth stays where it is"
    live.change_options(gravity=9.81)
    for _ in range(40):
        live.advance()
    assert float(live.frame.positions[:, 1].mean()) < risen
    assert live.pinned.sum() == CELLS + 1


def test_nothing_crosses_while_it_is_dragged_over_a_ball_that_moves() -> None:
    live = LiveCloth(sheet(0.14), {"ball": ball()}, StepOptions())
    start = ball()[0]
    found = 0
    for k in range(90):
        live.move_obstacle("ball", start + np.array([0.1 * np.sin(0.1 * k), 0.0, 0.0]))
        if k == 30:
            live.grip(0)
        if live.hand.holds:
            live.pull_to(np.array([0.4, 0.2, 0.4]) * np.sin(0.12 * (k - 30)))
        live.advance()
        if k % 10 == 9:
            crossings = live.audit()
            found += len(crossings.avatar) + len(crossings.cloth)
    assert found == 0
    assert live.frame.stretch < 0.15


def test_an_obstacle_does_not_tear_cloth_that_is_held_and_may_go_back() -> None:
    cloth = sheet(0.13)
    live = LiveCloth(cloth, {"ball": ball()}, StepOptions())
    border = np.abs(cloth.positions[:, [0, 2]]).max(axis=1) > 0.249
    live.pin(np.flatnonzero(border).astype(np.int32))
    start = ball()[0]
    live.move_obstacle("ball", start + np.array([0.0, 0.5, 0.0]))
    assert max(live.advance().stretch for _ in range(60)) < 0.15
    assert live.surface is not None
    risen = float((live.surface.vertices - start)[:, 1].mean())
    assert 0.01 < risen < 0.3
    live.move_obstacle("ball", start)
    for _ in range(30):
        live.advance()
    assert live.surface.vertices == pytest.approx(start, abs=1e-3)


def test_obstacles_come_and_go_but_never_into_the_cloth() -> None:
    live = LiveCloth(sheet(0.0), {}, StepOptions())
    with pytest.raises(InputError, match="would cut the cloth"):
        live.put_obstacle("ball", ball())
    vertices, faces = ball()
    live.put_obstacle("ball", (vertices - [0.0, 0.15, 0.0], faces))
    for _ in range(60):
        live.advance()
    assert live.frame.positions[:, 1].max() > -0.05, "the ball carries it"
    live.put_obstacle("ball", None)
    for _ in range(30):
        live.advance()
    assert live.frame.positions[:, 1].max() < -0.05


def test_the_same_play_gives_the_same_bytes() -> None:
    def played() -> bytes:
        live = LiveCloth(sheet(0.13), {"ball": ball()}, StepOptions())
        for k in range(20):
            if k == 8:
                live.grip(MIDDLE)
                live.pull_to(np.array([0.1, 0.2, 0.0]))
            live.advance()
        return live.frame.positions.tobytes()

    assert played() == played()
