"""The work of a job's process: dress, record the outcome, publish the results."""

import sys
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

from toile.dressing.batch.failure_classes import death, disk_is_full
from toile.dressing.batch.job_folder import RESULTS, keep_log, own_folder, publish, published, tidy
from toile.dressing.batch.outcome import Outcome, figures_of
from toile.dressing.batch.processes.isolated_call import Ended, Limits
from toile.dressing.run.kernels import (
    DRAPE_KERNELS,
    PANEL_KERNELS,
    PICTURE_KERNELS,
    REMESH_KERNELS,
    load_kernels,
)
from toile.dressing.run.scene import Scene
from toile.geometry.errors import InputError

VERSION = version("toile")
"""Of the program; read once, since it takes milliseconds."""
NOTHING_FREE = "nothing more can be written: the disk is full"


@dataclass(frozen=True, kw_only=True)
class JobRequest:
    """Request to a job's process: scene, name, fingerprint, the batch's folder, where to work.

    `attempt` counts how often it was asked in this run.
    """

    name: str
    scene: Scene
    fingerprint: str
    folder: Path
    work: Path
    attempt: int = 1


JOB_MODULES = (
    "run.dress", "wear.put_on", "pictures.preview", "body.measure", "body.mannequin", "pattern.garmentcode",
    "batch.thumbnail",
)  # fmt: skip
"""Modules of the dressing package that jobs import late, loaded once before they are forked."""


def load_dressing() -> None:
    """Load all that jobs need, in the process that starts them; kernels are compiled if they never were."""
    load_kernels(DRAPE_KERNELS + PANEL_KERNELS + REMESH_KERNELS + PICTURE_KERNELS)
    for name in JOB_MODULES:
        import_module(f"toile.dressing.{name}")


def dress_job(request: JobRequest) -> Outcome:
    """Dress the scene of a job and publish its results; failures are outcomes too."""
    from toile.dressing.batch.thumbnail import write_thumbnail
    from toile.dressing.run.dress import dress

    def work(request: JobRequest) -> Outcome:
        result = dress(request.scene, request.work)
        write_thumbnail(request.work)
        failure = result.report["failure"]
        return Outcome(
            state="failed" if result.status == "failed" else "done",
            failure_class=failure["class"] if failure else "",
            message=f"{failure['message']} ({failure['where']})" if failure else "",
            published=True,
            figures=figures_of(result.report),
        )

    return run_job(request, work)


def run_job(request: JobRequest, work: Callable[[JobRequest], Outcome]) -> Outcome:
    """Do a job's work in a folder of its own; errors become outcomes, and results are published."""
    started = time.monotonic()
    try:
        request = replace(request, work=own_folder(request.work))
        outcome = _used(_attempt(request, work), started)
        if outcome.published:
            publish(request.folder, request.work, request.name, request.fingerprint, outcome)
        return outcome
    except OSError as error:
        if disk_is_full(error):
            return Outcome(state="disk_full", message=NOTHING_FREE)
        raise


def _attempt(request: JobRequest, work: Callable[[JobRequest], Outcome]) -> Outcome:
    """Return the outcome of some work, or that of the error it raised; a full disk is raised."""
    try:
        return work(request)
    except MemoryError:
        return Outcome(state="failed", failure_class="memory", message="needs more memory than it may have")
    except Exception as error:
        if disk_is_full(error):
            raise OSError(28, NOTHING_FREE) from error
        message = " ".join(str(error).split())
        if isinstance(error, InputError):
            return Outcome(state="failed", failure_class="bad_input", message=message)
        traceback.print_exc()
        return Outcome(state="failed", failure_class="fault", message=f"{type(error).__name__}: {message}")


def _used(outcome: Outcome, started: float) -> Outcome:
    """Return an outcome with what this process has used so far."""
    # Windows has no such module, and runs no jobs.
    import resource

    usage = resource.getrusage(resource.RUSAGE_SELF)
    return replace(
        outcome,
        version=VERSION,
        wall_seconds=round(time.monotonic() - started, 4),
        cpu_seconds=round(usage.ru_utime + usage.ru_stime, 4),
        peak_memory=usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024),
    )


def settled(request: JobRequest, ended: Ended, limits: Limits) -> Outcome:
    """Return the outcome of a job whose process has ended, and tidy up behind it."""
    outcome: Outcome | None
    if ended.how == "returned":
        outcome = ended.value
    elif (outcome := published(request.folder, request.name, request.fingerprint)) is not None:
        # It was killed after its results were in place.
        pass
    else:
        failure_class, message = death(ended.exit_status, ended.peak_memory, limits.memory)
        if ended.how == "timeout":
            failure_class, message = "timeout", f"stopped after {limits.seconds:g} s"
        elif ended.how == "lost":
            failure_class, message = "killed", "the process that had started it was killed"
        outcome = Outcome(
            state="failed",
            failure_class=failure_class,
            message=message,
            version=VERSION,
            wall_seconds=round(ended.wall_seconds, 4),
            cpu_seconds=round(ended.cpu_seconds, 4),
            peak_memory=ended.peak_memory,
        )
    keep_log(request.folder, request.name, ended.printed)
    tidy(request.work)
    return outcome


def result_folder(folder: Path, name: str) -> Path:
    """Return where the results of a job are."""
    return folder / RESULTS / name
