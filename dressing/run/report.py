"""report.json: the figures of a drape, for people, scripts and tables."""

import json
import math
import platform
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from toile.dressing.wear.drape_types import DrapeFigures, DrapeOptions, Failure, Status

STAGES = ("assembly", "solve", "contact", "remesh", "io", "compile")


@dataclass(frozen=True, kw_only=True)
class RunSeconds:
    """Time of a drape [s]: wall and CPU time in all, wall time of reading and of loading kernels."""

    wall: float
    cpu: float
    io: float
    compile: float


def drape_report(
    *,
    status: Status,
    failure: Failure | None,
    figures: DrapeFigures,
    quality: str,
    options: DrapeOptions,
    avatar: dict[str, Any],
    garments: list[dict[str, Any]],
    seconds: RunSeconds,
) -> dict[str, Any]:
    """Return the report as plain data, numbers that are not finite replaced by None."""
    stages = {stage: 0.0 for stage in STAGES} | dict(figures.stage_seconds)
    stages["io"] += seconds.io
    stages["compile"] += seconds.compile
    report = {
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
        "avatar": avatar,
        "garments": [
            facts | {"area_m2": area, "cut_area_m2": cut}
            for facts, (area, cut) in zip(garments, figures.areas, strict=True)
        ],
        "wall_seconds": seconds.wall,
        "cpu_seconds": seconds.cpu,
        "stage_seconds": stages,
        "versions": versions(),
    }
    plain: dict[str, Any] = _plain(report)
    return plain


def with_animation(
    report: dict[str, Any], status: Status, failure: Failure | None, figures: dict[str, Any],
    stage_seconds: dict[str, float], wall_seconds: float, cpu_seconds: float,
) -> dict[str, Any]:  # fmt: skip
    """Return the report of a drape whose garments then followed their avatar, with the figures of that."""
    stages = dict(report["stage_seconds"])
    for stage, seconds in stage_seconds.items():
        stages[stage] = stages.get(stage, 0.0) + seconds
    plain: dict[str, Any] = _plain(
        report
        | {
            "status": status,
            "failure": _failure_facts(failure) if failure is not None else report["failure"],
            "animation": figures,
            "wall_seconds": report["wall_seconds"] + wall_seconds,
            "cpu_seconds": report["cpu_seconds"] + cpu_seconds,
            "stage_seconds": stages,
        }
    )
    return plain


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
