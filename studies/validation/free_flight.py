"""A crumpled sheet in free flight: linear and angular momentum are kept."""

from dataclasses import replace

import numpy as np

from toile.dressing.garment.fabrics import fabric
from toile.engine.dynamics import Dynamics
from toile.engine.integrators.motion import Motion
from toile.engine.spring_cloth import grid_springs, spring_dynamics
from toile.engine.triangle_dynamics import triangle_dynamics
from toile.studies.scenes.swing import swing


def thrown(model: str) -> tuple[Dynamics, Motion]:
    """Return a sheet of "springs" or of "triangles" with no weight, no pins, no damping, and its motion."""
    cloth = swing(6)
    free = np.zeros(len(cloth.positions), bool)
    generator = np.random.default_rng(2)
    x = cloth.positions + 0.01 * generator.normal(size=cloth.positions.shape)
    v = np.cross([0.5, 1.0, -2.0], x) + [1.0, -0.5, 2.0] + 0.1 * generator.normal(size=x.shape)
    if model == "springs":
        net = grid_springs(1.0, 1.0, 6, 6, fabric("cotton-poplin"))
        return spring_dynamics(net, free, gravity=0.0), Motion(x, v)
    return triangle_dynamics(replace(cloth, pinned=free), gravity=0.0), Motion(x, v)


def spin(dynamics: Dynamics, motion: Motion) -> float:
    """Return the size of the angular momentum [kg m^2/s]."""
    return float(
        np.linalg.norm((dynamics.mass[:, None] * np.cross(motion.positions, motion.velocities)).sum(axis=0))
    )
