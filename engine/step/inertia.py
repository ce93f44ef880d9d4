"""Inertia of one step: the inertial prediction of every node and its step size.

Nodes in contact take backward Euler steps while all others take stages of a method of higher order: what an
impact does to a velocity is over in a step, and a method that carries it on as an acceleration makes nodes
bounce.
"""

from typing import NamedTuple

import numpy as np

from toile.engine.step.stages import Stage
from toile.geometry.arrays import Bool, Float


class Inertia(NamedTuple):
    """Origin [m] and velocity [m/s] of every node, shapes (n, 3), and its step size [s], shape (n,).

    A step ends where x = origin + h v and v = velocity + h times the acceleration there.
    """

    origin: Float
    velocity: Float
    h: Float

    def without_forces(self, gravity: float) -> Float:
        """Inertial prediction [m], shape (n, 3), under gravity [m/s^2] along -y."""
        there = self.origin + self.h[:, None] * self.velocity
        there[:, 1] -= self.h * self.h * gravity
        return there

    def velocity_at(self, x: Float) -> Float:
        """Velocities [m/s] that go with positions x [m], shapes (n, 3)."""
        return np.asarray((x - self.origin) / self.h[:, None])

    def acceleration_at(self, x: Float) -> Float:
        """Accelerations [m/s^2] that go with positions x [m], shapes (n, 3)."""
        return np.asarray((self.velocity_at(x) - self.velocity) / self.h[:, None])


def inertia_of(x: Float, v: Float, h: float, stage: Stage | None, first_order: Bool) -> Inertia:
    """Return the inertia of a step of h [s] from positions [m] and velocities [m/s], shapes (n, 3).

    With a stage, only nodes marked `first_order`, shape (n,), take backward Euler steps.
    """
    sizes = np.full(len(x), h)
    if stage is None:
        return Inertia(x, v, sizes)
    here = first_order[:, None]
    return Inertia(
        np.where(here, x, stage.origin),
        np.where(here, v, stage.velocity),
        np.where(first_order, sizes, stage.h),
    )
