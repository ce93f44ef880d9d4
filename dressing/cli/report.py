"""`toile bench`: the speed-error report, and the comparison of two stored reports."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from toile.dressing.cli.parser import DONE, MISSED, say_progress
from toile.geometry.errors import InputError

if TYPE_CHECKING:
    from toile.studies.speed_error.point import Chart

REPEATS = 3
"""Runs of what is timed, of the full report."""


def run_report(options: argparse.Namespace) -> int:
    """Measure scenes, store and draw what is done; the exit code tells whether all bars were met."""
    from toile.dressing.files.suggestion import unknown_name
    from toile.dressing.files.writers.atomic import writable_folder
    from toile.studies.speed_error.page_markdown import bar_text
    from toile.studies.speed_error.point import Effort
    from toile.studies.speed_error.studies import STUDIES, run_studies

    for name in options.name:
        if name not in STUDIES:
            raise InputError(
                unknown_name("scene or study", name, (*STUDIES, "remesh", "compare", "film", "memory"))
            )
    names = list(dict.fromkeys(options.name or STUDIES))
    folder = None if options.out is None else writable_folder(options.out)
    effort = Effort(options.quick, options.repeats or (1 if options.quick else REPEATS), say_progress)
    repeated = () if options.repeats is None else ("--repeats", str(options.repeats))
    command = " ".join(["toile bench", *options.name, *(["--quick"] if options.quick else []), *repeated])
    charts: list[Chart] = []
    # Stored at once, so that an unwritable file is known before minutes are spent.
    _store(charts, options, folder, command)
    for chart in run_studies(names, effort):
        charts.append(chart)
        _store(charts, options, folder, command)
        print("\n".join(_summary(chart)), flush=True)
    bars = [bar for chart in charts for bar in chart.bars]
    for bar in bars:
        print(bar_text(bar).replace("**", ""))
    return DONE if all(bar.met for bar in bars) else MISSED


def run_compare(files: Sequence[str], ratio: float | None) -> int:
    """Print what regressed from one stored report to another; the exit code tells whether anything did."""
    from toile.studies.speed_error.compare import RATIO, compare_reports, comparison_text
    from toile.studies.speed_error.stored import read_report

    if len(files) != 2:
        raise InputError(f"compare takes two stored reports, OLD.json and NEW.json, got {len(files)}")
    allowed = RATIO if ratio is None else ratio
    if not 1.0 <= allowed < float("inf"):
        raise InputError(f"--ratio must be at least 1, got {allowed:g}", field="--ratio")
    old, new = (read_report(Path(file)) for file in files)
    comparison = compare_reports(old, new, allowed)
    print(comparison_text(comparison, allowed))
    return MISSED if comparison.regressions else DONE


def _store(charts: "Sequence[Chart]", options: argparse.Namespace, folder: Path | None, command: str) -> None:
    """Write what is done so far to wherever it shall go."""
    from toile.dressing.run.report import versions
    from toile.studies.speed_error.machine import machine
    from toile.studies.speed_error.mujoco_peer import peer_versions
    from toile.studies.speed_error.stored import Report, write_report
    from toile.studies.speed_error.write import write_pages

    said = versions() | peer_versions()
    report = Report(quick=options.quick, machine=machine(), versions=said, charts=tuple(charts))
    if options.json is not None:
        write_report(options.json, report)
    if folder is not None:
        write_pages(folder, report, command)


def _summary(chart: "Chart") -> list[str]:
    """Return a chart as lines: its floor and its Pareto front."""
    from toile.studies.speed_error.pareto import pareto_front

    front = pareto_front(chart.points)
    lines = [f"{chart.scene}: {chart.title}; floor {chart.floor:.3g} {chart.unit}"]
    lines += [
        f"  {point.cpu:9.3g} s  {point.error:9.3g} {chart.unit}  {point.curve}, {point.label}"
        for point in front
    ]
    return lines
