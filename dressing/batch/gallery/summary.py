"""The summary page of a batch: finish rate, failures, distributions, slowest jobs."""

import heapq
from array import array
from collections import Counter
from html import escape
from typing import Any

from toile.dressing.batch.failure_classes import FAILURE_CLASSES, FailureClass
from toile.dressing.batch.gallery.histogram import histogram
from toile.dressing.run.progress import clock

MEASURED = {
    "cpu_seconds": ("CPU time", "s", 1.0),
    "peak_memory": ("Peak memory", "MB", 1e-6),
    "strain_p99": ("Strain along the threads, 99th percentile", "%", 1.0),
    "min_gap_mm": ("Smallest gap", "mm", 1.0),
    "faces": ("Triangles of cloth", "", 1.0),
}
"""Columns whose distributions are shown: title, unit, and factor from the ledger's."""
SLOWEST = 20
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title} - summary</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="stylesheet" href="style.css"></head>
<body class="summary">
<header><h1>{title}</h1>
<nav><a href="index.html">Gallery</a> <a aria-current="page">Summary</a></nav></header>
<main>
<section class="figures">{figures}</section>
<section><h2>Failures</h2>{failures}</section>
<section><h2>Distributions</h2><div class="charts">{charts}</div></section>
<section><h2>Slowest jobs</h2>{slowest}</section>
</main></body></html>
"""


class Summary:
    """Collects rows of a ledger, and makes a page of them."""

    def __init__(self) -> None:
        self._states: Counter[str] = Counter()
        self._statuses: Counter[str] = Counter()
        self._failures: Counter[FailureClass] = Counter()
        self._crossing = 0
        self._cpu = 0.0
        self._values = {column: array("d") for column in MEASURED}
        self._slowest: list[tuple[float, str, str]] = []

    def add(self, row: dict[str, Any]) -> None:
        """Take a row in."""
        self._states[row["state"]] += 1
        if row["state"] == "failed":
            self._failures[row["failure_class"]] += 1
        if row["state"] == "done":
            self._statuses[row["status"]] += 1
            self._crossing += bool(row["worst_frame_intersections"])
        seconds = row["cpu_seconds"] or 0.0
        self._cpu += seconds
        for column, values in self._values.items():
            if row[column] is not None and (
                row["state"] == "done" or column in ("cpu_seconds", "peak_memory")
            ):
                values.append(row[column] * MEASURED[column][2])
        heapq.heappush(self._slowest, (seconds, row["name"], row["failure_class"] or row["status"] or ""))
        if len(self._slowest) > SLOWEST:
            heapq.heappop(self._slowest)

    def page(self, title: str) -> str:
        """Return the page."""
        charts = "".join(
            histogram(name, unit, self._values[column]) for column, (name, unit, _) in MEASURED.items()
        )
        return PAGE.format(
            title=escape(title),
            figures=self._figures(),
            failures=self._failure_table(),
            charts=charts or "<p>Nothing was measured yet.</p>",
            slowest=self._slowest_table(),
        )

    def _figures(self) -> str:
        """Return the first figures: jobs, finish rate, crossings, time."""
        count = sum(self._states.values())
        ended = self._states["done"] + self._states["failed"]
        done, converged = self._states["done"], self._statuses["converged"]
        rate = f"{100.0 * done / ended:.1f} %" if ended else "-"
        figures = [
            (f"{count}", "jobs"),
            (rate, f"finished: {done} of {ended}"),
            (f"{converged}", f"converged; {done - converged} at the frame limit"),
            (f"{self._crossing}", "finished with a crossing in an output frame"),
            (f"{count - ended}", "open"),
            (clock(self._cpu), "CPU time in all"),
        ]
        return "".join(
            f"<div><b>{escape(value)}</b><span>{escape(what)}</span></div>" for value, what in figures
        )

    def _failure_table(self) -> str:
        """Return failure classes by count, with what they mean."""
        if not self._failures:
            return "<p>None.</p>"
        lines = [
            f'<tr><td>{count}</td><td><a href="index.html#class={escape(name)}">{escape(name)}</a></td>'
            f"<td>{escape(FAILURE_CLASSES.get(name, ''))}</td></tr>"
            for name, count in self._failures.most_common()
        ]
        return f"<table><tr><th>Jobs</th><th>Class</th><th>Meaning</th></tr>{''.join(lines)}</table>"

    def _slowest_table(self) -> str:
        """Return the slowest jobs."""
        lines = [
            f'<tr><td>{seconds:.1f} s</td><td><a href="view.html#{escape(name)}">{escape(name)}</a></td>'
            f"<td>{escape(how)}</td></tr>"
            for seconds, name, how in sorted(self._slowest, reverse=True)
        ]
        return f"<table><tr><th>CPU time</th><th>Job</th><th>Ended</th></tr>{''.join(lines)}</table>"
