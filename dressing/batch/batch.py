"""The loop of a batch: it starts open jobs, collects their outcomes and keeps the ledger."""

import hashlib
import os
import sqlite3
from collections.abc import Callable, Generator, Iterable, Iterator, Sized
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from toile.dressing.batch.batch_stopped import BatchStopped
from toile.dressing.batch.dress_job import JobRequest, dress_job, load_dressing, result_folder, settled
from toile.dressing.batch.failure_classes import ATTEMPTS, disk_is_full
from toile.dressing.batch.fingerprint import Fingerprints
from toile.dressing.batch.folder_lock import check_system, lock_folder
from toile.dressing.batch.job import BadJob, Job, as_jobs, avatar_name, fabric_names
from toile.dressing.batch.job_folder import make_folders, published, remove_result, work_folder
from toile.dressing.batch.ledger import Entry, Ledger
from toile.dressing.batch.outcome import FIGURES, Outcome
from toile.dressing.batch.pool import Pool
from toile.dressing.batch.processes.isolated_call import Ended, Limits, PoolFailed
from toile.dressing.batch.processes.local_pool import LocalPool
from toile.dressing.batch.shipping_pool import ShippingPool
from toile.dressing.files.writers.atomic import writable_folder
from toile.dressing.run.garment_source import default_name
from toile.dressing.run.scene import Scene
from toile.geometry.errors import InputError
from toile.remesh.sizing.sizing import SizingOptions

TICK = 0.2
"""How often the loop looks whether it is to stop [s]."""
DISK_FULL = "the disk is full; finished jobs are kept: free some space, and the same call resumes the batch"
LEAST_MEMORY = 0.5
"""A job cannot do with less memory than this [GB]: the program itself takes 0.3."""


@dataclass(frozen=True, kw_only=True)
class JobResult:
    """Result of a job.

    Attributes
    ----------
    name
        The job's.
    outcome
        Its state ("done" or "failed"), failure class, message and figures.
    folder
        Where its results are; None if it has none.
    skipped
        Whether it had ended in an earlier run and was left alone.
    """

    name: str
    outcome: Outcome
    folder: Path | None
    skipped: bool = False


def batch(
    jobs: Iterable[Job | BadJob | Scene],
    output: str | Path,
    *,
    workers: int | None = None,
    job_timeout: float | None = None,
    job_memory: float | None = None,
    retry_failed: bool = False,
    dask: str | None = None,
    ship: bool = False,
    stop: Callable[[], bool] | None = None,
    watch: Callable[[int], None] | None = None,
    say: Callable[[str], None] | None = None,
) -> Generator[JobResult, None, None]:
    """Dress many scenes, each in a process of its own, and yield their outcomes as they end.

    Parameters
    ----------
    jobs
        Scenes, or jobs with names; taken one by one as there is room, so they may be generated.
    output
        The batch's folder: ledger, and a folder per result. The same call again resumes the batch: jobs
        that have ended are not run again unless their input has changed.
    workers
        Jobs at a time; None is one per core.
    job_timeout, job_memory
        Wall time [s] and memory [GB] that a job may take.
    retry_failed
        Run jobs again that failed.
    dask
        Address of a Dask scheduler on whose workers the jobs run, or "local" for a cluster on this machine.
    ship
        Send the input files along to Dask's workers and the results back; else both see the same files.
    stop
        Asked now and then; once it returns True no job is started, and those that run are waited for.
    watch
        Called several times a second with the number of jobs that run.
    say
        Called with a sentence for what a person should know.

    Yields
    ------
    JobResult
        One per job, in the order in which they end. Closing the iterator ends the jobs that run.

    Raises
    ------
    InputError
        If the folder, a limit or a job's name is at fault, or the system cannot fork.
    BatchStopped
        If the disk is full, or Dask's scheduler gone: finished jobs are kept, and the same call resumes.
    """
    check_system()
    limits = checked_limits(job_timeout, job_memory)
    count = checked_workers(workers)
    if ship and dask is None:
        raise InputError("ship sends files to Dask's workers; without dask there are none", field="ship")

    def open_pool(lock: int) -> Pool:
        if dask is not None:
            from toile.dressing.batch.processes.dask_pool import DaskPool

            pool = DaskPool(dask, count, load_dressing, say)
            return ShippingPool(pool) if ship else pool
        return LocalPool(count, load_dressing, say=say, inherited=[lock])

    folder = Path(output).absolute()
    return run_batch(jobs, folder, open_pool, limits, retry_failed, stop, watch=watch)


def checked_limits(seconds: float | None, gigabytes: float | None) -> Limits:
    """Return the limits of a job. Raises InputError if one is too small to be meant."""
    if seconds is not None and not seconds > 0.0:
        raise InputError(
            f"job_timeout must be greater than zero seconds, got {seconds:g}", field="job_timeout"
        )
    if gigabytes is not None and not gigabytes >= LEAST_MEMORY:
        raise InputError(
            f"job_memory must be at least {LEAST_MEMORY:g} GB, got {gigabytes:g}", field="job_memory"
        )
    return Limits(seconds=seconds, memory=None if gigabytes is None else int(1e9 * gigabytes))


def checked_workers(workers: int | None) -> int:
    """Return a number of workers, by default one per core. Raises InputError if it is none."""
    if workers is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if not 1 <= workers <= 1024:
        raise InputError(f"workers must lie between 1 and 1024, got {workers}", field="workers")
    return workers


def run_batch(
    jobs: Iterable[Job | BadJob | Scene],
    folder: Path,
    open_pool: Callable[[int], Pool],
    limits: Limits,
    retry_failed: bool,
    stop: Callable[[], bool] | None,
    *,
    watch: Callable[[int], None] | None = None,
    work: Callable[[JobRequest], Outcome] = dress_job,
) -> Generator[JobResult, None, None]:
    """Run a batch in a pool, which is opened with the descriptor of the folder's lock; see `batch`.

    `work` is what a job's process does.
    """
    writable_folder(folder)
    lock = lock_folder(folder)
    try:
        make_folders(folder)
        ledger = Ledger(folder)
        ledger.begin_run(os.getpid(), len(jobs) if isinstance(jobs, Sized) else None)
        run = _Run(folder, ledger, open_pool(lock), limits, retry_failed, work)
        try:
            yield from run.results(as_jobs(jobs), stop or (lambda: False), watch or (lambda running: None))
        finally:
            run.pool.close()
            # Where nothing more can be written, the next run finds out by itself what was under way.
            with suppress(sqlite3.OperationalError):
                ledger.end_run()
            ledger.close()
    except PoolFailed as error:
        raise BatchStopped(str(error)) from None
    except (OSError, sqlite3.OperationalError) as error:
        if not disk_is_full(error):
            raise
        raise BatchStopped(f"{folder}: {DISK_FULL}") from error
    finally:
        os.close(lock)


class _Run:
    """One run of a batch."""

    def __init__(
        self, folder: Path, ledger: Ledger, pool: Pool, limits: Limits, retry_failed: bool,
        work: Callable[[JobRequest], Outcome],
    ) -> None:  # fmt: skip
        self.pool = pool
        self._folder, self._ledger, self._limits, self._work = folder, ledger, limits, work
        self._retry_failed = retry_failed
        self._fingerprints = Fingerprints()
        self._full = False

    def results(
        self, jobs: Iterator[Job | BadJob], stop: Callable[[], bool], watch: Callable[[int], None]
    ) -> Iterator[JobResult]:
        """Start jobs as there is room, and yield the results."""
        more = True
        while more or self.pool.unfinished:
            if self._full or stop():
                more = False
                for request in self.pool.withdraw():
                    self._ledger.put_back(request.name)
            while more and self.pool.room > 0:
                job = next(jobs, None)
                if job is None:
                    more = False
                elif isinstance(job, BadJob):
                    yield self._refuse(job)
                elif (before := self._consider(job)) is not None:
                    yield before
            watch(self.pool.running)
            for request, ended in self.pool.wait(TICK):
                result = self._end(request, ended)
                if result is not None:
                    yield result
        if self._full:
            raise BatchStopped(f"{self._folder}: {DISK_FULL}")

    def _consider(self, job: Job) -> JobResult | None:
        """Start a job, or return its result from an earlier run."""
        fingerprint = self._fingerprints.of(job.scene)
        row = self._ledger.row(job.name)
        entry = _entry(job, fingerprint.digest, dict(fingerprint.inputs), self._limits)
        if row is not None and row["fingerprint"] == fingerprint.digest:
            outcome = self._outcome_before(row)
            self._ledger.see(job.name)
        else:
            # Its ledger may have been lost, or it ended as the coordinator was killed.
            outcome = published(self._folder, job.name, fingerprint.digest)
            self._ledger.register(entry)
            if outcome is not None:
                self._ledger.end(job.name, outcome)
        if outcome is not None and not self._again(outcome):
            return self._result(job.name, outcome, skipped=True)
        remove_result(self._folder, job.name)
        self._start(
            JobRequest(
                name=job.name, scene=job.scene, fingerprint=fingerprint.digest, folder=self._folder,
                work=work_folder(self._folder, job.name),
            )
        )  # fmt: skip
        return None

    def _refuse(self, job: BadJob) -> JobResult:
        """Note a job that a file describes wrongly as failed."""
        digest = hashlib.sha256(job.message.encode()).hexdigest()
        self._ledger.register(
            Entry(
                name=job.name, avatar="", garments="", fabrics="", quality="", fingerprint=digest, inputs={},
                settings={},
            )
        )  # fmt: skip
        remove_result(self._folder, job.name)
        outcome = Outcome(state="failed", failure_class="bad_input", message=job.message)
        self._ledger.end(job.name, outcome)
        return self._result(job.name, outcome)

    def _again(self, outcome: Outcome) -> bool:
        """Whether a job runs again that ended in an earlier run: a kill from outside was not its fault."""
        return outcome.failure_class == "killed" or (self._retry_failed and outcome.state == "failed")

    def _outcome_before(self, row: dict[str, Any]) -> Outcome | None:
        """Return a job's result from an earlier run, None if it has not ended or its folder is gone."""
        outcome = published(self._folder, row["name"], row["fingerprint"])
        if row["state"] in ("done", "failed"):
            return outcome if row["published"] else _outcome_of(row)
        if outcome is not None:
            self._ledger.end(row["name"], outcome)
        return outcome

    def _start(self, request: JobRequest) -> None:
        """Start a job."""
        self._ledger.start(request.name)
        self.pool.start(request, self._work, request, self._limits)

    def _end(self, request: JobRequest, ended: Ended) -> JobResult | None:
        """Note the end of a job; None if it runs again, or could not run for want of space."""
        outcome = settled(request, ended, self._limits)
        if outcome.state == "disk_full":
            self._full = True
            self._ledger.put_back(request.name)
            return None
        if outcome.failure_class == "killed" and request.attempt < ATTEMPTS:
            work = work_folder(self._folder, request.name)
            self._start(replace(request, work=work, attempt=request.attempt + 1))
            return None
        self._ledger.end(request.name, outcome)
        return self._result(request.name, outcome)

    def _result(self, name: str, outcome: Outcome, *, skipped: bool = False) -> JobResult:
        """Return what the caller gets."""
        folder = result_folder(self._folder, name) if outcome.published else None
        return JobResult(name=name, outcome=outcome, folder=folder, skipped=skipped)


def _entry(job: Job, fingerprint: str, inputs: dict[str, str], limits: Limits) -> Entry:
    """Return what the ledger notes about a job."""
    scene = job.scene
    settings = {
        name: asdict(value) if isinstance(value, SizingOptions) else value
        for name in ("edge_length", "remesh", "max_frames", "gravity", "friction")
        if (value := getattr(scene, name)) is not None
    }
    return Entry(
        name=job.name,
        avatar=avatar_name(scene),
        garments=" ".join(default_name(garment) for garment in scene.garments),
        fabrics=fabric_names(scene),
        quality=scene.quality,
        fingerprint=fingerprint,
        inputs=inputs,
        settings=settings | {f"limit_{name}": value for name, value in asdict(limits).items() if value},
    )


def _outcome_of(row: dict[str, Any]) -> Outcome:
    """Return the outcome that a row of the ledger notes."""
    return Outcome(
        state=row["state"],
        failure_class=row["failure_class"],
        message=row["message"],
        version=row["version"],
        wall_seconds=row["wall_seconds"],
        cpu_seconds=row["cpu_seconds"],
        peak_memory=row["peak_memory"],
        figures={name: row[name] for name in FIGURES if row[name] is not None},
    )
