"""Integrators: order, damping, stability, conservation, energy, on known systems and on cloth."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from toile.engine.film.advance import StepCounts, Way, advance
from toile.engine.film.integrators.backward_euler import backward_euler
from toile.engine.film.integrators.bdf2 import bdf2
from toile.engine.film.integrators.explicit_euler import explicit_euler
from toile.engine.film.integrators.integrator import Ask, Integrator
from toile.engine.film.integrators.symplectic_euler import symplectic_euler
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.film.step_sizes import StepLimits, StepSizes
from toile.engine.forces.air_flow import AirFlow
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.memory import Memory
from toile.engine.step.options import StepOutcome
from toile.engine.step.stages import GAMMA, bdf2_stage, tr_bdf2_stage
from toile.engine.step.step import ClothStepper
from toile.studies.scenes.motion import (
    EXACT,
    Solving,
    carried_on,
    carried_within,
    free_stepper,
    total_energy,
)
from toile.studies.scenes.swing import rms_distance, swing
from toile.studies.validation.free_flight import momentum, spin, thrown
from toile.studies.validation.oscillators import (
    loss_per_second,
    measured_order,
    oscillator,
    spring_pendulum,
)

IMPLICIT: dict[str, tuple[Integrator, Solving]] = {
    "Baraff-Witkin": (backward_euler, replace(EXACT, iterations=1)),
    "backward Euler": (backward_euler, EXACT),
    "BDF2": (bdf2, EXACT),
    "TR-BDF2": (tr_bdf2, EXACT),
}
EXPLICIT: dict[str, tuple[Integrator, Solving]] = {
    "explicit Euler": (explicit_euler, EXACT),
    "symplectic Euler": (symplectic_euler, EXACT),
}
ALL = EXPLICIT | IMPLICIT
SECOND_ORDER = ("BDF2", "TR-BDF2")
FINE = Solving(tolerance=1e-6, cg_tolerance=1e-8)


def asked(length: float, share: float) -> StepRequest:
    """Ask for stages that are solved exactly, in a system that does not know the time."""
    return EXACT.request(length, 0.0)


@pytest.mark.parametrize("name", ALL)
def test_order_on_a_pendulum(name: str) -> None:
    expected = 2.0 if name in SECOND_ORDER else 1.0
    assert measured_order(*ALL[name]) == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize(
    ("name", "loss", "within"),
    [
        ("backward Euler", 0.48, 0.005),
        ("Baraff-Witkin", 0.48, 0.005),
        ("TR-BDF2", 5e-5, 1e-5),
        ("BDF2", 0.0035, 0.0002),
        ("symplectic Euler", 0.0, 1e-3),
        ("explicit Euler", 1.0 - 1.93, 0.02),
    ],
)
def test_energy_lost_by_a_swing_of_1_hz(name: str, loss: float, within: float) -> None:
    assert loss_per_second(*ALL[name]) == pytest.approx(loss, abs=within)


def test_backward_euler_loses_what_its_formula_says() -> None:
    h = 1.0 / 60.0
    factor = 1.0 / (1.0 + (2.0 * math.pi * h) ** 2)
    assert loss_per_second(backward_euler, EXACT) == pytest.approx(1.0 - factor**60, rel=1e-6)


@pytest.mark.parametrize("name", IMPLICIT)
def test_implicit_steps_longer_than_a_period_do_not_explode(name: str) -> None:
    stepper = oscillator(hertz=100.0)
    start = total_energy(stepper)
    carried_on(stepper, *IMPLICIT[name], 1.0, 0.1)
    assert total_energy(stepper) < start


@pytest.mark.parametrize(("factor", "stable"), [(0.98, True), (1.02, False)])
def test_symplectic_euler_is_stable_up_to_two_over_omega(factor: float, stable: bool) -> None:
    stepper = oscillator()
    h = factor / math.pi
    for _ in range(200):
        symplectic_euler(stepper, h, asked)
    assert (np.abs(stepper.x).max() < 20.0) == stable


def test_steps_of_bdf2_may_change_their_size() -> None:
    """Sizes alternate by a factor of 1.5; the error still falls with the square."""
    errors = []
    for count in (40, 80, 160):
        stepper = oscillator()
        sizes = np.tile([1.0, 1.5], count)
        for h in 0.7 * sizes / sizes.sum():
            bdf2(stepper, float(h), asked)
        errors.append(abs(stepper.x[1, 0] - math.cos(1.4 * math.pi)))
    assert np.log2(errors[0] / errors[2]) / 2.0 == pytest.approx(2.0, abs=0.1)


def test_stages_hit_quadratic_motion_exactly() -> None:
    """Second-order formulas are exact on x = t^2, whatever the step sizes."""
    at = {t: np.full((1, 3), t * t) for t in (0.7, 1.0, 1.0 + 0.4 * GAMMA, 1.4)}
    speed = {t: np.full((1, 3), 2.0 * t) for t in at}
    stage = bdf2_stage(at[1.0], speed[1.0], at[0.7], speed[0.7], 0.4, 0.3)
    assert stage.velocity_at(at[1.4]) == pytest.approx(speed[1.4])
    assert stage.acceleration_at(at[1.4]) == pytest.approx(np.full((1, 3), 2.0))
    middle = 1.0 + 0.4 * GAMMA
    stage = tr_bdf2_stage(at[1.0], speed[1.0], at[middle], speed[middle], 0.4)
    assert stage.velocity_at(at[1.4]) == pytest.approx(speed[1.4])
    assert stage.acceleration_at(at[1.4]) == pytest.approx(np.full((1, 3), 2.0))


@pytest.mark.parametrize("model", ["springs", "triangles"])
@pytest.mark.parametrize("name", ALL)
def test_linear_momentum_is_kept_in_free_flight(name: str, model: str) -> None:
    stepper = thrown(model)
    before = momentum(stepper)
    h = 1e-5 if name in EXPLICIT else 5e-3
    carried_on(stepper, *ALL[name], 20 * h, h)
    assert momentum(stepper) == pytest.approx(before, abs=1e-9)


def test_symplectic_euler_keeps_angular_momentum_and_second_order_loses_little() -> None:
    stepper = thrown("triangles")
    before = spin(stepper)
    carried_on(stepper, symplectic_euler, EXACT, 0.01, 1e-5)
    assert spin(stepper) == pytest.approx(before, rel=1e-10)
    flat = swing(6).positions
    turning = np.cross([0.5, 1.0, -2.0], flat - flat.mean(axis=0))
    lost = {}
    for integrator in (backward_euler, bdf2, tr_bdf2):
        stepper = thrown("triangles")
        stepper.put(flat, turning)
        before = spin(stepper)
        carried_on(stepper, integrator, FINE, 0.25, 5e-3)
        lost[integrator] = abs(1.0 - spin(stepper) / before)
    assert lost[bdf2] < 0.2 * lost[backward_euler]
    assert lost[tr_bdf2] < 0.1 * lost[backward_euler]


@pytest.mark.parametrize("name", IMPLICIT)
def test_energy_of_a_swinging_sheet_never_grows(name: str) -> None:
    """A closed system of 0.5 J: weight, elasticity, pins. Steps of 1/60 s."""
    cloth = swing(8)
    stepper = free_stepper(cloth)
    highest = total_energy(stepper)
    for step in range(60):
        carried_on(stepper, *IMPLICIT[name], 1.0 / 60.0, 1.0 / 60.0, since=step / 60.0)
        energy = total_energy(stepper)
        assert energy < highest + 1e-6
        highest = max(highest, energy)
    assert not (stepper.x - cloth.positions)[cloth.pinned].any()


@pytest.mark.parametrize("integrator", [bdf2, tr_bdf2])
def test_order_on_a_swinging_sheet(integrator: Integrator) -> None:
    """Damped, in still air and gently: undamped waves of the membrane are below the step size."""
    cloth = swing(4)
    cloth = replace(cloth, fabrics=tuple(replace(fabric, damping=0.01) for fabric in cloth.fabrics))
    air = AirFlow(velocity=(0.0, 0.0, 0.0), resistance=1.0)
    ends = []
    for count in (32, 64, 128, 256):
        stepper = free_stepper(cloth, air=air)
        carried_on(stepper, integrator, FINE, 0.25, 0.25 / count)
        ends.append(stepper.x)
    gaps = [rms_distance(a, b) for a, b in pairwise(ends)]
    assert np.log2(gaps[0] / gaps[-1]) / 2.0 == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("integrator", [bdf2, tr_bdf2])
def test_error_estimate_is_the_error_of_a_step(integrator: Integrator) -> None:
    """On the oscillator in steps of 1/200 s: x is known, one of the two nodes moves."""
    stepper = oscillator()
    h = 1.0 / 200.0
    before = None
    last_x, last_v = stepper.x.copy(), stepper.v
    omega = 2.0 * math.pi
    for step in range(20):
        t = step * h
        exact_x = stepper.x.copy()
        exact_v = stepper.v.copy()
        exact_x[1, 0], exact_v[1, 0] = math.cos(omega * t), -omega * math.sin(omega * t)
        if stepper.memory is not None and stepper.memory.before is not None:
            before = stepper.memory.before._replace(positions=last_x, velocities=last_v)
        known = Memory(-(omega**2) * exact_x, np.zeros(2, bool), before) if step else None
        stepper.put(exact_x, exact_v, known)
        last_x, last_v = exact_x, exact_v
        done = integrator(stepper, h, asked)
    true = abs(stepper.x[1, 0] - math.cos(omega * (t + h))) / math.sqrt(2.0)
    assert done.error == pytest.approx(true, rel=0.15)


def test_step_sizes_follow_the_error() -> None:
    ends, counts = [], []
    for rate in (1e-2, 1e-4):
        stepper, done = spring_pendulum(), StepCounts()
        limits = StepLimits(longest=0.1, shortest=1e-5, error_rate=rate)
        way = Way(integrator=tr_bdf2, ask=EXACT.request)
        for _ in advance(stepper, way, StepSizes(limits, 1e-3), (0.0, 0.5), done):
            pass
        assert done.simulated_seconds == pytest.approx(0.5, abs=1e-12)
        assert not done.forced
        ends.append(stepper.x)
        counts.append(done.steps)
    assert counts[1] > 4 * counts[0]
    fine = spring_pendulum()
    carried_on(fine, tr_bdf2, EXACT, 0.5, 1e-4)
    assert rms_distance(ends[1], fine.x) < 1e-4


def test_stages_are_solved_as_exactly_as_their_estimates_need() -> None:
    """For an error of 0.1 mm/s to 1 mm/s, over half the length of a stage."""
    tolerances = []

    def noted(stepper: ClothStepper, h: float, ask: Ask) -> StepOutcome:
        tolerances.append(ask(h, 1.0).newton_tolerance / h)
        return tr_bdf2(stepper, h, ask)

    carried_within(spring_pendulum(), noted, 0.05, 1e-4)
    assert tolerances == pytest.approx(len(tolerances) * [0.5e-3])


@pytest.mark.filterwarnings("ignore:(invalid value|overflow) encountered:RuntimeWarning")
def test_explosion_is_said() -> None:
    with pytest.raises(FloatingPointError, match="not finite"):
        carried_on(oscillator(hertz=1000.0), explicit_euler, EXACT, 20.0, 0.02)
