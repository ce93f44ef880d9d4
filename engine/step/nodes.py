"""The nodes of a stepper: positions, velocities, masses, pins."""

from typing import NamedTuple

from toile.geometry.arrays import Bool, Float


class Nodes(NamedTuple):
    """Positions [m], velocities [m/s], shapes (n, 3); mass [kg] and whether they are pinned, shapes (n,)."""

    positions: Float
    velocities: Float
    mass: Float
    pinned: Bool
