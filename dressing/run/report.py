"""report.json: the figures of a drape, for people, scripts and tables."""

import json
import math
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from toile.dressing.wear.drape_types import DrapeFigures, DrapeOptions, Failure, Status
from toile.geometry.stage_clock import Spent, together

STAGES = ("assembly", "solve", "contact", "avatar", "remesh", "audit", "io", "compile")
"""What time is booked under; what is not is `other`, so that the stages add up to the whole run."""
SCHEMA = 1
"""Of reports, see `output/report.schema.json`: raised when a key goes, or changes its meaning."""
OTHER = "other"


@dataclass(frozen=True, kw_only=True)
class RunSpent:
    """Time of a drape: in all, of reading, and of loading kernels."""

    total: Spent
    io: Spent
    compile: Spent


def drape_report(
    *,
    status: Status,
    failure: Failure | None,
    figures: DrapeFigures,
    quality: str,
    options: DrapeOptions,
    avatar: dict[str, Any],
    garments: list[dict[str, Any]],
    spent: RunSpent,
    inputs: Sequence[Mapping[str, str]] = (),
) -> dict[str, Any]:
    """Return the report as plain data, numbers that are not finite replaced by None."""
    stages = together(figures.stages, {"io": spent.io, "compile": spent.compile})
    report = {
        "schema": SCHEMA,
        "status": status,
        "failure": None if failure is None else _failure_facts(failure),
        "quality": quality,
        "edge_length": options.edge_length if options.sizing is None else options.sizing.size_min,
        "tolerance": options.tolerance,
        "frames": figures.frames,
        "simulated_seconds": figures.simulated_seconds,
        "steps": figures.steps,
        "newton_iterations": figures.newton_iterations,
        "cg_iterations": figures.cg_iterations,
        "nodes": _counts(figures.nodes),
        "faces": _counts(figures.faces),
        "contacts_max": figures.contacts_max,
        "intersections": {
            "avatar": figures.avatar_intersections,
            "self": figures.self_intersections,
            "worst_frame": figures.worst_frame_intersections,
        },
        "min_gap_mm": figures.min_gap_mm,
        "strain_percent": {
            "warp_max": figures.warp_strain_max,
            "weft_max": figures.weft_strain_max,
            "p99": figures.strain_p99,
            "over_50": [vars(place) for place in figures.strained],
        },
        "residual": figures.residual,
        "remeshing": {
            "passes": figures.remeshings,
            "splits": figures.splits,
            "flips": figures.flips,
            "collapses": figures.collapses,
            "energy_jump_max": figures.energy_jump_max,
            "pop_mm": 1e3 * figures.pop,
        },
        "inputs": [dict(entry) for entry in inputs],
        "avatar": avatar,
        "garments": [
            facts | {"area_m2": area, "cut_area_m2": cut}
            for facts, (area, cut) in zip(garments, figures.areas, strict=True)
        ],
        **_times(spent.total, stages),
        "versions": versions(),
    }
    plain: dict[str, Any] = _plain(report)
    return plain


def with_animation(
    report: dict[str, Any], status: Status, failure: Failure | None, figures: dict[str, Any],
    end: dict[str, Any], stages: Mapping[str, Spent], total: Spent,
) -> dict[str, Any]:  # fmt: skip
    """Return the report of a drape whose garments then followed their avatar.

    `figures` are those of the film, `end` says how the garments are at its end: with keys of the report,
    whose values so far, those of the drape, come under `drape`.
    """
    before = {
        stage: Spent(cpu, report["stage_wall_seconds"][stage])
        for stage, cpu in report["stage_cpu_seconds"].items()
        if stage != OTHER
    }
    whole = Spent(report["cpu_seconds"], report["wall_seconds"]).plus(total)
    drape = {"status": report["status"]} | {key: report[key] for key in end}
    plain: dict[str, Any] = _plain(
        report
        | end
        | {
            "status": status,
            "failure": _failure_facts(failure) if failure is not None else report["failure"],
            "animation": figures,
            "drape": drape,
        }
        | _times(whole, together(before, stages))
    )
    return plain


def _times(total: Spent, stages: Mapping[str, Spent]) -> dict[str, Any]:
    """Return CPU and wall time [s] in all and per stage: stages add up to the total."""
    booked = {stage: Spent() for stage in STAGES} | dict(stages)
    booked[OTHER] = total.less(together(*({"": spent} for spent in booked.values()))[""])
    return {
        "cpu_seconds": total.cpu,
        "wall_seconds": total.wall,
        "stage_cpu_seconds": {stage: spent.cpu for stage, spent in booked.items()},
        "stage_wall_seconds": {stage: spent.wall for stage, spent in booked.items()},
    }


def _failure_facts(failure: Failure) -> dict[str, str]:
    """Return what the report says about a failure."""
    return {"class": failure.kind, "message": failure.message, "where": failure.where}


def report_bytes(report: dict[str, Any]) -> bytes:
    """Return the report as indented JSON."""
    return (json.dumps(report, indent=2, allow_nan=False) + "\n").encode()


def versions() -> dict[str, str]:
    """Return the versions of the program and of what it computes with."""
    found = {"python": platform.python_version()}
    for package in ("toile", "numpy", "scipy", "numba", "trimesh", "manifold3d", "python-fcl"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "unknown"
    return found


def _counts(counts: tuple[int, int, int]) -> dict[str, int]:
    """Return (initial, final, max) by name."""
    return dict(zip(("initial", "final", "max"), counts, strict=True))


def _plain(value: Any) -> Any:
    """Return the value with numpy numbers as Python's and infinities and NaN as None."""
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if hasattr(value, "item"):
        value = value.item()
    if isinstance(value, float):
        return round(value, 9) if math.isfinite(value) else None
    return value
