"""Two particles and a spring: systems with a known answer, for the orders and the damping of integrators."""

from itertools import pairwise

import numpy as np

from toile.engine.dynamics import Dynamics, Elements
from toile.engine.forces.spring import Springs
from toile.engine.integrators.motion import Integrator, Motion
from toile.engine.integrators.newton import NewtonOptions
from toile.geometry.arrays import Float

EXACT = NewtonOptions(tolerance=1e-11, cg_tolerance=1e-12)
"""Stages solved so far that errors are those of the steps."""


def oscillator(hertz: float = 1.0) -> tuple[Dynamics, Motion]:
    """Return 1 kg on a spring without rest length, at rest 1 m from its fixed end: x = cos(2 pi hertz t)."""
    return _pair(length=0.0, stiffness=(2.0 * np.pi * hertz) ** 2, gravity=0.0, free=[1.0, 0.0, 0.0])


def spring_pendulum() -> tuple[Dynamics, Motion]:
    """Return 1 kg on a spring of 1 m and 1000 N/m, level at rest, that swings under gravity."""
    return _pair(length=1.0, stiffness=1000.0, gravity=9.81, free=[1.0, 0.0, 0.0])


def measured_order(integrator: Integrator, *, coarsest: int = 200, doublings: int = 4) -> float:
    """Return the slope of the spring pendulum's error after 0.5 s over the step size."""
    ends = []
    for doubling in range(doublings + 1):
        dynamics, motion = spring_pendulum()
        count = coarsest * 2**doubling
        for _ in range(count):
            motion = integrator.step(dynamics, motion, 0.5 / count).motion
        ends.append(motion.positions[1])
    gaps = [np.linalg.norm(b - a) for a, b in pairwise(ends)]
    return float(-np.polyfit(np.arange(doublings), np.log2(gaps), 1)[0])


def loss_per_second(integrator: Integrator, h: float = 1.0 / 60.0) -> float:
    """Return the share of its energy that a swing of 1 Hz loses in its second second in steps of h [s]."""
    dynamics, motion = oscillator()
    energies = []
    count = round(1.0 / h)
    for step in range(2 * count + 1):
        if step % count == 0:
            energies.append(dynamics.total_energy(motion.positions, motion.velocities))
        motion = integrator.step(dynamics, motion, 1.0 / count).motion
    return 1.0 - energies[2] / energies[1]


def _pair(length: float, stiffness: float, gravity: float, free: list[float]) -> tuple[Dynamics, Motion]:
    positions: Float = np.array([[0.0, 0.0, 0.0], free])
    pairs = np.array([[0, 1]], np.int32)
    springs = Springs(pairs, np.array([length]), np.array([stiffness]))
    dynamics = Dynamics(np.ones(2), np.array([True, False]), [Elements(pairs, springs)], gravity=gravity)
    return dynamics, Motion(positions, np.zeros((2, 3)))
