"""The report as Markdown: per chart its picture, its bars, the Pareto front and all points."""

import math

from toile.studies.speed_error.pareto import pareto_front
from toile.studies.speed_error.point import Bar, Chart, Point
from toile.studies.speed_error.stored import Report

TITLE = "Speed and error"
INTRODUCTION = """\
Error against CPU time on reference scenes, one thing varied at a time. Times are medians of repeated runs,
spreads longest less shortest; long runs are made once. The Pareto front holds the points that no other beats
in both; results with crossings are not on it, and drawn hollow. Errors below the floor mean nothing: the
floor is the distance of the reference from one about half as fine.
"""
BLENDER = """\
Blender's cloth as a peer on `hang` and `sphere`, on the same mesh with the same fabric:
`bench/blender_peer.py` makes a report like this one.
"""


def markdown_page(report: Report, command: str) -> str:
    """Return the page; pictures are named by `picture_name` and lie beside it."""
    parts = [f"# {TITLE}", f"`{command}`: {measured_on(report)}.", INTRODUCTION + BLENDER]
    scene = ""
    for chart in report.charts:
        if chart.scene != scene:
            scene = chart.scene
            parts.append(f"## {scene}")
        parts += [
            f"### {chart.title}",
            said_error(chart),
            f"![{chart.scene}: {chart.title}]({picture_name(chart)})",
        ]
        if chart.bars:
            parts.append("\n".join(f"- {bar_text(bar)}" for bar in chart.bars))
        parts.append(f"Pareto front: {front_text(chart)}.")
        parts.append(_table(chart))
    return "\n\n".join(part.strip() for part in parts) + "\n"


def measured_on(report: Report) -> str:
    """Return machine and versions as text."""
    kind = "quick" if report.quick else "full"
    machine = f"{report.machine.get('processor', '')}, {report.machine.get('cores', '?')} cores"
    return f"{kind} report; {machine}; " + ", ".join(f"{name} {one}" for name, one in report.versions.items())


def said_error(chart: Chart) -> str:
    """Return what errors are measured against, and their floor."""
    floor = f" Floor: {chart.floor:.3g} {chart.unit}." if chart.floor > 0.0 else ""
    return f"Error: {chart.error}. Reference: {chart.reference}.{floor}"


def bar_text(bar: Bar) -> str:
    """Return a claim, its value and whether it holds."""
    sense = "at least" if bar.at_least else "at most"
    return f"{bar.claim}: {bar.value:.3g} ({sense} {bar.limit:g}){'' if bar.met else ' **missed**'}"


def front_text(chart: Chart) -> str:
    """Return the points of the Pareto front, the quickest first."""
    front = pareto_front(chart.points)
    return (
        "; ".join(
            f"{point.curve} {point.label} ({point.error:.3g} {chart.unit}, {point.cpu:.3g} s)"
            for point in front
        )
        or "empty"
    )


def columns(chart: Chart) -> list[str]:
    """Return the head of the table of a chart."""
    extra = dict.fromkeys(name for point in chart.points for name in point.figures)
    return ["curve", "", "CPU s", "spread", "runs", f"error {chart.unit}", "faces", "crossings", *extra]


def cells(chart: Chart, point: Point) -> list[str]:
    """Return a row of that table."""
    error = f"{point.error:.3g}" if math.isfinite(point.error) else "broke down"
    label = f"{point.label} (preset)" if point.preset else point.label
    figures = [f"{point.figures[name]:.4g}" if name in point.figures else "" for name in columns(chart)[8:]]
    return [
        point.curve, label, f"{point.cpu:.3g}", f"{point.spread:.2g}", str(point.repeats), error,
        f"{point.faces:.0f}", str(point.crossings), *figures,
    ]  # fmt: skip


def picture_name(chart: Chart) -> str:
    """Return the file name of a chart's picture."""
    words = "".join(letter if letter.isalnum() else " " for letter in f"{chart.scene} {chart.title}").split()
    return f"speed_error_{'_'.join(words[:4]).lower()}.svg"


def _table(chart: Chart) -> str:
    head = columns(chart)
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(cells(chart, point)) + " |" for point in chart.points]
    return "\n".join(lines)
