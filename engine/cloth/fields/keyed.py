"""Numbers that change over a film."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from toile.geometry.arrays import Float


@dataclass(frozen=True)
class Keyed:
    """A number over time: linear between keys, constant before the first and after the last.

    Attributes
    ----------
    times
        Of the keys, rising [s].
    values
        At the keys.
    """

    times: tuple[float, ...]
    values: tuple[float, ...]

    @cached_property
    def _arrays(self) -> tuple[Float, Float]:
        return np.array(self.times, np.float64), np.array(self.values, np.float64)

    def at(self, seconds: float) -> float:
        """Return the number at a time [s]."""
        return float(np.interp(seconds, *self._arrays))

    def later(self, seconds: float) -> "Keyed":
        """Return the same with all keys later by some time [s]."""
        return Keyed(tuple(time + seconds for time in self.times), self.values)


def value_at(value: "float | Keyed", seconds: float) -> float:
    """Return what a number, keyed or not, is at a time [s]."""
    return value.at(seconds) if isinstance(value, Keyed) else float(value)


def later(value: "float | Keyed", seconds: float) -> "float | Keyed":
    """Return a number with its keys, if it has any, later by some time [s]."""
    return value.later(seconds) if isinstance(value, Keyed) else value
