"""`toile bench film` and `toile bench memory`: what garments on moving bodies cost."""

import argparse
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from toile.dressing.cli.parser import DONE, MISSED, say_progress
from toile.geometry.errors import InputError

if TYPE_CHECKING:
    from toile.studies.film.film_row import FilmRow
    from toile.studies.speed_error.point import Bar

REPEATS = 3
"""Timed runs of a film."""
MEMORY_FRAMES = 1000
"""Frames of the film whose memory is watched."""


def add_film_options(bench: argparse.ArgumentParser) -> None:
    """Add the options of films to those of the bench command."""
    bench.add_argument(
        "--against", metavar="REV|WHEEL", help="film: measure this git revision or wheel of toile as well"
    )
    bench.add_argument(
        "--blender", metavar="PYTHON", help="film: and the cloth of Blender, by a Python that can import bpy"
    )
    bench.add_argument("--still", action="store_true", help="film: drape on the body as it is at the start")
    bench.add_argument("--avatar", type=Path, metavar="BODY", help="film: a body instead of the built-in")
    bench.add_argument(
        "--garment", action="append", metavar="FILE|NAME", help="film: garments on BODY; repeat for layers"
    )
    bench.add_argument("--quality", metavar="WORD", help="film: preset (preview; standard with --still)")
    bench.add_argument("--frames", type=int, metavar="N", help="film, memory: frames after the first")


def run_film(options: argparse.Namespace) -> int:
    """Measure films; the exit code tells whether all bars were met. What is measured is kept on Ctrl-C."""
    from toile.dressing.run.quality import quality_preset
    from toile.dressing.run.report import versions
    from toile.studies.film.bench_film import Effort, bench_film
    from toile.studies.film.film_row import film_bars, film_table, store_rows
    from toile.studies.film.garment_film import FILMS, STILL_RATIO, given_film
    from toile.studies.film.toile_version import other_version, this_version
    from toile.studies.speed_error.machine import machine

    quality = options.quality or ("standard" if options.still else "preview")
    quality_preset(quality)
    _check_frames(options.frames)
    if options.blender and options.still:
        raise InputError("--blender measures films; leave out --still", field="--blender")
    films = [FILMS[name] for name in _film_names(options)]
    if options.avatar is not None:
        films = [given_film(options.avatar, tuple(options.garment or ("tshirt",)), options.still)]
    shown: dict[str, tuple[list[FilmRow], list[Bar]]] = {}
    facts = {"machine": machine(), "versions": versions()}

    def keep() -> tuple[list["FilmRow"], list["Bar"]]:
        rows = [row for part, _ in shown.values() for row in part]
        bars = [bar for _, part in shown.values() for bar in part]
        if options.json is not None:
            store_rows(options.json, rows, bars, facts)
        return rows, bars

    # Stored at once, so that an unwritable file is known before minutes are spent.
    keep()
    with ExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory(prefix="toile-bench-")))
        measured = [this_version()]
        if options.against is not None:
            measured.append(stack.enter_context(other_version(options.against)))
        effort = Effort(
            versions=tuple(measured), blender=options.blender, still=options.still, quality=quality,
            frames=options.frames, repeats=options.repeats or REPEATS, say=say_progress,
        )  # fmt: skip
        try:
            for film in films:
                ratio = STILL_RATIO if options.still else film.ratio
                for rows in bench_film(film, effort, folder):
                    shown[film.name] = rows, film_bars(rows, ratio)
                    keep()
        finally:
            if shown:
                print(film_table(*keep()), flush=True)
    return DONE if all(bar.met for bar in keep()[1]) else MISSED


def run_memory(options: argparse.Namespace) -> int:
    """Watch the memory of a long film; the exit code tells whether it stayed flat."""
    from toile.studies.film.film_memory import GROWTH_LIMIT, film_memory
    from toile.studies.speed_error.page_markdown import bar_text
    from toile.studies.speed_error.point import Bar

    if len(options.name) > 1:
        raise InputError(f"memory takes no names, got '{options.name[1]}'")
    _check_frames(options.frames)
    growth = film_memory(options.frames or MEMORY_FRAMES, say_progress)
    bar = Bar(claim="growth of resident memory [kB per frame]", value=growth, limit=GROWTH_LIMIT)
    print(bar_text(bar).replace("**", ""))
    return DONE if bar.met else MISSED


def _check_frames(frames: int | None) -> None:
    """Raise InputError for a number of frames that is none."""
    if frames is not None and frames < 1:
        raise InputError(f"--frames must be at least 1, got {frames}", field="--frames")


def _film_names(options: argparse.Namespace) -> list[str]:
    """Return the names of the films that are asked for. Raises InputError for others."""
    from toile.dressing.files.suggestion import unknown_name
    from toile.studies.film.garment_film import FILMS

    names = list(dict.fromkeys(options.name[1:]))
    for name in names:
        if name not in FILMS:
            raise InputError(unknown_name("film", name, FILMS))
    if options.avatar is not None and names:
        raise InputError(f"give --avatar or the film '{names[0]}', not both", field="--avatar")
    if options.avatar is None and options.garment:
        raise InputError("--garment goes with --avatar; built-in films have garments", field="--garment")
    return names or list(FILMS)
