"""Integrators: the order they promise, energy that never grows, momentum that is kept in free flight."""

from collections.abc import Iterator

import numpy as np

from toile.dress.benchmarks.free_flight import spin, thrown
from toile.dress.benchmarks.oscillators import EXACT, measured_order
from toile.dress.benchmarks.swing import swing
from toile.dress.benchmarks.validation_row import ValidationRow, absolute_row, relative_row
from toile.engine.integrators.advance import advance
from toile.engine.integrators.backward_euler import BackwardEuler
from toile.engine.integrators.baraff_witkin import BaraffWitkin
from toile.engine.integrators.bdf2 import Bdf2
from toile.engine.integrators.explicit_euler import ExplicitEuler
from toile.engine.integrators.motion import Integrator, Motion
from toile.engine.integrators.symplectic_euler import SymplecticEuler
from toile.engine.integrators.tr_bdf2 import TrBdf2
from toile.engine.triangle_dynamics import triangle_dynamics

SECOND_ORDER: tuple[Integrator, ...] = (Bdf2(newton=EXACT), TrBdf2(newton=EXACT))
IMPLICIT: tuple[Integrator, ...] = (
    BaraffWitkin(cg_tolerance=1e-12), BackwardEuler(newton=EXACT), *SECOND_ORDER,
)  # fmt: skip
EXPLICIT: tuple[Integrator, ...] = (ExplicitEuler(), SymplecticEuler())
ORDER_BAR = 0.1
ENERGY_BAR = 1e-6
"""Of some 0.5 J that the swinging sheet has [J]."""
MOMENTUM_BAR = 1e-9
"""[kg m/s]"""
SPIN_BAR = 1e-8
"""Percent in 0.01 s."""


def energy_growth(integrator: Integrator) -> float:
    """Return the largest rise of the energy above its last height in a second of a swinging sheet [J]."""
    cloth = swing(8)
    dynamics = triangle_dynamics(cloth)
    motion = Motion(cloth.positions, cloth.velocities)
    before, rise = dynamics.total_energy(motion.positions, motion.velocities), 0.0
    for _ in range(60):
        motion = integrator.step(dynamics, motion, 1.0 / 60.0).motion
        energy = dynamics.total_energy(motion.positions, motion.velocities)
        rise, before = max(rise, energy - before), max(before, energy)
    return rise


def momentum_change(integrator: Integrator, model: str) -> float:
    """Return by how much the momentum of a sheet in free flight changes in 20 steps [kg m/s]."""
    dynamics, motion = thrown(model)
    before = dynamics.mass @ motion.velocities
    h = 1e-5 if integrator in EXPLICIT else 5e-3
    motion = advance(integrator, dynamics, motion, 20 * h, h).motion
    return float(np.linalg.norm(dynamics.mass @ motion.velocities - before))


def validate_orders() -> Iterator[ValidationRow]:
    """Measure every integrator."""
    for integrator in (*EXPLICIT, *IMPLICIT):
        name = type(integrator).__name__
        expected = 2.0 if integrator in SECOND_ORDER else 1.0
        yield absolute_row("orders", name, "order", measured_order(integrator), expected, ORDER_BAR)
        for model in ("triangles", "springs"):
            yield absolute_row(
                "orders", f"{name}, {model}", "momentum change, kg m/s", momentum_change(integrator, model),
                0.0, MOMENTUM_BAR,
            )  # fmt: skip
    for integrator in IMPLICIT:
        yield absolute_row(
            "orders",
            type(integrator).__name__,
            "energy growth, J",
            energy_growth(integrator),
            0.0,
            ENERGY_BAR,
        )
    # Of the others only symplectic Euler keeps it: implicit steps turn less than the sheet does.
    dynamics, start = thrown("triangles")
    end = advance(SymplecticEuler(), dynamics, start, 0.01, 1e-5).motion
    yield relative_row(
        "orders", "SymplecticEuler", "angular momentum, kg m^2/s", spin(dynamics, end), spin(dynamics, start),
        SPIN_BAR,
    )  # fmt: skip
