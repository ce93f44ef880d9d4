"""Record of one remeshing of a run."""

from dataclasses import dataclass

NOISE = 1e-7
"""Elastic energy [J] below which changes do not count: that of a letter's weight lifted by 2 micrometres."""


@dataclass(frozen=True, kw_only=True)
class Remeshing:
    """One remeshing.

    Attributes
    ----------
    step
        Steps of the run before it.
    faces
        Faces after it.
    splits, flips, collapses
        What was done.
    energy_before, energy_after
        Elastic energy before it, and after the nodes of changed faces found their places [J].
    """

    step: int
    faces: int
    splits: int
    flips: int
    collapses: int
    energy_before: float
    energy_after: float

    @property
    def energy_jump(self) -> float:
        """Change of elastic energy, as a share of it; of `NOISE`, where there is less."""
        return (self.energy_after - self.energy_before) / max(self.energy_before, NOISE)
