"""Air around cloth: its velocity and its resistance. The force on cloth is in `engine.forces.wind`."""

from dataclasses import dataclass

import numpy as np

from toile.engine.forces.fan import Fan
from toile.engine.forces.gusts import Gusts
from toile.geometry.arrays import Float


@dataclass(frozen=True, kw_only=True)
class AirFlow:
    """Air around the cloth.

    Attributes
    ----------
    velocity
        Velocity of the air [m/s], x, y, z.
    resistance
        k_w [N s/m^3]: pressure per relative speed. Pressure drag rho c/2 u^2 of a plate has this secant at
        speed u: k_w = rho c u / 2.
    friction
        k_s [N s/m^3]: traction along the cloth per relative speed.
    gusts
        How the velocity varies about that one, or None.
    fans
        Winds beside it that change, or differ from place to place.
    """

    velocity: tuple[float, float, float]
    resistance: float
    friction: float = 0.0
    gusts: Gusts | None = None
    fans: tuple[Fan, ...] = ()

    def velocity_at(self, seconds: float) -> Float:
        """Velocity of the air [m/s] at a time [s], shape (3,)."""
        mean = np.array(self.velocity)
        return mean if self.gusts is None else self.gusts.velocity(mean, seconds)

    def velocity_around(self, seconds: float, x: Float) -> Float:
        """Velocity of the air [m/s] at a time [s]: everywhere, shape (3,), or at positions x [m], (n, 3)."""
        velocity = self.velocity_at(seconds)
        for fan in self.fans:
            velocity = velocity + fan.velocity(seconds, x)
        return velocity
