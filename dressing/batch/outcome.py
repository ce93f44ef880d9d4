"""The outcome of a job, as recorded beside its files, in the ledger and for the caller."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from toile.dressing.batch.failure_classes import FailureClass

FIGURES = {
    "status": ("TEXT", ("status",)),
    "frames": ("INTEGER", ("frames",)),
    "steps": ("INTEGER", ("steps",)),
    "nodes": ("INTEGER", ("nodes", "final")),
    "faces": ("INTEGER", ("faces", "final")),
    "contacts_max": ("INTEGER", ("contacts_max",)),
    "avatar_intersections": ("INTEGER", ("intersections", "avatar")),
    "self_intersections": ("INTEGER", ("intersections", "self")),
    "worst_frame_intersections": ("INTEGER", ("intersections", "worst_frame")),
    "min_gap_mm": ("REAL", ("min_gap_mm",)),
    "warp_strain_max": ("REAL", ("strain_percent", "warp_max")),
    "weft_strain_max": ("REAL", ("strain_percent", "weft_max")),
    "strain_p99": ("REAL", ("strain_percent", "p99")),
    "residual": ("REAL", ("residual",)),
    "dress_cpu_seconds": ("REAL", ("cpu_seconds",)),
}
"""Columns of the ledger that come from report.json: their type, and where they stand in it."""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """Outcome of a job.

    Attributes
    ----------
    state
        "done": dressed, converged or at the frame limit; "failed"; "disk_full": nothing could be written,
        which is not the job's fault.
    failure_class, message
        Of a failed job; see failure_classes.py.
    version
        Of toile.
    published
        Whether the job has a folder with results.
    wall_seconds, cpu_seconds, peak_memory
        What the job's process used [s, bytes].
    figures
        From report.json, by the names in `FIGURES`.
    """

    state: Literal["done", "failed", "disk_full"]
    failure_class: FailureClass | Literal[""] = ""
    message: str = ""
    version: str = ""
    published: bool = False
    wall_seconds: float = 0.0
    cpu_seconds: float = 0.0
    peak_memory: int = 0
    figures: Mapping[str, Any] = field(default_factory=dict)


def figures_of(report: Mapping[str, Any]) -> dict[str, Any]:
    """Return the figures of a report by the names of their columns."""
    found = {}
    for column, (_, path) in FIGURES.items():
        value: Any = report
        for key in path:
            value = value[key]
        found[column] = value
    return found
