"""One run at a time in an output folder."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from toile.dressing.files.writers.file_lock import try_lock, unlock
from toile.geometry.errors import InputError

NAME = ".toile.lock"


@contextmanager
def one_run(folder: Path | None) -> Iterator[None]:
    """Hold the lock of an output folder, which exists; None needs none.

    Raises InputError if another run writes there. A run that was killed holds no lock.
    """
    if folder is None:
        yield
        return
    descriptor = try_lock(folder / NAME)
    if descriptor is None:
        raise InputError(
            f"{folder}: another run of toile writes into this folder; wait for it, or choose another folder",
            file=folder,
        )
    try:
        yield
    finally:
        unlock(folder / NAME, descriptor)
