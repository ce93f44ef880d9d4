"""Failure classes of jobs: one word for each kind, for tables and filters."""

import errno
import signal
import sqlite3
from collections.abc import Iterator
from typing import Literal

from toile.dressing.wear.drape_types import FailureKind

FailureClass = FailureKind | Literal["bad_input", "timeout", "memory", "crashed", "killed", "fault"]
"""Why a job failed: as a drape does, or before or around it."""
FAILURE_CLASSES: dict[FailureClass, str] = {
    "bad_input": "a file, name or number of the scene is at fault; the message says which",
    "open_seams": "seams did not close: the garment is too small for the body, or cloth is in the way",
    "tangled": "triangles still cross at the end",
    "not_sewn": "the frame limit was reached before the garment was sewn",
    "numerical": "the solver broke down",
    "motion": "the garment could not follow the body's motion",
    "crossing": "triangles crossed in a frame of the body's motion",
    "overstretched": "cloth grew or was stretched beyond reason",
    "fell_off": "the garment fell off the body",
    "timeout": "stopped after the time limit of a job",
    "memory": "needed more memory than a job may have",
    "crashed": "the process died of an error in machine code",
    "killed": "the process was killed from outside every time it was started",
    "fault": "an error in toile itself; the traceback is in logs/",
}
"""Class of a failure to what it means."""

ATTEMPTS = 3
"""How often a job is started when its process is killed from outside."""
FULL = (errno.ENOSPC, errno.EDQUOT)
MEMORY_SHARE = 0.8
"""A process that crashes with at least this share of its memory in use has died of the memory limit."""


def disk_is_full(error: BaseException) -> bool:
    """Whether an error means that nothing more can be written."""
    for cause in _chain(error):
        if isinstance(cause, OSError) and cause.errno in FULL:
            return True
        if isinstance(cause, sqlite3.OperationalError):
            # The low byte is the kind of error; a full disk is SQLITE_FULL or one of many SQLITE_IOERR_...
            if cause.sqlite_errorcode & 0xFF in (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR):
                return True
    return False


def _chain(error: BaseException) -> Iterator[BaseException]:
    """Yield an error and those it came from."""
    link: BaseException | None = error
    while link is not None:
        yield link
        link = link.__cause__ or link.__context__


def death(exit_status: int, peak_memory: float, memory_limit: float | None) -> tuple[FailureClass, str]:
    """Return the failure class and message of a process that ended without an answer.

    `exit_status` is negative for a signal, as in `subprocess`; memory in bytes.
    """
    how = f"exit code {exit_status}"
    if exit_status < 0:
        how = signal.Signals(-exit_status).name
    if memory_limit is not None and peak_memory >= MEMORY_SHARE * memory_limit:
        return "memory", f"the process ended ({how}) at {peak_memory / 1e9:.2f} GB of memory"
    if exit_status == -signal.SIGKILL:
        return "killed", "the process was killed from outside (out of memory on the machine?)"
    return "crashed", f"the process crashed ({how})"
