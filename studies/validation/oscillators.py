"""Two particles and a spring, with known solutions: for the order and damping of integrators."""

from itertools import pairwise

import numpy as np

from toile.engine.film.integrators.integrator import Integrator
from toile.engine.forces.spring import Springs
from toile.engine.step.nodes import Nodes
from toile.engine.step.step import ClothStepper
from toile.geometry.stage_clock import StageClock
from toile.studies.scenes.motion import Solving, carried_on, free_options, total_energy


def oscillator(hertz: float = 1.0) -> ClothStepper:
    """Return 1 kg on a spring without rest length, at rest 1 m from its fixed end: x = cos(2 pi hertz t)."""
    return _pair(length=0.0, stiffness=(2.0 * np.pi * hertz) ** 2, gravity=0.0)


def spring_pendulum() -> ClothStepper:
    """Return 1 kg on a spring of 1 m and 1000 N/m, level at rest, that swings under gravity."""
    return _pair(length=1.0, stiffness=1000.0, gravity=9.81)


def measured_order(
    integrator: Integrator, solving: Solving, *, coarsest: int = 200, doublings: int = 4
) -> float:
    """Return the slope of the spring pendulum's error after 0.5 s over the step size."""
    ends = []
    for doubling in range(doublings + 1):
        stepper = spring_pendulum()
        carried_on(stepper, integrator, solving, 0.5, 0.5 / (coarsest * 2**doubling))
        ends.append(stepper.x[1].copy())
    gaps = [np.linalg.norm(b - a) for a, b in pairwise(ends)]
    return float(-np.polyfit(np.arange(doublings), np.log2(gaps), 1)[0])


def loss_per_second(integrator: Integrator, solving: Solving, h: float = 1.0 / 60.0) -> float:
    """Return the share of its energy that a swing of 1 Hz loses in its second second in steps of h [s]."""
    stepper = oscillator()
    energies = []
    for second in range(2):
        carried_on(stepper, integrator, solving, 1.0, h, since=float(second))
        energies.append(total_energy(stepper))
    return 1.0 - energies[1] / energies[0]


def _pair(length: float, stiffness: float, gravity: float) -> ClothStepper:
    positions = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    springs = Springs(np.array([[0, 1]], np.int32), np.array([length]), np.array([stiffness]))
    nodes = Nodes(positions, np.zeros((2, 3)), np.ones(2), np.array([True, False]))
    return ClothStepper(nodes, [springs], None, free_options(gravity), StageClock())
