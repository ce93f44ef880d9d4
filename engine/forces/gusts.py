"""Gusts: wind whose velocity varies with time, the same for the same seed.

Every component is a sum of waves with the spectrum of turbulence of length L in a mean wind U (von Karman
1948, longitudinal): S(f) ~ 4 T / (1 + 70.8 (f T)^2)^(5/6), T = L/U. Waves have frequencies that divide the
range evenly in their logarithms, random phases, and amplitudes that give the spectrum (Shinozuka 1972), so
the velocity is known at any time without those before it.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from toile.geometry.arrays import Float

WAVES = 48
SLOWEST, FASTEST = 0.01, 20.0
"""Range of the frequencies times L/U."""


@dataclass(frozen=True, kw_only=True)
class Gusts:
    """Variation of a wind.

    Attributes
    ----------
    intensity
        Standard deviation of every component over the mean speed; 0.1 to 0.2 outdoors.
    length
        Size of the eddies [m]: they pass a place within length / speed.
    seed
        Which of all gusts of this kind.
    """

    intensity: float
    length: float
    seed: int

    @cached_property
    def _waves(self) -> tuple[Float, Float, Float]:
        """Frequencies times L/U and shares of the standard deviation, shape (w,); phases, shape (w, 3)."""
        border = np.geomspace(SLOWEST, FASTEST, WAVES + 1)
        frequency = np.sqrt(border[1:] * border[:-1])
        power = np.diff(border) * (1.0 + 70.8 * frequency**2) ** (-5.0 / 6.0)
        phase = 2.0 * np.pi * np.random.default_rng(self.seed).random((WAVES, 3))
        return frequency, np.sqrt(2.0 * power / power.sum()), phase

    def velocity(self, mean: Float, seconds: float) -> Float:
        """Velocity [m/s] at a time [s] of a wind of `mean` velocity [m/s], shape (3,)."""
        speed = float(np.linalg.norm(mean))
        frequency, share, phase = self._waves
        waves = np.cos(2.0 * np.pi * (speed / self.length * seconds) * frequency[:, None] + phase)
        return np.asarray(mean + self.intensity * speed * (share @ waves))
