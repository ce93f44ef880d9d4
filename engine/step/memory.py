"""What a step changes, kept so that it can be tried again."""

from typing import NamedTuple

from toile.geometry.arrays import Bool, Float


class Memory(NamedTuple):
    """Accelerations that the last stage solved for [m/s^2], shape (n, 3); nodes that touched in it, (n,)."""

    acceleration: Float
    touched: Bool


class Saved(NamedTuple):
    """Nodes [m], velocities [m/s], memory, friction anchors [m] and avatar vertices [m] before a step."""

    positions: Float
    velocities: Float
    memory: Memory
    anchor: Float | None
    avatar: Float | None
