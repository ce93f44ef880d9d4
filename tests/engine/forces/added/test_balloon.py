"""Pressure and gas in a ball of cloth against Laplace's law."""

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.forces.added.shapes import SOFT, ball, tube
from tests.engine.forces.force_cases import shaken
from tests.engine.step.test_only_what_is_asked import options
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fields.fields import Fields
from toile.engine.cloth.fields.gas import ATMOSPHERE, Gas
from toile.engine.forces.added.enclosed_gas import EnclosedGas
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.step_request import StepRequest
from toile.engine.solve.hessian import Hessian
from toile.engine.step.cloth_forces import cloth_stepper
from toile.engine.step.step import ClothStepper
from toile.geometry.stage_clock import StageClock

RADIUS, PRESSURE = 0.15, 900.0


def settled(cloth: Cloth) -> ClothStepper:
    """Without weight, in a vacuum otherwise."""
    stepper = cloth_stepper(cloth, None, replace(options(), gravity=0.0), StageClock())
    for h in [0.002] * 10 + [0.02] * 60:
        stepper.step(StepRequest(h=h, at_rest=True, cg_tolerance=1e-4))
    return stepper


def laplace(stepper: ClothStepper) -> float:
    """Return twice the tension over the radius [Pa]: k (s - 1)/s where the ball is s times as large."""
    radius = float(np.linalg.norm(stepper.x - stepper.x.mean(axis=0), axis=1).mean())
    stretch = radius / RADIUS
    return 2.0 * SOFT.stretch_warp * (stretch - 1.0) / stretch / radius


@pytest.mark.parametrize("subdivisions", [2, 3])
def test_pressure_on_faces(subdivisions: int) -> None:
    cloth = ball(RADIUS, subdivisions=subdivisions)
    fields = Fields(region=np.zeros(len(cloth.faces), np.int32), values=({"pressure": PRESSURE},))
    stepper = settled(replace(cloth, fields=fields))
    assert laplace(stepper) == pytest.approx(PRESSURE, rel=0.03)


@pytest.mark.parametrize("edge", [0.03, 0.015])
def test_pressure_in_a_sleeve_that_is_open_at_both_ends(edge: float) -> None:
    """Its threads around bear p R per length."""
    girth = 0.48
    cloth = tube(girth, 0.24, edge, girth / (2.0 * np.pi))
    x = cloth.positions[cloth.face_nodes]
    outwards = np.einsum(
        "ti,ti->t", np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), x.mean(axis=1) * [1, 0, 1]
    )
    inside_out = float(np.sign(outwards[0]))
    everywhere = np.zeros(len(cloth.faces), np.int32)
    fields = Fields(region=everywhere, values=({"pressure": inside_out * PRESSURE},))
    stepper = settled(replace(cloth, fields=fields))
    radius = np.linalg.norm(stepper.x[:, [0, 2]], axis=1)
    assert np.ptp(radius) < 0.01 * radius.mean()
    membrane = stepper.force(Membrane)
    assert membrane is not None
    strain = membrane.warp_weft_strain(stepper.x)[:, 0].mean()
    assert strain > 0.1
    assert SOFT.stretch_warp * strain == pytest.approx(PRESSURE * radius.mean(), rel=0.03)


def test_gas_of_constant_pressure() -> None:
    stepper = settled(replace(ball(RADIUS), gas=(Gas(garment=0, pressure=PRESSURE),)))
    assert laplace(stepper) == pytest.approx(PRESSURE, rel=0.03)


@pytest.mark.parametrize("subdivisions", [1, 3])
def test_an_amount_of_gas_has_the_pressure_of_its_volume(subdivisions: int) -> None:
    """With few nodes, and with so many that the preconditioner has two levels."""
    cloth = ball(RADIUS, subdivisions=subdivisions)
    free = 1.25 * 4.0 / 3.0 * np.pi * RADIUS**3
    stepper = settled(replace(cloth, gas=(Gas(garment=0, volume=free),)))
    gas = stepper.force(EnclosedGas)
    assert gas is not None
    inside = gas.volume(stepper.x)
    assert gas.overpressure(stepper.x) == pytest.approx(ATMOSPHERE * (free / inside - 1.0), rel=1e-12)
    if subdivisions == 3:
        assert laplace(stepper) == pytest.approx(gas.overpressure(stepper.x), rel=0.03)
    away = np.zeros_like(stepper.x)
    for force in stepper.forces:
        force.add_gradient(stepper.x, away)
    each = gas.overpressure(stepper.x) * 4.0 * np.pi * RADIUS**2 / len(away)
    assert np.abs(away).max() < 0.02 * each


def test_what_holds_the_volume_is_all_of_the_hessian_without_overpressure() -> None:
    cloth = ball(0.1, subdivisions=1)
    x = shaken(cloth.positions, 0.003)
    (force,) = EnclosedGas.all_of(replace(cloth, gas=(Gas(garment=0, volume=1e-3),)))
    force = EnclosedGas(Gas(garment=0, volume=force.volume(x)), cloth.face_nodes)
    hessian = Hessian(len(x), [])
    force.linearise(x, np.zeros_like(x), hessian)
    reach, rows = 1e-6, []
    for entry in range(x.size):
        way = np.zeros(x.size)
        way[entry] = reach
        there, back = np.zeros_like(x), np.zeros_like(x)
        force.add_gradient(x + way.reshape(-1, 3), there)
        force.add_gradient(x - way.reshape(-1, 3), back)
        rows.append((there - back).ravel() / (2.0 * reach))
    expected = np.array(rows)
    assert np.abs(hessian.to_dense() - expected).max() < 1e-6 * np.abs(expected).max()


def test_a_gas_seeks_its_own_volume_and_has_its_energy_from_its_pressure() -> None:
    gas, free = Gas(garment=0, volume=0.01), 0.01
    assert gas.overpressure(free, 0.0) == 0.0
    assert gas.energy(free, 0.0) == pytest.approx(0.0, abs=1e-12)
    slope = (gas.energy(0.0081, 0.0) - gas.energy(0.0079, 0.0)) / 2e-4
    assert slope == pytest.approx(-gas.overpressure(0.008, 0.0), rel=1e-3)
    fall = (gas.overpressure(0.0081, 0.0) - gas.overpressure(0.0079, 0.0)) / 2e-4
    assert fall == pytest.approx(-gas.stiffness(0.008, 0.0), rel=1e-3)
