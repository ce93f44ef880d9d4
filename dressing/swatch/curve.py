"""What an experiment gives: a table of figures, and the swatch at its end."""

from collections.abc import Callable
from typing import NamedTuple

from toile.engine.swatch.equilibrium import NoEquilibriumError, Patch

Watch = Callable[[str], object]
"""Hears in a line how far an experiment is."""


class Curve(NamedTuple):
    """Result of an experiment.

    Attributes
    ----------
    title
        What was done.
    columns
        Names of the figures, with units.
    rows
        Figures of every load step.
    axes
        Columns that a picture shows: along, up.
    notes
        What follows from them, in sentences.
    patch
        The swatch in its last equilibrium.
    steps
        How many load steps were asked for.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[float, ...], ...]
    axes: tuple[int, int]
    notes: tuple[str, ...]
    patch: Patch
    steps: int

    @property
    def complete(self) -> bool:
        """Whether equilibrium was found at every load step."""
        return len(self.rows) == self.steps

    def csv(self) -> str:
        """Return the figures as a table of comma-separated values."""
        lines = [",".join(self.columns)]
        lines += [",".join(f"{figure:.9g}" for figure in row) for row in self.rows]
        return "\n".join(lines) + "\n"


def say_nothing(line: str) -> None:
    """Hear nothing."""


def settled(patch: Patch, load: str, notes: list[str], watch: Watch) -> bool:
    """Find equilibrium under a load, and say so; where there is none, note it and return False."""
    try:
        iterations = patch.settle()
    except NoEquilibriumError as error:
        notes.append(f"stopped at {load}: {error}")
        watch(notes[-1])
        return False
    watch(f"{load}: {iterations} iterations")
    return True
