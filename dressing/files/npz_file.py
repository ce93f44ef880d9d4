"""Reads the arrays of an .npz file."""

from pathlib import Path
from typing import Any

import numpy as np

from toile.geometry.errors import InputError


def npz_arrays(path: Path, what: str) -> dict[str, Any]:
    """Return all arrays of a file by name. Raises InputError, telling to export `what` again."""
    try:
        with np.load(path, allow_pickle=False) as data:
            return {name: data[name] for name in data.files}
    except Exception as error:  # NumPy and zipfile raise whatever they stumble over
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(
            f"{path}: cannot be read as .npz ({reason}); export {what} again", file=path
        ) from None
