"""The nodes of a stepper: where they are, how they move, what they weigh, which do not move."""

from typing import NamedTuple

from toile.geometry.arrays import Bool, Float


class Nodes(NamedTuple):
    """Positions [m], velocities [m/s], shapes (n, 3); mass [kg] and whether they are pinned, shapes (n,)."""

    positions: Float
    velocities: Float
    mass: Float
    pinned: Bool
