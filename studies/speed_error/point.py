"""Parts of the report: points on curves, curves in charts, bars that a scene must meet."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple


@dataclass(frozen=True, kw_only=True)
class Point:
    """One way of computing a scene: what it cost, and how far it ended from the reference.

    Attributes
    ----------
    curve, label
        What is varied, and to what: together they name the point within its chart.
    cpu, spread
        Median of the CPU times of `repeats` runs, and longest less shortest [s].
    error
        Distance from the reference, in the unit of the chart; not finite where the run broke down.
    faces
        Triangles, mean over the run.
    crossings
        Pairs of triangles that cross, over all audited frames.
    preset
        Quality preset that these settings are, or empty.
    figures
        What else was measured, by name with unit.
    """

    curve: str
    label: str
    cpu: float
    spread: float
    repeats: int
    error: float
    faces: float
    crossings: int = 0
    preset: str = ""
    figures: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A claim about a scene: a value and its limit, which it may not exceed, or fall below if `at_least`."""

    claim: str
    value: float
    limit: float
    at_least: bool = False

    @property
    def met(self) -> bool:
        """Whether the claim holds; it does not for a value that is not a number."""
        return self.value >= self.limit if self.at_least else self.value <= self.limit


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Points with one reference.

    Attributes
    ----------
    scene, title
        Scene, and what the chart is about; together they name it.
    error, unit
        What the error is, and its unit.
    reference
        What errors are measured against.
    floor
        How far that reference is from one about half as fine, in the unit; 0 where it is exact.
    points
        In the order of their curves.
    bars
        What the scene must reach.
    """

    scene: str
    title: str
    error: str
    unit: str
    reference: str
    floor: float
    points: tuple[Point, ...]
    bars: tuple[Bar, ...] = ()


class Effort(NamedTuple):
    """Effort of a study: whether it is quick, repeats of timed runs, and who is told."""

    quick: bool
    repeats: int
    say: Callable[[str], None]


Study = Callable[[Effort], Iterator[Chart]]
"""Measures one scene, chart by chart."""
