"""Integrators: order, damping, stability, conservation, energy, on known systems and on cloth."""

import math
from itertools import pairwise

import numpy as np
import pytest

from toile.engine.forces.wind import AirFlow
from toile.engine.integrators.advance import ErrorControl, advance, advance_within
from toile.engine.integrators.backward_euler import BackwardEuler
from toile.engine.integrators.baraff_witkin import BaraffWitkin
from toile.engine.integrators.bdf2 import Bdf2
from toile.engine.integrators.explicit_euler import ExplicitEuler
from toile.engine.integrators.motion import Integrator, Motion
from toile.engine.integrators.newton import NewtonOptions
from toile.engine.integrators.symplectic_euler import SymplecticEuler
from toile.engine.integrators.tr_bdf2 import TrBdf2
from toile.engine.step.stages import GAMMA, bdf2_stage, tr_bdf2_stage
from toile.engine.triangle_dynamics import triangle_dynamics
from toile.studies.scenes.swing import rms_distance, swing
from toile.studies.validation.free_flight import spin, thrown
from toile.studies.validation.oscillators import (
    EXACT,
    loss_per_second,
    measured_order,
    oscillator,
    spring_pendulum,
)

IMPLICIT: list[Integrator] = [
    BaraffWitkin(cg_tolerance=1e-12),
    BackwardEuler(newton=EXACT),
    Bdf2(newton=EXACT),
    TrBdf2(newton=EXACT),
]
ALL: list[Integrator] = [ExplicitEuler(), SymplecticEuler(), *IMPLICIT]
SECOND_ORDER = (Bdf2, TrBdf2)
FINE = NewtonOptions(tolerance=1e-6, cg_tolerance=1e-8)


def named(integrator: object) -> str:
    return type(integrator).__name__


@pytest.mark.parametrize("integrator", ALL, ids=named)
def test_order_on_a_pendulum(integrator: Integrator) -> None:
    expected = 2.0 if isinstance(integrator, SECOND_ORDER) else 1.0
    assert measured_order(integrator) == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize(
    ("integrator", "loss", "within"),
    [
        (BackwardEuler(newton=EXACT), 0.48, 0.005),
        (BaraffWitkin(cg_tolerance=1e-12), 0.48, 0.005),
        (TrBdf2(newton=EXACT), 5e-5, 1e-5),
        (Bdf2(newton=EXACT), 0.0035, 0.0002),
        (SymplecticEuler(), 0.0, 1e-3),
        (ExplicitEuler(), 1.0 - 1.93, 0.02),
    ],
    ids=lambda value: named(value) if not isinstance(value, float) else "",
)
def test_energy_lost_by_a_swing_of_1_hz(integrator: Integrator, loss: float, within: float) -> None:
    assert loss_per_second(integrator) == pytest.approx(loss, abs=within)


def test_backward_euler_loses_what_its_formula_says() -> None:
    h = 1.0 / 60.0
    factor = 1.0 / (1.0 + (2.0 * math.pi * h) ** 2)
    assert loss_per_second(BackwardEuler(newton=EXACT)) == pytest.approx(1.0 - factor**60, rel=1e-6)


@pytest.mark.parametrize("integrator", IMPLICIT, ids=named)
def test_implicit_steps_longer_than_a_period_do_not_explode(integrator: Integrator) -> None:
    dynamics, motion = oscillator(hertz=100.0)
    start = dynamics.total_energy(motion.positions, motion.velocities)
    motion = advance(integrator, dynamics, motion, 1.0, 0.1).motion
    assert dynamics.total_energy(motion.positions, motion.velocities) < start


@pytest.mark.parametrize(("factor", "stable"), [(0.98, True), (1.02, False)])
def test_symplectic_euler_is_stable_up_to_two_over_omega(factor: float, stable: bool) -> None:
    dynamics, motion = oscillator()
    h = factor / math.pi
    for _ in range(200):
        motion = SymplecticEuler().step(dynamics, motion, h).motion
    assert (np.abs(motion.positions).max() < 20.0) == stable


def test_steps_of_bdf2_may_change_their_size() -> None:
    """Sizes alternate by a factor of 1.5; the error still falls with the square."""
    errors = []
    for count in (40, 80, 160):
        dynamics, motion = oscillator()
        sizes = np.tile([1.0, 1.5], count)
        for h in 0.7 * sizes / sizes.sum():
            motion = Bdf2(newton=EXACT).step(dynamics, motion, float(h)).motion
        errors.append(abs(motion.positions[1, 0] - math.cos(1.4 * math.pi)))
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
@pytest.mark.parametrize("integrator", ALL, ids=named)
def test_linear_momentum_is_kept_in_free_flight(integrator: Integrator, model: str) -> None:
    dynamics, motion = thrown(model)
    before = dynamics.mass @ motion.velocities
    h = 1e-5 if isinstance(integrator, ExplicitEuler | SymplecticEuler) else 5e-3
    motion = advance(integrator, dynamics, motion, 20 * h, h).motion
    assert dynamics.mass @ motion.velocities == pytest.approx(before, abs=1e-9)


def test_symplectic_euler_keeps_angular_momentum_and_second_order_loses_little() -> None:
    dynamics, start = thrown("triangles")
    before = spin(dynamics, start)
    after = spin(dynamics, advance(SymplecticEuler(), dynamics, start, 0.01, 1e-5).motion)
    assert after == pytest.approx(before, rel=1e-10)
    flat = swing(6).positions
    start = Motion(flat, np.cross([0.5, 1.0, -2.0], flat - flat.mean(axis=0)))
    before, lost = spin(dynamics, start), {}
    for integrator in (BackwardEuler(newton=FINE), Bdf2(newton=FINE), TrBdf2(newton=FINE)):
        after = spin(dynamics, advance(integrator, dynamics, start, 0.25, 5e-3).motion)
        lost[named(integrator)] = abs(1.0 - after / before)
    assert lost["Bdf2"] < 0.2 * lost["BackwardEuler"]
    assert lost["TrBdf2"] < 0.1 * lost["BackwardEuler"]


@pytest.mark.parametrize("integrator", IMPLICIT, ids=named)
def test_energy_of_a_swinging_sheet_never_grows(integrator: Integrator) -> None:
    """A closed system of 0.5 J: weight, elasticity, pins. Steps of 1/60 s."""
    cloth = swing(8)
    dynamics = triangle_dynamics(cloth)
    motion = Motion(cloth.positions, cloth.velocities)
    highest = dynamics.total_energy(motion.positions, motion.velocities)
    for _ in range(60):
        motion = integrator.step(dynamics, motion, 1.0 / 60.0).motion
        energy = dynamics.total_energy(motion.positions, motion.velocities)
        assert energy < highest + 1e-6
        highest = max(highest, energy)
    assert not (motion.positions - cloth.positions)[cloth.pinned].any()


@pytest.mark.parametrize("integrator", [Bdf2(newton=FINE), TrBdf2(newton=FINE)], ids=named)
def test_order_on_a_swinging_sheet(integrator: Integrator) -> None:
    """Damped, in still air and gently: undamped waves of the membrane are below the step size."""
    cloth = swing(4)
    air = AirFlow(velocity=(0.0, 0.0, 0.0), resistance=1.0)
    ends = []
    for count in (32, 64, 128, 256):
        dynamics = triangle_dynamics(cloth, air=air, damping=0.01)
        start = Motion(cloth.positions, cloth.velocities)
        ends.append(advance(integrator, dynamics, start, 0.25, 0.25 / count).motion.positions)
    gaps = [rms_distance(a, b) for a, b in pairwise(ends)]
    assert np.log2(gaps[0] / gaps[-1]) / 2.0 == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("integrator", [Bdf2(newton=EXACT), TrBdf2(newton=EXACT)], ids=named)
def test_error_estimate_is_the_error_of_a_step(integrator: Integrator) -> None:
    """On the oscillator in steps of 1/200 s: x is known, one of the two nodes moves."""
    dynamics, motion = oscillator()
    h = 1.0 / 200.0
    before = None
    last_x, last_v = motion.positions, motion.velocities
    omega = 2.0 * math.pi
    for step in range(20):
        t = step * h
        exact_x = motion.positions.copy()
        exact_v = motion.velocities.copy()
        exact_x[1, 0], exact_v[1, 0] = math.cos(omega * t), -omega * math.sin(omega * t)
        if motion.before is not None:
            before = motion.before._replace(positions=last_x, velocities=last_v)
        acceleration = -(omega**2) * exact_x if step else None
        exact = Motion(exact_x, exact_v, t, acceleration, before)
        last_x, last_v = exact_x, exact_v
        done = integrator.step(dynamics, exact, h)
        motion = done.motion
    true = abs(motion.positions[1, 0] - math.cos(omega * (t + h))) / math.sqrt(2.0)
    assert done.error == pytest.approx(true, rel=0.15)


def test_step_sizes_follow_the_error() -> None:
    ends = []
    for rate in (1e-2, 1e-4):
        dynamics, start = spring_pendulum()
        control = ErrorControl(rate=rate, longest=0.1)
        done = advance_within(TrBdf2(newton=EXACT), dynamics, start, 0.5, control)
        assert done.motion.seconds == pytest.approx(0.5, abs=1e-12)
        assert not done.unsolved
        ends.append(done)
    assert ends[1].steps > 4 * ends[0].steps
    dynamics, start = spring_pendulum()
    fine = advance(TrBdf2(newton=EXACT), dynamics, start, 0.5, 1e-4).motion.positions
    assert rms_distance(ends[1].motion.positions, fine) < 1e-4
    assert control.newton.tolerance == pytest.approx(1e-3)


@pytest.mark.filterwarnings("ignore:(invalid|overflow) value:RuntimeWarning")
def test_explosion_is_said() -> None:
    dynamics, start = oscillator(hertz=1000.0)
    with pytest.raises(FloatingPointError, match="not finite"):
        advance(ExplicitEuler(), dynamics, start, 20.0, 0.02)
