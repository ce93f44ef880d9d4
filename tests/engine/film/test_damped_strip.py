"""Damping of a fabric: a strip that swings along its length dies away as theory says."""

import math
from math import inf

import numpy as np
import pytest

from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.film.plan import FilmFrame, FilmPlan
from toile.engine.film.simulate import Simulation
from toile.engine.step.options import StepOptions
from toile.remesh.panel.rectangle import rectangle

LENGTH, STIFFNESS, DENSITY, DAMPING = 1.0, 1000.0, 0.1, 1e-3
PLUCKED = 1e-3
"""Of the free end at the start [m]."""
OMEGA = 0.5 * math.pi / LENGTH * math.sqrt(STIFFNESS / DENSITY)
"""Of the first mode, held at one end [rad/s]."""


@pytest.mark.parametrize(("edge", "h"), [(0.1, 2e-4), (0.05, 2e-4), (0.1, 1e-4)])
def test_a_plucked_strip_dies_away_as_theory_says(edge: float, h: float) -> None:
    """Stiffness-proportional damping of a mode: ratio DAMPING omega / 2 of the critical one."""
    fabric = Fabric(
        name="strip", areal_density=DENSITY, thickness=1e-3, bending_warp=0.0, bending_weft=0.0,
        bending_bias=0.0, stretch_warp=STIFFNESS, stretch_weft=STIFFNESS, shear=0.5 * STIFFNESS,
        compression=1.0, damping=DAMPING,
    )  # fmt: skip
    points, faces = rectangle(LENGTH, 0.2, edge)
    start = np.column_stack((points, np.zeros(len(points))))
    start[:, 0] += PLUCKED * np.sin(0.5 * math.pi * points[:, 0] / LENGTH)
    cloth = flat_cloth(points, faces, start, fabric, pinned=points[:, 0] < 1e-9)
    plan = FilmPlan(
        step=StepOptions(gravity=0.0, self_contact=False), integrator=tr_bdf2, frame_seconds=2e-3,
        longest_step=h, shortest_step=h, stretch_rise=inf, newton=10, newton_tolerance=1e-10,
        cg_tolerance=1e-8,
    )  # fmt: skip
    free = points[:, 0] > LENGTH - 1e-9
    tips: list[float] = []

    def watch(frame: FilmFrame) -> bool:
        tips.append(float((frame.cloth.positions[free, 0] - LENGTH).mean()))
        return True

    Simulation(cloth, None, plan, watch).run(0.08)
    ratio = 0.5 * DAMPING * OMEGA
    seconds = 2e-3 * np.arange(len(tips))
    damped = OMEGA * math.sqrt(1.0 - ratio**2)
    lag = ratio / math.sqrt(1.0 - ratio**2)
    swing = np.cos(damped * seconds) + lag * np.sin(damped * seconds)
    expected = PLUCKED * np.exp(-ratio * OMEGA * seconds) * swing
    assert np.abs(np.array(tips) - expected).max() < 0.03 * PLUCKED
    assert abs(expected[-10:]).max() < 0.5 * PLUCKED
