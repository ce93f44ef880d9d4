"""Comparison of two stored reports: regressions in time, error and crossings, by ratio."""

from dataclasses import dataclass

from toile.geometry.errors import InputError
from toile.studies.speed_error.point import Chart, Point
from toile.studies.speed_error.stored import Report

RATIO = 1.25
"""Growth that is a regression, unless told."""
NOISE = 0.05
"""CPU times below this say nothing: they count as this much [s]."""


@dataclass(frozen=True, kw_only=True)
class Compared:
    """A point of both reports: new over old CPU time and error, and what regressed (empty: nothing)."""

    place: str
    cpu_ratio: float
    error_ratio: float
    regressed: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """All points that both have, what only one has, and what else to know before trusting the ratios."""

    points: tuple[Compared, ...]
    notes: tuple[str, ...]

    @property
    def regressions(self) -> tuple[Compared, ...]:
        """The points that regressed."""
        return tuple(point for point in self.points if point.regressed)


def compare_reports(old: Report, new: Report, ratio: float) -> Comparison:
    """Compare points of the same scene, chart, curve and label.

    A point regresses when its CPU time or its error has grown by more than `ratio`, or when more crosses than
    before. Times below NOISE and errors below the chart's floor count as much as these.
    Raises InputError where the reports have nothing in common.
    """
    if old.quick != new.quick:
        raise InputError("one report is quick and the other is not; compare two of the same kind")
    charts = {(chart.scene, chart.title): chart for chart in old.charts}
    known = {
        (key, point.curve, point.label): point for key, chart in charts.items() for point in chart.points
    }
    points, added = [], 0
    for chart in new.charts:
        before = charts.get((chart.scene, chart.title))
        for point in chart.points:
            was = known.pop(((chart.scene, chart.title), point.curve, point.label), None)
            if was is None or before is None:
                added += 1
            else:
                points.append(_compared(chart, max(before.floor, chart.floor), was, point, ratio))
    if not points:
        raise InputError("the reports share no point; compare two that measured the same scenes")
    notes = []
    if old.machine != new.machine:
        notes.append("the reports are of different machines: ratios of CPU times compare these as well")
    for text, count in (("only in the old report", len(known)), ("only in the new report", added)):
        if count:
            notes.append(f"{count} points are {text}")
    return Comparison(points=tuple(points), notes=tuple(notes))


def _compared(chart: Chart, floor: float, old: Point, new: Point, ratio: float) -> Compared:
    """Compare a point with what it was; floor: see `Chart`."""
    cpu = max(new.cpu, NOISE) / max(old.cpu, NOISE)
    least = max(floor, 1e-12)
    error = 1.0 if new.error == old.error else max(new.error, least) / max(old.error, least)
    regressed = []
    if cpu > ratio:
        regressed.append(f"CPU time {cpu:.2f} x ({old.cpu:.3g} to {new.cpu:.3g} s)")
    if error > ratio:
        regressed.append(f"error {error:.2f} x ({old.error:.3g} to {new.error:.3g} {chart.unit})")
    if new.crossings > old.crossings:
        regressed.append(f"crossings {old.crossings} to {new.crossings}")
    return Compared(
        place=f"{chart.scene}, {new.curve}, {new.label}", cpu_ratio=cpu, error_ratio=error,
        regressed=tuple(regressed),
    )  # fmt: skip


def comparison_text(comparison: Comparison, ratio: float) -> str:
    """Return the regressions as text, one a line, and a sum."""
    lines = [f"{point.place}: {'; '.join(point.regressed)}" for point in comparison.regressions]
    lines += comparison.notes
    count = len(comparison.regressions)
    lines.append(f"{len(comparison.points)} points compared, {count} worse by more than {ratio:g} x")
    return "\n".join(lines)
