"""Where the results of jobs lie: a folder each, which appears whole or not at all.

jobs/NAME/        results and job.json, of jobs that have any
logs/NAME.txt     what a job printed, if it did
work/             folders of running jobs; renamed to jobs/NAME when they are complete
"""

import json
import os
import shutil
from dataclasses import asdict
from pathlib import Path

from toile.dress.batch.outcome import Outcome
from toile.dress.writers.atomic import writable_folder

RESULTS, LOGS, WORK = "jobs", "logs", "work"
NOTE, LOG = "job.json", "log.txt"


def make_folders(folder: Path) -> None:
    """Make a batch's folders, and remove what killed jobs have left. Raises InputError if that fails."""
    for name in (RESULTS, LOGS, WORK):
        writable_folder(folder / name)
    for left in (folder / WORK).iterdir():
        shutil.rmtree(left)


def work_folder(folder: Path, name: str) -> Path:
    """Return the path of a folder for a run of a job, which no other run uses."""
    return folder / WORK / f"{name}.{os.urandom(4).hex()}"


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


def keep_log(folder: Path, work: Path, name: str) -> None:
    """Move what a job printed from its work folder to logs/; remove it if it is empty."""
    log = work / LOG
    if not log.is_file():
        return
    if log.stat().st_size:
        os.replace(log, folder / LOGS / f"{name}.txt")
    else:
        log.unlink()
