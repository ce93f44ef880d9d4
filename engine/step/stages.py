"""Stages of implicit integrators: known states combined into what a step minimises.

Every stage of backward Euler, BDF2 and TR-BDF2 asks for a state that satisfies

    x = origin + h v,    v = velocity + h M^-1 f(x, v)

with a step size h of its own and combinations `origin` and `velocity` of known states. With y = origin + h
velocity that is M (x - y)/h^2 = f: the minimum of 1/(2 h^2) |x - y|_M^2 plus the energy of the forces. A
solver need know nothing else, so these functions serve any step that minimises such a sum, with contact or
without.

Sources: Bank et al. 1985 (TR-BDF2); Hosea and Shampine 1996 (its properties, and why the slope of the
trapezoidal stage is what the step before has solved for and not the force evaluated anew); Hairer, Norsett
and Wanner 1993, III.5 (BDF2 of variable steps).
"""

from typing import NamedTuple

from toile.geometry.arrays import Float

GAMMA = 2.0 - 2.0**0.5
"""Share of the step of TR-BDF2 after which its first stage ends: both stages then have the same matrix."""


class Stage(NamedTuple):
    """An implicit stage: origin [m], velocity [m/s], shapes (n, 3), and step size [s]."""

    origin: Float
    velocity: Float
    h: float

    @property
    def inertial(self) -> Float:
        """Inertial prediction y [m], shape (n, 3)."""
        return self.origin + self.h * self.velocity

    def velocity_at(self, x: Float) -> Float:
        """Velocities [m/s] that go with positions x [m], shapes (n, 3)."""
        return (x - self.origin) / self.h

    def acceleration_at(self, x: Float) -> Float:
        """Accelerations [m/s^2] that go with positions x [m], shapes (n, 3)."""
        return (self.velocity_at(x) - self.velocity) / self.h


def backward_euler_stage(x: Float, v: Float, h: float) -> Stage:
    """Return the stage of a backward Euler step of h [s] from x [m] and v [m/s], shapes (n, 3)."""
    return Stage(x, v, h)


def bdf2_stage(x: Float, v: Float, x_before: Float, v_before: Float, h: float, h_before: float) -> Stage:
    """Return the stage of a BDF2 step of h [s] after one of `h_before`, from the last two states.

    Zero-stable while h < (1 + sqrt 2) h_before.
    """
    ratio = h / h_before
    last = (1.0 + ratio) ** 2 / (1.0 + 2.0 * ratio)
    first = ratio**2 / (1.0 + 2.0 * ratio)
    own = (1.0 + ratio) / (1.0 + 2.0 * ratio) * h
    return Stage(last * x - first * x_before, last * v - first * v_before, own)


def trapezoidal_stage(x: Float, v: Float, acceleration: Float, h: float) -> Stage:
    """Return the first stage of a TR-BDF2 step of h [s]: the trapezoidal rule over GAMMA h.

    `acceleration` [m/s^2], shape (n, 3), is the `acceleration_at` the solution of the last stage.
    """
    half = 0.5 * GAMMA * h
    return Stage(x + half * v, v + half * acceleration, half)


def tr_bdf2_stage(x: Float, v: Float, x_middle: Float, v_middle: Float, h: float) -> Stage:
    """Return the second stage of a TR-BDF2 step of h [s]: BDF2 over both ends of the first."""
    middle = 1.0 / (GAMMA * (2.0 - GAMMA))
    start = (1.0 - GAMMA) ** 2 * middle
    return Stage(middle * x_middle - start * x, middle * v_middle - start * v, 0.5 * GAMMA * h)
