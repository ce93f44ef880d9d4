"""Folders of results: one per job, which appears whole or not at all.

jobs/NAME/        results and job.json, of jobs that have any
logs/NAME.txt     what a job printed, if it did; written when its process has ended
work/             folders of running jobs; renamed to jobs/NAME when they are complete

A job makes few files and removes none: a file system looks for room among those removed lately.
"""

import json
import os
import shutil
from dataclasses import asdict
from pathlib import Path

from toile.dressing.batch.outcome import Outcome
from toile.dressing.files.writers.atomic import writable_folder

RESULTS, LOGS, WORK = "jobs", "logs", "work"
NOTE = "job.json"


def make_folders(folder: Path) -> None:
    """Make a batch's folders, and remove what killed jobs have left. Raises InputError if that fails."""
    for name in (RESULTS, LOGS, WORK):
        writable_folder(folder / name)
    for left in (folder / WORK).iterdir():
        shutil.rmtree(left)


def work_folder(folder: Path, name: str) -> Path:
    """Return the path of a folder for a run of a job, which no other run uses."""
    return folder / WORK / f"{name}.{os.urandom(4).hex()}"


def own_folder(work: Path) -> Path:
    """Make a folder for one process that does a run of a job.

    Dask may ask the same twice, if it takes the process of the first time for lost.
    """
    own = work.with_name(f"{work.name}.{os.urandom(4).hex()}")
    own.mkdir(parents=True)
    return own


def tidy(work: Path) -> None:
    """Remove what processes of a run have left, see `own_folder`."""
    for place in work.parent.iterdir():
        if place.name.startswith(f"{work.name}."):
            shutil.rmtree(place, ignore_errors=True)


def publish(folder: Path, work: Path, name: str, fingerprint: str, outcome: Outcome) -> None:
    """Note an outcome in a work folder and rename it into place: from then on the job has its result.

    A result of the same input that is there already (of a job that ran twice because a network was cut, say)
    stays.
    """
    note = {"name": name, "fingerprint": fingerprint, "outcome": asdict(outcome)}
    (work / NOTE).write_text(json.dumps(note, indent=1) + "\n")
    put_in_place(folder, work, name, fingerprint)


def put_in_place(folder: Path, work: Path, name: str, fingerprint: str) -> None:
    """Rename a work folder whose outcome is noted; see `publish`."""
    try:
        os.rename(work, folder / RESULTS / name)
    except OSError:
        if published(folder, name, fingerprint) is None:
            raise
        shutil.rmtree(work)


def published(folder: Path, name: str, fingerprint: str) -> Outcome | None:
    """Return the outcome noted in a job's folder, None if there is none for this input."""
    try:
        note = json.loads((folder / RESULTS / name / NOTE).read_bytes())
    except (OSError, ValueError):
        return None
    return Outcome(**note["outcome"]) if note["fingerprint"] == fingerprint else None


def remove_result(folder: Path, name: str) -> None:
    """Remove the result and log of a job that will run again."""
    (folder / LOGS / f"{name}.txt").unlink(missing_ok=True)
    place = folder / RESULTS / name
    if place.is_dir():
        # Renamed first: a folder that is half removed must not be taken for a result.
        gone = folder / WORK / f"{name}.old"
        os.rename(place, gone)
        shutil.rmtree(gone)


def keep_log(folder: Path, name: str, printed: bytes) -> None:
    """Write what a job printed, if it did, to logs/."""
    if printed.strip():
        (folder / LOGS / f"{name}.txt").write_bytes(printed)
