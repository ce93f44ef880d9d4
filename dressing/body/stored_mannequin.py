"""The mannequin of default size, cached on disk: building it takes a quarter of a small T-shirt's preview."""

from importlib.metadata import version
from pathlib import Path

import numpy as np

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.mannequin import mannequin
from toile.dressing.files.npz_file import npz_arrays
from toile.dressing.files.writers.atomic import replacing
from toile.geometry.cache_folder import cache_root
from toile.geometry.errors import InputError
from toile.geometry.sources import hash_of, modules_behind, read_sources

LIBRARIES = ("numpy", "scipy", "manifold3d")
"""On what its last digits depend beside toile's own sources."""
BUILDER = "toile.dressing.body.mannequin"
KEPT = 4
"""Mannequins of earlier sources that stay on disk."""


def stored_mannequin() -> Avatar:
    """Return `mannequin()`, to the last bit: read where it was built before, or built and written.

    One of other measurements is not kept: a crowd has many, each once.
    """
    path = _path()
    known = _read(path)
    if known is not None:
        return known
    built = mannequin()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as temporary:
            np.savez(
                temporary, vertices=built.vertices, faces=built.faces, name=built.name, notes=built.notes
            )
        for old in sorted(path.parent.glob("mannequin-*.npz"), key=_age)[KEPT + 1 :]:
            old.unlink(missing_ok=True)
    except OSError:
        # A folder that cannot be written, as in a container: it is built every time.
        pass
    return built


def _path() -> Path:
    """Where the mannequin of these sources and libraries is kept."""
    sources = read_sources()
    libraries = (f"{name} {version(name)}" for name in LIBRARIES)
    name = hash_of(sources, modules_behind(sources, BUILDER), *libraries)
    return cache_root() / f"mannequin-{name}.npz"


def _age(path: Path) -> float:
    """Return minus the time when a file was written [s]."""
    return -path.stat().st_mtime


def _read(path: Path) -> Avatar | None:
    """Return what was stored, or None where it cannot be read."""
    try:
        stored = npz_arrays(path, "the mannequin")
        return Avatar(
            name=str(stored["name"]),
            vertices=stored["vertices"],
            faces=stored["faces"],
            notes=tuple(stored["notes"].tolist()),
            placed=True,
            repaired=True,
        )
    except (InputError, KeyError):
        return None
