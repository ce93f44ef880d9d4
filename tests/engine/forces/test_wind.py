"""Wind: derivatives, no force where air and cloth move together, terminal velocity of a falling sheet."""

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.forces.moving_step import MovingStep
from tests.engine.step.test_only_what_is_asked import GRAVITY, SLACK, options, sheet
from toile.engine.forces.air_flow import AirFlow
from toile.engine.forces.step_request import StepRequest
from toile.engine.forces.wind import Wind
from toile.engine.step.cloth_forces import cloth_stepper
from toile.engine.step.state import Instant
from toile.geometry.arrays import Float
from toile.geometry.stage_clock import StageClock

AIR = AirFlow(velocity=(3.0, -1.0, 2.0), resistance=6.0)
RUBBING = replace(AIR, friction=2.5)
STEP = StepRequest(h=0.01, at_rest=False)


def blown(wind: Wind, x: Float, velocity: Float) -> Float:
    """Minus the force on cloth at x with that velocity [N], shape (n, 3)."""
    assert wind.begin(Instant(STEP, velocity, x), x)
    gradient = np.zeros_like(x)
    wind.add_gradient(x, gradient)
    return gradient


def crumpled_wind(seed: int, air: AirFlow = AIR) -> tuple[Wind, Float, np.random.Generator]:
    cloth = sheet(SLACK)
    generator = np.random.default_rng(seed)
    wind = Wind(cloth.face_nodes, len(cloth.positions), air)
    return wind, cloth.positions + 0.05 * generator.normal(size=cloth.positions.shape), generator


@pytest.mark.parametrize("air", [AIR, RUBBING])
@pytest.mark.parametrize("seed", range(3))
def test_gradient_and_drag_are_derivatives_of_the_potential(seed: int, air: AirFlow) -> None:
    wind, start, generator = crumpled_wind(seed, air)
    h, step = STEP.h, 1e-4
    assert wind.begin(MovingStep(STEP, start), start)
    x = start + h * generator.normal(size=start.shape)
    way = generator.normal(size=x.shape)
    ahead, behind = x + step * way, x - step * way
    slope = (wind.energy(ahead) - wind.energy(behind)) / (2.0 * step)
    here, there, back = np.zeros((3, *x.shape))
    for place, gradient in ((x, here), (ahead, there), (behind, back)):
        wind.add_gradient(place, gradient)
    assert slope == pytest.approx(float(np.vdot(here, way)), rel=1e-7)
    change = (there - back) / (2.0 * step)
    assert change == pytest.approx(np.einsum("nij,nj->ni", wind.drag / h, way), rel=1e-6, abs=1e-9)
    assert np.linalg.eigvalsh(wind.drag).min() > -1e-12


def test_cloth_that_moves_with_the_air_feels_nothing() -> None:
    wind, x, _ = crumpled_wind(0)
    assert not blown(wind, x, np.tile(AIR.velocity, (len(x), 1))).any()


def test_force_on_a_flat_sheet_is_pressure_times_area() -> None:
    """The sheet lies in the plane z = 0: only the wind along z presses, on 1 m^2."""
    cloth = sheet(SLACK)
    wind = Wind(cloth.face_nodes, len(cloth.positions), AIR)
    force = -blown(wind, cloth.positions, np.zeros_like(cloth.positions)).sum(axis=0)
    assert force == pytest.approx([0.0, 0.0, AIR.resistance * AIR.velocity[2]])


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 2.0])
def test_drag_and_lift_of_a_flat_sheet_are_those_of_its_angle(angle: float) -> None:
    """A square metre whose normal is turned away from the flow by an angle."""
    cloth = sheet(SLACK)
    across, along = 6.0, 2.5
    air = AirFlow(velocity=(0.0, 0.0, 4.0), resistance=across, friction=along)
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    wind = Wind(cloth.face_nodes, len(cloth.positions), air)
    turned = np.ascontiguousarray(cloth.positions @ turn.T)
    lift, none, drag = -blown(wind, turned, np.zeros_like(turned)).sum(axis=0)
    assert drag == pytest.approx(4.0 * (along + (across - along) * cosine**2))
    assert lift == pytest.approx(4.0 * (across - along) * cosine * sine, abs=1e-12)
    assert none == pytest.approx(0.0, abs=1e-12)


def test_a_level_sheet_falls_at_its_terminal_velocity() -> None:
    """Weight 0.1 g per area = k v; the implicit step keeps that speed exactly, whatever its size."""
    cloth = sheet(SLACK)
    level = np.ascontiguousarray(cloth.positions[:, [0, 2, 1]])
    cloth = replace(cloth, positions=level, start_positions=level)
    air = AirFlow(velocity=(0.0, 0.0, 0.0), resistance=6.0)
    stepper = cloth_stepper(cloth, None, replace(options(), air=air), StageClock())
    for _ in range(40):
        stepper.step(StepRequest(h=0.02, at_rest=False, cg_tolerance=1e-10))
    terminal = SLACK.areal_density * GRAVITY / air.resistance
    assert stepper.v == pytest.approx(np.tile([0.0, -terminal, 0.0], (len(level), 1)), abs=1e-9)
