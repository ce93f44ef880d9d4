"""The commands `toile bench` and `toile stress`."""

import argparse
from collections.abc import Collection, Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from toile.dressing.cli.film import add_film_options, run_film, run_memory
from toile.dressing.cli.parser import DONE, MISSED, Commands, Parser, say_progress
from toile.geometry.errors import InputError

if TYPE_CHECKING:
    from toile.studies.adaptive.remesh import Row
    from toile.studies.stress.stress_row import StressRow


DESCRIPTION = """\
toile bench [NAME ...]  error against CPU time of the scenes cantilever, swing, hang, sphere, shirt
toile bench compare OLD.json NEW.json  regressions in time or accuracy between two stored reports
toile bench remesh      adaptive against uniform meshes
toile bench film [walk] [skirt] [layers]  what garments on moving bodies cost, this version beside another
toile bench live        steps of cloth that is played with, and what a hand does to it
toile bench live latency streaming memory  its page: pointer to pixel (extra browser, and Chromium), CPU
                        time of 60 frames/s, memory over 10 minutes
toile bench memory      whether the memory of a long film stays flat

The exit code is 1 if a bar is missed or a point has become worse."""

REPORT_OPTIONS = ("quick", "repeats", "out", "json")
OWN_OPTIONS = {
    "remesh": ("repeats", "json", "scene", "seconds"),
    "compare": ("ratio",),
    "film": ("repeats", "json", "against", "blender", "still", "avatar", "garment", "quality", "frames"),
    "live": ("json", "seconds"),
    "memory": ("frames",),
}
"""Options that the report takes, and those of the other studies."""


def add_bench(commands: "Commands[Parser]") -> None:
    """Add the bench command."""
    bench = commands.add_parser(
        "bench",
        help="measure speed against error on reference scenes",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    bench.add_argument(
        "name", nargs="*", metavar="NAME", help="scenes, or remesh, compare OLD NEW, film, memory"
    )
    bench.add_argument(
        "--quick",
        action="store_true",
        help="coarser meshes, fewer points: minutes instead of most of an hour",
    )
    bench.add_argument("--repeats", type=int, metavar="N", help="repeat timed runs N times and take medians")
    bench.add_argument("--out", type=Path, metavar="DIR", help="write speed_error.html, .md and .json there")
    bench.add_argument("--json", type=Path, metavar="FILE", help="store the figures")
    bench.add_argument(
        "--ratio",
        type=float,
        metavar="R",
        help="compare: tolerated growth of time or error (default 1.25)",
    )
    bench.add_argument(
        "--scene", action="append", metavar="NAME", help="remesh: only this scene; repeat for more"
    )
    bench.add_argument(
        "--seconds",
        type=float,
        metavar="S",
        help="remesh: length of the films instead of the scenes' own; live: time that its page is measured",
    )
    add_film_options(bench)
    bench.set_defaults(run=_run_bench)


def add_stress(commands: "Commands[Parser]") -> None:
    """Add the stress command."""
    stress = commands.add_parser("stress", help="run the hard cases and audit every frame")
    stress.add_argument("case", nargs="*", metavar="NAME", help="only these cases (default: all)")
    stress.add_argument("--json", type=Path, metavar="FILE", help="store the figures")
    stress.add_argument("--pictures", type=Path, metavar="DIR", help="write a picture of every case's end")
    stress.set_defaults(run=_run_stress)


def _run_bench(options: argparse.Namespace) -> int:
    """Run the study that is named; the exit code tells whether all is well."""
    from toile.dressing.cli.report import run_compare, run_report

    study = options.name[0] if options.name else ""
    if options.repeats is not None and options.repeats < 1:
        raise InputError(f"--repeats must be at least 1, got {options.repeats}", field="--repeats")
    own = OWN_OPTIONS.get(study, REPORT_OPTIONS)
    for option in sorted({*REPORT_OPTIONS, *chain(*OWN_OPTIONS.values())} - {*own}):
        if getattr(options, option):
            raise InputError(
                f"--{option} does not apply to toile bench {study}".rstrip() + "; see toile bench --help",
                field=f"--{option}",
            )
    if study == "compare":
        return run_compare(options.name[1:], options.ratio)
    if study == "film":
        return run_film(options)
    if study == "memory":
        return run_memory(options)
    if study == "live":
        return _run_live_bench(options)
    if study == "remesh":
        if len(options.name) > 1:
            raise InputError(f"remesh takes no names; choose scenes with --scene, not '{options.name[1]}'")
        return _run_remesh(options)
    return run_report(options)


def _run_live_bench(options: argparse.Namespace) -> int:
    """Measure live cloth; the exit code tells whether all bars were met."""
    import json
    from dataclasses import asdict

    from toile.studies.live.bench_live import SCENES, as_json, bench_live, live_table
    from toile.studies.live.bench_page import PAGE_STUDIES, bench_page
    from toile.studies.live.page_row import page_table

    names = options.name[1:] or list(SCENES)
    _check_names("scene", names, [*SCENES, *PAGE_STUDIES])
    rows, figures = [], []
    for row in bench_live(name for name in names if name in SCENES):
        say_progress(f"{row.scene}: {row.median:.1f} ms")
        rows.append(row)
    for figure in bench_page((name for name in names if name in PAGE_STUDIES), options.seconds):
        say_progress(f"{figure.name}: {figure.value:.1f} {figure.unit}")
        figures.append(figure)
    if options.json is not None:
        kept = [*as_json(rows), *(asdict(one) | {"missed": one.missed()} for one in figures)]
        options.json.write_text(json.dumps(kept, indent=2) + "\n")
    print("\n".join(text for text in (live_table(rows) if rows else "", page_table(figures)) if text))
    missed = [row.missed() for row in rows] + [figure.missed() for figure in figures]
    return MISSED if any(missed) else DONE


def _run_remesh(options: argparse.Namespace) -> int:
    """Compare adaptive and uniform meshes; the exit code tells whether all bars were met."""
    from toile.studies.adaptive.remesh import FINEST, bench_scene, table

    _check_names("scene", options.scene or (), FINEST)
    rows = []
    for name in options.scene or FINEST:
        rows.append(bench_scene(name, options.seconds, options.repeats or 1, say=say_progress))
        _store(rows, options.json)
    print(table(rows))
    return MISSED if any(row.missed() for row in rows) else DONE


def _run_stress(options: argparse.Namespace) -> int:
    """Run hard cases; the exit code tells whether all ended as expected."""
    from toile.dressing.files.writers.atomic import writable_folder
    from toile.studies.stress.stress import STRESS_CASES, run_stress
    from toile.studies.stress.stress_row import stress_table

    _check_names("case", options.case, STRESS_CASES)
    pictures = None if options.pictures is None else writable_folder(options.pictures)
    done: list[StressRow] = []

    def keep(row: "StressRow") -> None:
        done.append(row)
        _store(done, options.json)
        say_progress(f"{row.case}: {row.outcome}, {row.cpu:.1f} CPU s")

    rows = run_stress(options.case or list(STRESS_CASES), keep, pictures)
    print(stress_table(rows))
    return MISSED if any(row.fell_short for row in rows) else DONE


def _check_names(kind: str, names: Sequence[str], known: Collection[str]) -> None:
    """Raise InputError with the nearest name for the first that is not known."""
    from toile.dressing.files.suggestion import unknown_name

    for name in names:
        if name not in known:
            raise InputError(unknown_name(kind, name, known))


def _store(rows: "Sequence[Row] | Sequence[StressRow]", path: Path | None) -> None:
    """Write the figures of a study to a file, if there is one."""
    import json
    from dataclasses import asdict

    if path is not None:
        path.write_text(json.dumps([asdict(row) for row in rows], indent=2) + "\n")
