"""Colours of values: bands of equal width, from light to dark."""

from dataclasses import dataclass

import numpy as np

from toile.dressing.files.palette import linear
from toile.geometry.arrays import Float, Int

BANDS = 10
STOPS = (
    (0.93, 0.92, 0.88),
    (0.98, 0.84, 0.45),
    (0.93, 0.50, 0.24),
    (0.74, 0.15, 0.24),
    (0.36, 0.04, 0.26),
)
"""sRGB from the lowest to the highest value."""


@dataclass(frozen=True)
class ColourScale:
    """Colours of values from 0 to `top`, in BANDS steps; beyond they have the last colour."""

    top: float

    @staticmethod
    def of(values: Float, least: float) -> "ColourScale":
        """Return the scale of values, up to a round number over 99 % of them, at least `least`."""
        high = max(float(np.quantile(values, 0.99)) if len(values) else 0.0, least)
        power = 10.0 ** np.floor(np.log10(high))
        step = next(step for step in (1.0, 2.0, 3.0, 5.0, 10.0) if high <= step * power * (1.0 + 1e-9))
        return ColourScale(float(step * power))

    @property
    def colours(self) -> list[tuple[float, float, float]]:
        """Return the sRGB of every band."""
        at = np.linspace(0.0, len(STOPS) - 1.0, BANDS)
        table = np.array(STOPS)
        mixed = [np.interp(at, np.arange(len(STOPS)), table[:, channel]) for channel in range(3)]
        return [(r, g, b) for r, g, b in np.column_stack(mixed).tolist()]

    def band(self, values: Float) -> Int:
        """Return the band of values, shape (n,)."""
        return np.clip(np.nan_to_num(values) / self.top * BANDS, 0, BANDS - 1).astype(np.int32)

    def linear_colours(self, values: Float) -> Float:
        """Return linear red, green and blue of values, shape (n, 3)."""
        return np.array([linear(colour) for colour in self.colours])[self.band(values)]
