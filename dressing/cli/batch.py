"""The command `toile batch`: run, status, export and gallery."""

import argparse
import sys
import time
from collections.abc import Callable, Generator
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from toile.dressing.cli.parser import CANCELLED, DONE, FAILED, MISSED, Commands, Parser, say_progress
from toile.geometry.errors import InputError

if TYPE_CHECKING:
    from toile.dressing.batch.batch import JobResult
    from toile.dressing.batch.batch_progress import BatchProgress
    from toile.dressing.batch.job_grid import JobGrid
    from toile.dressing.batch.jobs_file import JobsFile
    from toile.dressing.run.interrupt import CancelOnInterrupt

EPILOG = """\
examples:
  toile batch --avatars 'bodies/*.ply' --garments tshirt trousers --quality preview -o out
  toile batch --jobs jobs.csv --job-timeout 900 --job-memory 3 -o out
  toile batch status out
  toile batch export out results.csv
  toile batch gallery out

The same command again resumes the batch. Ctrl-C waits for running jobs; a second one ends them.
exit codes: 0 every job is done, 1 some failed, 2 bad input, 3 the batch had to stop, 130 cancelled

"""
COLUMN_HELP = """\
columns of a CSV jobs file, and keys of its JSON lines:
  name           name of the job and its folder (default: body and garments)
  avatar         file of the body, relative to the jobs file (default: the built-in mannequin)
  garment        files or built-in names, from the body outwards, separated by ';'
  fabric         preset of all garments, or one for each, separated by ';'
  quality, edge_length, remesh, max_frames, gravity, friction
  units, up, front, fps, time, clip, lead_in of the body's file; only, without: its parts, separated by ';'
  measurements   file of the body's measurements; height, chest, waist, hip [m] of the mannequin
JSON lines may hold all keys of a scene file instead (toile dress --scene-keys)."""


def add_batch(commands: "Commands[Parser]") -> None:
    """Add the batch command."""
    batch = commands.add_parser(
        "batch",
        help="dress many garments on many bodies, each in a process of its own",
        description="Dress many garments on many bodies, each in a process of its own, with a ledger.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    batch.add_argument(
        "--avatars", nargs="+", default=[], metavar="GLOB", help="bodies, or the word mannequin"
    )
    batch.add_argument(
        "--garments", nargs="+", default=[], metavar="GLOB", help="patterns, meshes or built-in names"
    )
    batch.add_argument("--fabrics", nargs="+", default=[], metavar="NAME", help="presets, one job for each")
    batch.add_argument("--jobs", type=Path, metavar="FILE", help=".csv or .jsonl file with one job per line")
    batch.add_argument("--quality", metavar="WORD", help="preview, standard (default) or accurate")
    batch.add_argument("--max-frames", type=int, metavar="N", help="frames after which a drape stops")
    batch.add_argument("--workers", type=int, metavar="N", help="jobs at a time (default: one per core)")
    batch.add_argument("--threads", type=int, metavar="N", help="threads that share each job (default: 1)")
    batch.add_argument("--job-timeout", type=float, metavar="S", help="wall time that a job may take [s]")
    batch.add_argument("--job-memory", type=float, metavar="GB", help="memory that a job may take [GB]")
    batch.add_argument("--retry", choices=("failed",), help="run failed jobs again")
    batch.add_argument("--dask", metavar="ADDRESS", help="run on Dask: tcp://host:port, or the word local")
    batch.add_argument(
        "--ship", action="store_true", help="send input files to Dask's workers, which do not see this disk"
    )
    batch.add_argument("--quiet", action="store_true", help="print nothing but errors")
    batch.add_argument("-o", "--output", type=Path, metavar="DIR", help="the batch's folder")
    batch.set_defaults(run=_run_batch)
    batch.epilog = EPILOG + COLUMN_HELP
    more = batch.add_subparsers(title="commands on a batch's folder", metavar="COMMAND", parser_class=Parser)
    for name, help_text, run in (
        ("status", "print the state of the batch, also while it runs", _run_status),
        ("export", "write its table to a .csv or .parquet file", _run_export),
        ("gallery", "write pages that show its results", _run_gallery),
    ):
        command = more.add_parser(name, help=help_text)
        command.add_argument("folder", type=Path, metavar="DIR", help="the batch's folder")
        if name == "export":
            command.add_argument("table", type=Path, metavar="FILE", help=".csv or .parquet file")
        command.set_defaults(run=run)


def _run_batch(options: argparse.Namespace) -> int:
    """Run a batch; the exit code tells whether every job is done."""
    from toile.dressing.batch.batch_progress import BatchProgress
    from toile.dressing.batch.batch_stopped import BatchStopped
    from toile.dressing.run.interrupt import CancelOnInterrupt
    from toile.dressing.run.progress import LinePrinter

    if options.output is None:
        raise InputError("give the batch's folder with -o DIR", field="--output")
    jobs = _jobs_of(options)
    progress = BatchProgress(len(jobs))
    printer = LinePrinter(sys.stderr, quiet=options.quiet)
    say = (lambda text: None) if options.quiet else say_progress

    def watch(running: int) -> None:
        printer.show(progress.line(running), progress.seconds)

    for note in getattr(jobs, "notes", ()):
        say(note)
    try:
        with CancelOnInterrupt() as interrupt, closing(_results(options, jobs, interrupt, watch)) as results:
            for result in results:
                outcome = result.outcome
                progress.count(outcome.state, outcome.failure_class, skipped=result.skipped)
                if outcome.state == "failed" and not result.skipped:
                    printer.close()
                    say(f"{result.name}: {outcome.failure_class}: {outcome.message}")
    except BatchStopped as error:
        printer.close()
        print(f"toile: {error}", file=sys.stderr)
        return FAILED
    finally:
        printer.close()
    if interrupt.requested:
        print(f"toile: cancelled; the same command resumes: {_summary(progress, options)}", file=sys.stderr)
        return CANCELLED
    if not options.quiet:
        print(_summary(progress, options))
    return MISSED if progress.states["failed"] else DONE


def _jobs_of(options: argparse.Namespace) -> "JobsFile | JobGrid":
    """Return the jobs that the options mean."""
    given = {
        name: value
        for name in ("quality", "max_frames", "threads")
        if (value := getattr(options, name)) is not None
    }
    if options.jobs is not None:
        if options.avatars or options.garments or options.fabrics:
            raise InputError(
                "--jobs names bodies, garments and fabrics itself; leave the other options out",
                field="--jobs",
            )
        from toile.dressing.batch.jobs_file import JobsFile

        return JobsFile(options.jobs, given)
    if not options.garments:
        raise InputError("nothing to dress: give --garments or --jobs", field="--garments")
    from toile.dressing.batch.job_grid import JobGrid

    return JobGrid(options.avatars, options.garments, options.fabrics, given)


def _results(
    options: argparse.Namespace,
    jobs: "JobsFile | JobGrid",
    interrupt: "CancelOnInterrupt",
    watch: "Callable[[int], None]",
) -> "Generator[JobResult, None, None]":
    """Return the results of a batch as they come."""
    from toile.dressing.batch.batch import batch

    return batch(
        jobs,
        options.output,
        workers=options.workers,
        job_timeout=options.job_timeout,
        job_memory=options.job_memory,
        retry_failed=options.retry == "failed",
        dask=options.dask,
        ship=options.ship,
        stop=lambda: interrupt.requested,
        watch=watch,
        say=None if options.quiet else say_progress,
    )


def _summary(progress: "BatchProgress", options: argparse.Namespace) -> str:
    """Return the last line that a user sees."""
    from toile.dressing.batch.batch_progress import failures_text

    failed = f", {progress.states['failed']} failed" if progress.states["failed"] else ""
    classes = f" ({failures_text(progress.failures)})" if progress.failures else ""
    skipped = f"; {progress.skipped} of them earlier" if progress.skipped else ""
    return (
        f"{progress.states['done']} done{failed}{classes}{skipped}, {progress.seconds:.1f} s; "
        f"in {options.output} (see toile batch status, export and gallery)"
    )


def _run_status(options: argparse.Namespace) -> int:
    """Print where a batch stands."""
    from toile.dressing.batch.status import status_text

    print(status_text(options.folder))
    return DONE


def _run_export(options: argparse.Namespace) -> int:
    """Write a batch's table."""
    from toile.dressing.batch.batch_progress import jobs_text
    from toile.dressing.batch.export import export

    print(f"wrote {options.table}: {jobs_text(export(options.folder, options.table))}")
    return DONE


def _run_gallery(options: argparse.Namespace) -> int:
    """Write a batch's pages."""
    from toile.dressing.batch.batch_progress import jobs_text
    from toile.dressing.batch.gallery.write_gallery import write_gallery
    from toile.dressing.run.progress import LinePrinter

    printer = LinePrinter(sys.stderr)
    started = time.monotonic()
    try:
        page = write_gallery(
            options.folder, lambda count: printer.show(jobs_text(count), time.monotonic() - started)
        )
    finally:
        printer.close()
    print(f"wrote {page}; open it in a browser")
    return DONE
