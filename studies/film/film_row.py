"""A row of the film report: what a version needed for a film and how good it was; bars, table and file."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from toile.dressing.files.writers.atomic import write_atomic
from toile.geometry.errors import InputError
from toile.studies.film.toile_version import THIS
from toile.studies.speed_error.page_markdown import bar_text
from toile.studies.speed_error.point import Bar

FORMAT = "toile film report 1"
THREADS_RATIO = 1.6
"""How many times less wall time two threads must take than one."""
BLENDER = "Blender quality "
"""How the names of Blender's rows begin."""


@dataclass(frozen=True, kw_only=True)
class FilmRow:
    """A version of toile, or Blender, on a film; or on a drape, where what is per frame is in all.

    Attributes
    ----------
    film, version
        Names.
    still
        Whether it is a drape.
    frames, faces
        Frames after the first; most faces.
    repeats
        How often it was run: times are medians.
    cpu, cpu_spread, wall, wall_two_threads
        CPU time per frame, longest less shortest of it, wall time per frame in one thread and in two [s];
        None where the version cannot be told how many.
    steps, newton_iterations
        In all.
    crossings
        Pairs of triangles that cross in the worst frame, as audited.
    strain
        Largest strain in any frame [%]: along warp or weft, of edges in Blender.
    distance_rms, distance_max
        Distance of the same points of the pattern from the film in a quarter of the step, or from the drape
        at `accurate`, root mean square and largest [mm]; None where it was not measured.
    failure
        Why it failed, or empty.
    """

    film: str
    version: str
    still: bool
    frames: int
    faces: int
    repeats: int
    cpu: float
    cpu_spread: float
    wall: float | None
    wall_two_threads: float | None = None
    steps: int
    newton_iterations: int | None
    crossings: int
    strain: float
    distance_rms: float | None = None
    distance_max: float | None = None
    failure: str = ""


def film_bars(rows: Sequence[FilmRow], ratio: float | None) -> list[Bar]:
    """Return what this version must reach in one film, beside those of `rows` that are of others."""
    own = next((row for row in rows if row.version == THIS), None)
    if own is None:
        return []
    film = own.film
    bars = [
        Bar(claim=f"{film}: crossings in the worst frame", value=own.crossings, limit=0.0),
        Bar(claim=f"{film}: failures", value=float(bool(own.failure)), limit=0.0),
    ]
    if own.wall_two_threads and own.wall:
        bars.append(
            Bar(
                claim=f"{film}: wall time of one thread over that of two",
                value=own.wall / own.wall_two_threads, limit=THREADS_RATIO, at_least=True,
            )
        )  # fmt: skip
    for other in rows:
        name = other.version
        if other is own or other.failure:
            continue
        if name.startswith(BLENDER):
            if name == f"{BLENDER}5":
                claim = f"{film}: CPU s per frame, below {name}"
                bars.append(Bar(claim=claim, value=own.cpu, limit=other.cpu))
            continue
        if ratio is not None:
            bars.append(
                Bar(
                    claim=f"{film}: CPU time of {name} over this", value=other.cpu / own.cpu, limit=ratio,
                    at_least=True,
                )
            )  # fmt: skip
        bars.append(Bar(claim=f"{film}: strain [%], of {name} at most", value=own.strain, limit=other.strain))
        if own.distance_rms is not None and other.distance_rms is not None:
            claim = f"{film}: distance from its own fine result [mm], of {name} at most"
            bars.append(Bar(claim=claim, value=own.distance_rms, limit=other.distance_rms))
    return bars


def film_table(rows: Sequence[FilmRow], bars: Sequence[Bar]) -> str:
    """Return rows in Markdown, and below them what the bars say."""
    unit = "drape" if rows and rows[0].still else "frame"
    lines = [
        f"| film | version | CPU s per {unit} | spread | wall s, 1 thread | 2 threads | frames | faces "
        "| steps | Newton | crossings | strain % | off rms mm | off max mm | failure |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        cells = [
            row.film, row.version, _short(row.cpu), _short(row.cpu_spread), _short(row.wall),
            _short(row.wall_two_threads), str(row.frames), str(row.faces), str(row.steps),
            _short(row.newton_iterations), str(row.crossings), _short(row.strain), _short(row.distance_rms),
            _short(row.distance_max), row.failure,
        ]  # fmt: skip
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, "", *(bar_text(bar).replace("**", "") for bar in bars)]).rstrip()


def store_rows(
    path: Path, rows: Sequence[FilmRow], bars: Sequence[Bar], facts: Mapping[str, Mapping[str, str]]
) -> None:
    """Write rows, bars and facts of the machine as JSON. Raises InputError where that cannot be written."""
    content = {
        "format": FORMAT, **facts, "rows": [_plain(asdict(row)) for row in rows],
        "bars": [_plain(asdict(bar)) | {"met": bar.met} for bar in bars],
    }  # fmt: skip
    try:
        write_atomic(path, (json.dumps(content, indent=1, allow_nan=False) + "\n").encode())
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise InputError(
            f"{path}: cannot be written ({reason}); choose another with --json", file=path, field="--json"
        ) from None


def _short(value: float | None) -> str:
    """Return a number in three digits, nothing for None."""
    if value is None:
        return ""
    return str(value) if isinstance(value, int) else f"{value:.3g}"


def _plain(row: dict[str, Any]) -> dict[str, Any]:
    """Return a row as JSON holds it, in five digits, numbers that are not finite as null."""
    return {
        name: (float(f"{value:.5g}") if math.isfinite(value) else None) if isinstance(value, float) else value
        for name, value in row.items()
    }
