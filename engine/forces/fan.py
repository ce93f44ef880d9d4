"""Wind of one source: it changes over a film, and with the distance from its place."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from toile.geometry.arrays import Float
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, shown

FASTEST = 60.0
"""Speed of a hurricane [m/s]."""
Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Fan:
    """A wind beside that of the whole air: keyed over a film, and perhaps weaker farther away.

    At a distance d from its place it blows with its velocity times (1 + (d - nearest) / 1 m)^-falloff; nearer
    than `nearest` with all of it, farther than `farthest` not at all. Between keys it goes straight.

    Attributes
    ----------
    velocities
        At the keys [m/s], x, y, z of a scene with Y up, shape (k, 3).
    times
        Of the keys, rising, from frame 0 of the film [s], shape (k,).
    places
        Where it stands at the keys [m], where the avatar's file has the body, shape (k, 3); nothing is the
        origin.
    falloff
        Power by which it weakens; 0 not at all.
    nearest, farthest
        Distances where it begins to weaken and where it ends [m]; None has no end.

    Raises InputError naming the field that is at fault.
    """

    velocities: Sequence[Vector]
    times: Sequence[float] = (0.0,)
    places: Sequence[Vector] = ()
    falloff: float = 0.0
    nearest: float = 0.0
    farthest: float | None = None

    def __post_init__(self) -> None:
        """Check every field."""
        times = tuple(self.times)
        if not times or not all(map(is_real, times)) or any(b <= a for a, b in pairwise(times)):
            raise InputError(f"times of a fan must be numbers that rise, got {shown(times)}", field="times")
        object.__setattr__(self, "times", tuple(map(float, times)))
        object.__setattr__(self, "velocities", self._vectors("velocities"))
        object.__setattr__(self, "places", self._vectors("places") if len(self.places) else ())
        if self.speed > FASTEST:
            raise InputError(
                f"velocities of a fan must be up to {FASTEST:g} m/s, got {self.speed:g}", field="velocities"
            )
        ends = [("falloff", self.falloff), ("nearest", self.nearest)]
        ends += [("farthest", self.farthest)] if self.farthest is not None else []
        for name, value in ends:
            if not is_real(value) or value < 0.0:
                raise InputError(f"{name} of a fan must be a number from 0, got {shown(value)}", field=name)
            object.__setattr__(self, name, float(value))

    @property
    def speed(self) -> float:
        """Its largest speed [m/s]."""
        return float(np.linalg.norm(np.array(self.velocities), axis=1).max())

    def velocity(self, seconds: float, x: Float) -> Float:
        """Return its velocity [m/s] at positions x [m] at a time [s], shapes (n, 3)."""
        blows = _at(seconds, self.times, self.velocities)
        if not self.falloff and self.farthest is None:
            return np.broadcast_to(blows, x.shape)
        place = _at(seconds, self.times, self.places) if self.places else np.zeros(3)
        away = np.linalg.norm(x - place, axis=1)
        share = (1.0 + np.maximum(away - self.nearest, 0.0)) ** -self.falloff
        if self.farthest is not None:
            share[away > self.farthest] = 0.0
        return np.asarray(share[:, None] * blows)

    def later(self, seconds: float) -> "Fan":
        """Return the same with all keys later by some time [s]."""
        return replace(self, times=tuple(time + seconds for time in self.times))

    def _vectors(self, name: str) -> tuple[Vector, ...]:
        """Return a field as vectors, one for every key."""
        given = getattr(self, name)
        try:
            table = np.array([[float(part) for part in vector] for vector in given])
        except (TypeError, ValueError):
            table = np.zeros(0)
        if table.shape != (len(self.times), 3) or not np.isfinite(table).all():
            raise InputError(
                f"{name} of a fan must be three numbers for each of its {len(self.times)} times, got "
                f"{shown(given)}",
                field=name,
            )
        return tuple((x, y, z) for x, y, z in table.tolist())


def _at(seconds: float, times: Sequence[float], vectors: Sequence[Vector]) -> Float:
    """Return vectors at keys, at a time between them, shape (3,)."""
    table = np.array(vectors)
    return np.array([np.interp(seconds, times, table[:, part]) for part in range(3)])
