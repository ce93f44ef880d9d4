"""Obstacles that somebody moves: named closed surfaces, together one avatar as the engine takes it."""

from collections.abc import Mapping

import numpy as np

from toile.geometry.arrays import Float, Int

SPEED = 1.5
"""Fastest motion of an obstacle [m/s]."""

Surface = tuple[Float, Int]
"""Vertices [m], shape (v, 3), and faces, shape (t, 3)."""


class Obstacles:
    """Closed surfaces by name, and where they shall be."""

    def __init__(self, surfaces: Mapping[str, Surface]) -> None:
        self._faces = {name: faces for name, (_, faces) in surfaces.items()}
        self._rows: dict[str, slice] = {}
        self._wanted = {name: vertices.copy() for name, (vertices, _) in surfaces.items()}
        begin = 0
        for name, (vertices, _) in surfaces.items():
            self._rows[name] = slice(begin, begin + len(vertices))
            begin += len(vertices)

    @property
    def names(self) -> tuple[str, ...]:
        """Names in their order."""
        return tuple(self._rows)

    def together(self) -> Surface | None:
        """Return all as one surface where they shall be; None if there are none."""
        if not self._rows:
            return None
        faces = [self._faces[name] + np.int32(rows.start) for name, rows in self._rows.items()]
        return np.concatenate(list(self._wanted.values())), np.concatenate(faces).astype(np.int32)

    def surfaces(self, now: Float | None) -> dict[str, Surface]:
        """Return each where it is now, from the vertices of all [m], shape (v, 3)."""
        if now is None:
            return {}
        return {name: (now[rows].copy(), self._faces[name]) for name, rows in self._rows.items()}

    def want(self, name: str, vertices: Float) -> None:
        """Say where the vertices of one shall be [m], in the same order; it goes there at `SPEED` at most."""
        if vertices.shape != self._wanted[name].shape:
            raise ValueError(f"{name} has {len(self._wanted[name])} vertices, got {vertices.shape}")
        self._wanted[name] = np.ascontiguousarray(vertices, np.float64)

    def next(self, now: Float, h: float) -> Float | None:
        """Return where the vertices of all shall be after a step of h [s]; None where none is to move.

        `now` is where they are [m], shape (v, 3).
        """
        ahead = np.concatenate(list(self._wanted.values())) - now
        farthest = np.linalg.norm(ahead, axis=1)
        if not (farthest > 1e-9).any():
            return None
        for rows in self._rows.values():
            most = float(farthest[rows].max())
            ahead[rows] *= min(1.0, SPEED * h / max(most, 1e-300))
        return np.asarray(now + ahead)
