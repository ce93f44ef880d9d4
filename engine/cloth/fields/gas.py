"""Gas that a closed garment encloses."""

import math
from dataclasses import dataclass, replace

from toile.engine.cloth.fields.keyed import Keyed, later, value_at

ATMOSPHERE = 101_325.0
"""Pressure outside [Pa]."""


@dataclass(frozen=True, kw_only=True)
class Gas:
    """What fills one garment: gas of constant pressure, or an amount of gas of constant temperature.

    Attributes
    ----------
    garment
        The garment.
    pressure
        Pressure above that outside [Pa], or None.
    volume
        Volume that the gas has outside [m^3], or None: inside it has the pressure ATMOSPHERE volume/V.
    """

    garment: int
    pressure: float | Keyed | None = None
    volume: float | Keyed | None = None

    def later(self, seconds: float) -> "Gas":
        """Return the gas in a film whose frame 0 is at a time [s]."""
        return replace(
            self,
            pressure=None if self.pressure is None else later(self.pressure, seconds),
            volume=None if self.volume is None else later(self.volume, seconds),
        )

    def overpressure(self, inside: float, seconds: float) -> float:
        """Pressure above that outside [Pa] of gas that fills a volume [m^3] at a time [s]."""
        if self.pressure is not None:
            return value_at(self.pressure, seconds)
        assert self.volume is not None
        return ATMOSPHERE * (value_at(self.volume, seconds) / inside - 1.0)

    def energy(self, inside: float, seconds: float) -> float:
        """Energy [J], up to a constant, whose derivative by the volume is minus the overpressure."""
        if self.pressure is not None:
            return -value_at(self.pressure, seconds) * inside
        assert self.volume is not None
        free = value_at(self.volume, seconds)
        return ATMOSPHERE * (inside - free - free * math.log(inside / free))

    def stiffness(self, inside: float, seconds: float) -> float:
        """How much the overpressure falls per volume [Pa/m^3]."""
        if self.pressure is not None:
            return 0.0
        assert self.volume is not None
        return ATMOSPHERE * value_at(self.volume, seconds) / inside**2
