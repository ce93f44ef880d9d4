"""Memory of a stepper: the past that integrators use, and saved states for retries."""

from typing import NamedTuple

from toile.geometry.arrays import Bool, Float


class Before(NamedTuple):
    """Positions [m] and velocities [m/s], shapes (n, 3), before the last step, and its size [s]."""

    positions: Float
    velocities: Float
    h: float


class Memory(NamedTuple):
    """The past of a motion, as far as integrators use it.

    Attributes
    ----------
    acceleration
        What the last stage has solved for [m/s^2], shape (n, 3).
    touched
        Nodes in contact then, shape (n,): they take a backward Euler step next.
    before
        The state before the last step; None after anything that makes velocities or the mesh jump.
    """

    acceleration: Float
    touched: Bool
    before: Before | None = None


class Saved(NamedTuple):
    """Nodes [m], velocities [m/s], memory, friction anchors [m] and avatar vertices [m] before a step."""

    positions: Float
    velocities: Float
    memory: Memory | None
    anchor: Float | None
    avatar: Float | None
