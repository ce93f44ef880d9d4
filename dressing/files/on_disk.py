"""Whether a path that a user gave names a file or a folder; pathlib raises where the system cannot look."""

from pathlib import Path


def is_file(path: Path) -> bool:
    """Whether there is such a file; False too if its name is too long or its folder closed."""
    try:
        return path.is_file()
    except OSError:
        return False


def is_folder(path: Path) -> bool:
    """Whether there is such a folder; False as for `is_file`."""
    try:
        return path.is_dir()
    except OSError:
        return False
