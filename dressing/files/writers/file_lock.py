"""Locks between processes, held by a file that is open."""

import os
from pathlib import Path

try:
    import fcntl
except ImportError:
    fcntl = None  # type: ignore[assignment]
try:
    # Windows locks bytes of a file instead.
    import msvcrt
except ImportError:
    msvcrt = None  # type: ignore[assignment]


def try_lock(path: Path) -> int | None:
    """Lock a file, made if need be, and return its descriptor; None if another holds the lock.

    Closing the descriptor, or dying, lets go. A file system or machine that knows no locks grants every one.
    """
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            _lock(descriptor)
        except (BlockingIOError, PermissionError):
            os.close(descriptor)
            return None
        except OSError:
            return descriptor
        try:
            if os.path.samestat(os.stat(path), os.fstat(descriptor)):
                return descriptor
        except FileNotFoundError:
            pass
        # The one who had it removed the file in between.
        os.close(descriptor)


def unlock(path: Path, descriptor: int) -> None:
    """Remove a locked file and let go of it."""
    try:
        path.unlink(missing_ok=True)
    except OSError:
        # Windows removes no file that is open; it stays, unlocked.
        pass
    os.close(descriptor)


def _lock(descriptor: int) -> None:
    if fcntl is not None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    elif msvcrt is not None:
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
