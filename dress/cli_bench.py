"""The commands `toile bench` and `toile stress`."""

import argparse
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from toile.dress.cli_parser import DONE, MISSED, Commands, Parser, say_progress
from toile.geometry.errors import InputError

if TYPE_CHECKING:
    from toile.dress.benchmarks.remesh import Row
    from toile.dress.benchmarks.stress_row import StressRow


def add_bench(commands: "Commands[Parser]") -> None:
    """Add the bench command."""
    bench = commands.add_parser("bench", help="measure speed against error on reference scenes")
    bench.add_argument("study", choices=("remesh",), help="remesh: adaptive against uniform meshes")
    bench.add_argument("--scene", action="append", metavar="NAME", help="only this scene; repeat for more")
    bench.add_argument("--seconds", type=float, metavar="S", help="length of the films, instead of their own")
    bench.add_argument(
        "--repeats", type=int, default=1, metavar="N", help="repeat what is timed; medians count"
    )
    bench.add_argument("--json", type=Path, metavar="FILE", help="store the figures")
    bench.set_defaults(run=_run_bench)


def add_stress(commands: "Commands[Parser]") -> None:
    """Add the stress command."""
    stress = commands.add_parser("stress", help="run the hard cases and check every frame")
    stress.add_argument("case", nargs="*", metavar="NAME", help="only these cases (default: all)")
    stress.add_argument("--json", type=Path, metavar="FILE", help="store the figures")
    stress.add_argument("--pictures", type=Path, metavar="DIR", help="draw the end of every case")
    stress.set_defaults(run=_run_stress)


def _run_bench(options: argparse.Namespace) -> int:
    """Run a study; the exit code tells whether all its bars were met."""
    from toile.dress.benchmarks.remesh import FINEST, bench_scene, table

    _check_names("scene", options.scene or (), FINEST)
    if options.repeats < 1:
        raise InputError(f"--repeats must be at least 1, got {options.repeats}")
    rows = []
    for name in options.scene or FINEST:
        rows.append(bench_scene(name, options.seconds, options.repeats, say=say_progress))
        _store(rows, options.json)
    print(table(rows))
    return MISSED if any(row.missed() for row in rows) else DONE


def _run_stress(options: argparse.Namespace) -> int:
    """Run hard cases; the exit code tells whether all ended as expected."""
    from toile.dress.benchmarks.stress import STRESS_CASES, run_stress
    from toile.dress.benchmarks.stress_row import stress_table
    from toile.dress.writers.atomic import writable_folder

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
    from toile.dress.suggestion import unknown_name

    for name in names:
        if name not in known:
            raise InputError(unknown_name(kind, name, known))


def _store(rows: "Sequence[Row] | Sequence[StressRow]", path: Path | None) -> None:
    """Write the figures of a study to a file, if there is one."""
    import json
    from dataclasses import asdict

    if path is not None:
        path.write_text(json.dumps([asdict(row) for row in rows], indent=2) + "\n")
