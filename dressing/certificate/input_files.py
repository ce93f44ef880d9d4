"""The files behind a scene."""

import hashlib
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.files.on_disk import is_file, is_folder
from toile.dressing.pattern.drawn.read_drawn import DRAWN_FORMATS
from toile.dressing.pattern.drawn.seams_file import seams_file_of


def files_of(path: Path) -> list[Path]:
    """Return the files behind a path of a scene: itself and what it needs beside it, or a folder's files."""
    if is_folder(path):
        return sorted(entry for entry in path.iterdir() if entry.is_file())
    if path.suffix.lower() == ".gltf" and is_file(path):
        named = re.findall(r'"uri"\s*:\s*"([^"]+)"', path.read_text(encoding="utf-8", errors="replace"))
        return [path, *(path.parent / name for name in named if not name.startswith("data:"))]
    if path.suffix.lower() in DRAWN_FORMATS:
        beside = seams_file_of(path)
        return [path, beside] if is_file(beside) else [path]
    return [path]


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file; OSError if it cannot be read."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def paths_in(value: Any) -> Iterator[Path]:
    """Yield the paths that a value of dataclasses, mappings and lists holds."""
    if isinstance(value, Path):
        yield value
    elif is_dataclass(value) and not isinstance(value, type):
        for entry in fields(value):
            yield from paths_in(getattr(value, entry.name))
    elif isinstance(value, Mapping):
        for entry in value.values():
            yield from paths_in(entry)
    elif isinstance(value, list | tuple):
        for entry in value:
            yield from paths_in(entry)


def plain_data(value: Any) -> Any:
    """Return a value of dataclasses as plain data: paths by their last names, arrays by their hashes."""
    if isinstance(value, Path):
        return value.name
    if isinstance(value, np.ndarray):
        digest = hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()
        return {"shape": list(value.shape), "dtype": value.dtype.str, "sha256": digest}
    if is_dataclass(value) and not isinstance(value, type):
        return {entry.name: plain_data(getattr(value, entry.name)) for entry in fields(value)}
    if isinstance(value, Mapping):
        return {
            " and ".join(sorted(key)) if isinstance(key, frozenset) else str(key): plain_data(entry)
            for key, entry in value.items()
        }
    if isinstance(value, list | tuple):
        return [plain_data(entry) for entry in value]
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    return value if value is None or isinstance(value, bool | int | float | str) else repr(value)
