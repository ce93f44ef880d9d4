"""Integrators: the order they promise, energy that never grows, momentum that is kept in free flight."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from math import inf

import numpy as np

from toile.engine.film.simulate import Simulation
from toile.engine.film.time_steps import FilmIntegrator, backward_euler, tr_bdf2
from toile.engine.integrators.advance import advance
from toile.engine.integrators.backward_euler import BackwardEuler
from toile.engine.integrators.baraff_witkin import BaraffWitkin
from toile.engine.integrators.bdf2 import Bdf2
from toile.engine.integrators.explicit_euler import ExplicitEuler
from toile.engine.integrators.motion import Integrator, Motion
from toile.engine.integrators.symplectic_euler import SymplecticEuler
from toile.engine.integrators.tr_bdf2 import TrBdf2
from toile.engine.triangle_dynamics import triangle_dynamics
from toile.geometry.arrays import Float
from toile.studies.scenes.scenes import film_plan
from toile.studies.scenes.swing import swing
from toile.studies.validation.free_flight import spin, thrown
from toile.studies.validation.oscillators import EXACT, measured_order
from toile.studies.validation.validation_row import ValidationRow, absolute_row, relative_row

SECOND_ORDER: tuple[Integrator, ...] = (Bdf2(newton=EXACT), TrBdf2(newton=EXACT))
IMPLICIT: tuple[Integrator, ...] = (
    BaraffWitkin(cg_tolerance=1e-12), BackwardEuler(newton=EXACT), *SECOND_ORDER,
)  # fmt: skip
EXPLICIT: tuple[Integrator, ...] = (ExplicitEuler(), SymplecticEuler())
FILMS: tuple[tuple[FilmIntegrator, float], ...] = ((backward_euler, 1.0), (tr_bdf2, 2.0))
"""Integrators of films, and their orders."""
FILM_SECONDS, FILM_STEPS = 0.1, (160, 320, 640, 1280)
"""Length of the film whose order is measured [s], and its numbers of steps."""
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


def film_order(integrator: FilmIntegrator) -> float:
    """Return the slope of a swinging sheet's error over the step size of a film, its steps solved exactly."""
    ends: list[Float] = []
    for count in FILM_STEPS:
        usual = film_plan()
        h = FILM_SECONDS / count
        plan = replace(
            usual, step=replace(usual.step, self_contact=False), integrator=integrator,
            frame_seconds=FILM_SECONDS, longest_step=h, shortest_step=h, stretch_rise=inf, motion_max=inf,
            newton=20, newton_tolerance=1e-12, cg_tolerance=1e-12,
        )  # fmt: skip
        film = Simulation(swing(4), None, plan, lambda _: True)
        film.run(FILM_SECONDS)
        ends.append(film.stepper.x)
    gaps = [float(np.linalg.norm(b - a)) for a, b in pairwise(ends)]
    return float(-np.polyfit(np.arange(len(gaps)), np.log2(gaps), 1)[0])


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
    for film, expected in FILMS:
        variant = f"film, {film.__name__}"
        yield absolute_row("orders", variant, "order", film_order(film), expected, ORDER_BAR)
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
