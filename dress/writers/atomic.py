"""Files appear whole or not at all."""

import os
from pathlib import Path

from toile.geometry.errors import InputError


def write_atomic(path: Path, content: bytes) -> Path:
    """Write through a temporary name beside the file and return the path; OSError if that fails."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        temporary.write_bytes(content)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
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
            f"{folder}: cannot write into the output folder ({reason}); choose another with -o"
        ) from None
    return folder
