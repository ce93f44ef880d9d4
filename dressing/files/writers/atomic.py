"""Files appear whole or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from toile.geometry.errors import InputError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary name beside a file, of the same kind; what is written there takes the file's place.

    An OSError raised inside names the file that could not be written.
    """
    temporary = path.with_name(f".{os.getpid()}.{path.name}")
    try:
        yield temporary
        os.replace(temporary, path)
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(path)) from error
    finally:
        temporary.unlink(missing_ok=True)


def write_atomic(path: Path, content: bytes) -> Path:
    """Write a file as a whole and return its path; OSError if that fails."""
    with replacing(path) as temporary:
        temporary.write_bytes(content)
    return path


def writable_folder(folder: str | Path) -> Path:
    """Return the folder, created if necessary. Raises InputError if nothing can be written into it."""
    folder = Path(folder)
    probe = folder / f".toile.{os.getpid()}.tmp"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise InputError(
            f"{folder}: cannot write into the output folder ({reason}); choose another with -o", file=folder
        ) from None
    return folder
