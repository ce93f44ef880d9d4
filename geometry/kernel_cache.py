"""Machine code of kernels on disk: a folder for every state of the sources it was compiled from.

Numba's own cache sees a change in a kernel's file, but not in a helper or a constant of another file. So the
folder's name is a hash of all modules that hold any of these (sources.py), of the libraries' versions and of
the processor. A kernel has one signature, so processes that compile it at once write the same files, and each
file appears whole (numba renames it into place).
"""

import os
import re
import shutil
from contextlib import suppress
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy as np
from llvmlite import binding
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.codegen import get_host_cpu_features

from toile.geometry.cache_folder import cache_root
from toile.geometry.sources import hash_of, kernel_modules, read_sources

try:
    import fcntl
except ImportError:
    # Windows: there, files that are open cannot be removed.
    fcntl = None  # type: ignore[assignment]

KEPT = 8
"""Folders that stay, with that of these sources; each takes about 25 MB."""
REMOVED = "-removed"
"""Ending of the names of folders that are about to go."""
LOCK = "in_use"
"""File in a folder that every process with kernels from it holds open, with a shared lock."""


def kernel_cache_dir() -> Path:
    """Return the folder for machine code of exactly these sources, in `NUMBA_CACHE_DIR` if that is given."""
    sources = read_sources()
    config = numba.config
    processor = config.CPU_NAME or binding.get_host_cpu_name(), config.CPU_FEATURES or get_host_cpu_features()
    versions = numba.__version__, llvmlite.__version__, np.__version__
    name = hash_of(sources, kernel_modules(sources), *versions, *processor)
    shared = os.environ.get("NUMBA_CACHE_DIR")
    return Path(shared) / f"toile-{name}" if shared else cache_root() / name


CACHE_DIR = kernel_cache_dir()
WARM = CACHE_DIR.is_dir()
"""True when these sources were compiled before on this machine."""
_held: list[int] = []
"""Descriptor of the lock that this process holds."""


class KernelFolder:
    """Tells numba where the machine code of one kernel lies."""

    def __init__(self, function: Any, file: str) -> None:
        self._py_file = file
        self._line = function.__code__.co_firstlineno
        self._room = function.__module__.rpartition(".")[0]

    @classmethod
    def from_function(cls, function: Any, file: str) -> "KernelFolder":
        """Return the place of a kernel; with the first, earlier folders are removed."""
        if not _held:
            _hold_folder()
        return cls(function, file)

    def ensure_cache_path(self) -> None:
        """Make the folder."""
        os.makedirs(self.get_cache_path(), exist_ok=True)

    def get_cache_path(self) -> str:
        """Return the folder: modules of other rooms may have the same name."""
        return str(CACHE_DIR / self._room)

    def get_source_stamp(self) -> str:
        """Return the sources' hash."""
        return CACHE_DIR.name

    def get_disambiguator(self) -> str:
        """Return what tells apart functions of one name."""
        return str(self._line)


class KernelPlace(CompileResultCacheImpl):  # type: ignore[misc]
    """Numba's way to store compiled functions, in that folder."""

    _locator_classes = (KernelFolder,)


class KernelCache(FunctionCache):  # type: ignore[misc]
    """The cache of one kernel. What cannot be read or written is compiled, every time."""

    _impl_class = KernelPlace

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        """Return what a stored function must agree in; NUMBA_CACHE_LOCATOR_CLASSES may set another folder."""
        return (CACHE_DIR.name, *super()._index_key(sig, codegen))

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the compiled function, None if there is none."""
        try:
            return super().load_overload(sig, target_context)
        except Exception:
            # A file that was cut short, by a full disk or a crash, may raise anything.
            with suppress(OSError):
                self.flush()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Store a compiled function."""
        with suppress(OSError):
            super().save_overload(sig, data)


def _hold_folder() -> None:
    """Lock the folder while this process and its forks run; if it is new, remove old ones."""
    with suppress(OSError):
        CACHE_DIR.mkdir(parents=True, exist_ok=True)
        os.utime(CACHE_DIR)
        _held.append(os.open(CACHE_DIR / LOCK, os.O_RDWR | os.O_CREAT, 0o644))
        if fcntl is not None:
            fcntl.flock(_held[0], fcntl.LOCK_SH | fcntl.LOCK_NB)
        if not WARM:
            remove_old_folders(CACHE_DIR)


def remove_old_folders(own: Path) -> None:
    """Remove machine code of other sources, beside a folder.

    Folders used last stay, and those that a process holds. Two processes may remove the same folder.
    """
    pattern = re.compile(re.escape(own.name[:-16]) + "[0-9a-f]{16}")
    found = [path for path in own.parent.iterdir() if path != own]
    for left in found:
        if left.name.endswith(REMOVED) and pattern.fullmatch(left.name.removesuffix(REMOVED)):
            shutil.rmtree(left, ignore_errors=True)
    others = [path for path in found if pattern.fullmatch(path.name) and path.is_dir()]
    for folder in sorted(others, key=_last_use, reverse=True)[KEPT - 1 :]:
        with suppress(OSError):
            if not _is_held(folder):
                # Renamed first, so that a process which starts now finds all of it or nothing.
                gone = folder.with_name(folder.name + REMOVED)
                os.rename(folder, gone)
                shutil.rmtree(gone, ignore_errors=True)


def _last_use(folder: Path) -> float:
    """Return when a folder was used last [s]; 0 if it is gone."""
    try:
        return folder.stat().st_mtime
    except OSError:
        return 0.0


def _is_held(folder: Path) -> bool:
    """Whether a process uses the folder. Raises OSError where that cannot be told."""
    if fcntl is None or not (folder / LOCK).exists():
        return False
    descriptor = os.open(folder / LOCK, os.O_RDWR)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False
