"""Content hashes of scenes, to tell whether a stored result is still that of the same input."""

import hashlib
import os
from collections import OrderedDict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.certificate.input_files import files_of
from toile.dressing.run.garment_source import built_in_name
from toile.dressing.run.scene import Garment, Scene

UNREADABLE = "unreadable"
REMEMBERED = 4096
"""Files whose hashes are kept in memory."""


@dataclass(frozen=True)
class Fingerprint:
    """Hash of a scene with the contents of its files, and the hash of every file by its path."""

    digest: str
    inputs: Mapping[str, str]


class Fingerprints:
    """Makes fingerprints; a file is read again only when its size or time has changed."""

    def __init__(self) -> None:
        self._seen: OrderedDict[tuple[str, int, int, int], str] = OrderedDict()

    def of(self, scene: Scene) -> Fingerprint:
        """Return the fingerprint of a scene. Where files lie does not count, what they hold does."""
        digest = hashlib.sha256()
        inputs: dict[str, str] = {}
        for part in self._parts(scene, inputs):
            digest.update(len(part).to_bytes(8, "little"))
            digest.update(part)
        return Fingerprint(digest.hexdigest(), inputs)

    def _parts(self, value: Any, inputs: dict[str, str]) -> Iterator[bytes]:
        """Yield the bytes that a value is made of."""
        if isinstance(value, Garment) and isinstance(value.source, str) and not built_in_name(value.source):
            value = replace(value, source=Path(value.source))
        if isinstance(value, Path):
            yield value.name.encode()
            for path in files_of(value):
                found = inputs[str(path)] = self._file(path)
                yield found.encode()
        elif isinstance(value, np.ndarray):
            yield f"{value.dtype.str}{value.shape}".encode()
            yield np.ascontiguousarray(value).tobytes()
        elif is_dataclass(value):
            yield type(value).__name__.encode()
            # What scenes are not compared by, such as threads, does not change their results.
            for entry in (entry for entry in fields(value) if entry.compare):
                yield entry.name.encode()
                yield from self._parts(getattr(value, entry.name), inputs)
        elif isinstance(value, Mapping):
            for key in sorted(value, key=repr):
                yield repr(key).encode()
                yield from self._parts(value[key], inputs)
        elif isinstance(value, list | tuple):
            yield f"{len(value)} entries".encode()
            for entry in value:
                yield from self._parts(entry, inputs)
        else:
            yield repr(value).encode()

    def _file(self, path: Path) -> str:
        """Return the SHA-256 of a file, or that it cannot be read."""
        try:
            facts = os.stat(path)
            key = str(path), facts.st_size, facts.st_mtime_ns, facts.st_ino
            if key not in self._seen:
                with open(path, "rb") as file:
                    self._seen[key] = hashlib.file_digest(file, "sha256").hexdigest()
                if len(self._seen) > REMEMBERED:
                    self._seen.popitem(last=False)
            return self._seen[key]
        except OSError:
            # The job itself will say what is wrong with it; once it is mended, the fingerprint changes.
            return UNREADABLE
