"""One batch at a time in a folder."""

import os
import time
from pathlib import Path

from toile.geometry.errors import InputError

try:
    import fcntl
except ImportError:
    # Windows, where no batch runs.
    fcntl = None  # type: ignore[assignment]

NAME = ".lock"
PATIENCE = 10.0
"""Time for the processes of a batch that was killed to end [s]; they take milliseconds."""


def check_system() -> None:
    """Raise InputError where batches cannot run: a job's process is forked."""
    if fcntl is None or not hasattr(os, "fork"):
        raise InputError("batches need a system that can fork, Linux or macOS; on Windows use WSL")


def lock_folder(folder: Path) -> int:
    """Lock a folder and return the descriptor that holds the lock; closing it, or dying, lets go.

    Processes that inherit the descriptor hold the lock too: after the coordinator was killed, the folder is
    free only when its workers have ended as well. Raises InputError if another batch runs there.
    """
    descriptor = os.open(folder / NAME, os.O_RDWR | os.O_CREAT, 0o644)
    give_up = time.monotonic() + PATIENCE
    while True:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return descriptor
        except BlockingIOError:
            if time.monotonic() >= give_up:
                os.close(descriptor)
                raise InputError(
                    f"{folder}: another toile batch is running here; wait for it, or choose another folder"
                ) from None
            time.sleep(0.05)


def is_locked(folder: Path) -> bool:
    """Whether a batch runs in a folder."""
    if fcntl is None:
        return False
    try:
        descriptor = os.open(folder / NAME, os.O_RDWR)
    except OSError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False
