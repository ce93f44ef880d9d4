"""Integrators: order of convergence, energy that never grows, momentum conserved in free flight."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from math import inf
from typing import NamedTuple

import numpy as np

from toile.engine.film.integrators.backward_euler import backward_euler
from toile.engine.film.integrators.baraff_witkin import baraff_witkin
from toile.engine.film.integrators.bdf2 import bdf2
from toile.engine.film.integrators.explicit_euler import explicit_euler
from toile.engine.film.integrators.integrator import Integrator
from toile.engine.film.integrators.symplectic_euler import symplectic_euler
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.film.simulate import Simulation
from toile.geometry.arrays import Float
from toile.studies.scenes.motion import EXACT, Solving, carried_on, free_stepper, total_energy
from toile.studies.scenes.scenes import film_plan
from toile.studies.scenes.swing import swing
from toile.studies.validation.free_flight import momentum, spin, thrown
from toile.studies.validation.oscillators import measured_order
from toile.studies.validation.validation_row import ValidationRow, absolute_row, relative_row


class Method(NamedTuple):
    """An integrator, how exactly its stages are solved, and the order it promises."""

    name: str
    integrator: Integrator
    solving: Solving
    order: float


IMPLICIT = (
    Method("Baraff-Witkin", baraff_witkin, replace(EXACT, iterations=1), 1.0),
    Method("backward Euler", backward_euler, EXACT, 1.0),
    Method("BDF2", bdf2, EXACT, 2.0),
    Method("TR-BDF2", tr_bdf2, EXACT, 2.0),
)
EXPLICIT = (
    Method("explicit Euler", explicit_euler, EXACT, 1.0),
    Method("symplectic Euler", symplectic_euler, EXACT, 1.0),
)
FILM_SECONDS, FILM_STEPS = 0.1, (160, 320, 640, 1280)
"""Length of the film whose order is measured [s], and its numbers of steps."""
ORDER_BAR = 0.1
ENERGY_BAR = 1e-6
"""Of some 0.5 J that the swinging sheet has [J]."""
MOMENTUM_BAR = 1e-9
"""[kg m/s]"""
SPIN_BAR = 1e-8
"""Percent in 0.01 s."""


def energy_growth(method: Method) -> float:
    """Return the largest rise of the energy above its last height in a second of a swinging sheet [J]."""
    stepper = free_stepper(swing(8))
    before, rise = total_energy(stepper), 0.0
    for step in range(60):
        carried_on(stepper, method.integrator, method.solving, 1.0 / 60.0, 1.0 / 60.0, step / 60.0)
        energy = total_energy(stepper)
        rise, before = max(rise, energy - before), max(before, energy)
    return rise


def film_order(integrator: Integrator) -> float:
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


def momentum_change(method: Method, model: str) -> float:
    """Return by how much the momentum of a sheet in free flight changes in 20 steps [kg m/s]."""
    stepper = thrown(model)
    before = momentum(stepper)
    h = 1e-5 if method in EXPLICIT else 5e-3
    carried_on(stepper, method.integrator, method.solving, 20 * h, h)
    return float(np.linalg.norm(momentum(stepper) - before))


def validate_orders() -> Iterator[ValidationRow]:
    """Measure every integrator."""
    for method in (*EXPLICIT, *IMPLICIT):
        order = measured_order(method.integrator, method.solving)
        yield absolute_row("orders", method.name, "order", order, method.order, ORDER_BAR)
        for model in ("triangles", "springs"):
            yield absolute_row(
                "orders", f"{method.name}, {model}", "momentum change, kg m/s",
                momentum_change(method, model), 0.0, MOMENTUM_BAR,
            )  # fmt: skip
    for method in IMPLICIT[1:]:
        variant = f"film, {method.name}"
        yield absolute_row("orders", variant, "order", film_order(method.integrator), method.order, ORDER_BAR)
    for method in IMPLICIT:
        yield absolute_row(
            "orders", method.name, "energy growth, J", energy_growth(method), 0.0, ENERGY_BAR
        )  # fmt: skip
    # Of the others only symplectic Euler keeps it: implicit steps turn less than the sheet does.
    stepper = thrown("triangles")
    before = spin(stepper)
    carried_on(stepper, symplectic_euler, EXACT, 0.01, 1e-5)
    yield relative_row(
        "orders", "symplectic Euler", "angular momentum, kg m^2/s", spin(stepper), before, SPIN_BAR
    )  # fmt: skip
