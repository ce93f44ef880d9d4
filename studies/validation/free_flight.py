"""A crumpled sheet in free flight: linear and angular momentum are kept."""

from dataclasses import replace

import numpy as np

from toile.dressing.garment.fabrics import fabric
from toile.engine.step.step import ClothStepper
from toile.studies.scenes.motion import free_options, free_stepper
from toile.studies.scenes.spring_cloth import grid_springs, spring_stepper
from toile.studies.scenes.swing import swing


def thrown(model: str) -> ClothStepper:
    """Return a sheet of "springs" or of "triangles" in motion, with no weight, no pins, no damping."""
    cloth = swing(6)
    free = np.zeros(len(cloth.positions), bool)
    generator = np.random.default_rng(2)
    x = cloth.positions + 0.01 * generator.normal(size=cloth.positions.shape)
    v = np.cross([0.5, 1.0, -2.0], x) + [1.0, -0.5, 2.0] + 0.1 * generator.normal(size=x.shape)
    if model == "springs":
        net = grid_springs(1.0, 1.0, 6, 6, fabric("cotton-poplin"))
        stepper = spring_stepper(net, x, free, free_options(gravity=0.0))
        stepper.put(x, v)
        return stepper
    return free_stepper(replace(cloth, positions=x, velocities=v, pinned=free), gravity=0.0)


def momentum(stepper: ClothStepper) -> np.ndarray:
    """Return the linear momentum [kg m/s], shape (3,)."""
    return np.asarray(stepper.mass @ stepper.v)


def spin(stepper: ClothStepper) -> float:
    """Return the size of the angular momentum [kg m^2/s]."""
    return float(np.linalg.norm((stepper.mass[:, None] * np.cross(stepper.x, stepper.v)).sum(axis=0)))
