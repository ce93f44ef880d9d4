"""Versions of toile to measure: this one, a revision of the repository, or a wheel."""

import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

import toile
from toile.geometry.errors import InputError

THIS = "this"
"""Name of the version that measures."""


@dataclass(frozen=True)
class ToileVersion:
    """A version: its name in tables, and the folder in which `import toile` finds it."""

    name: str
    path: Path


def this_version() -> ToileVersion:
    """Return the version that runs."""
    return ToileVersion(THIS, Path(str(toile.__file__)).absolute().parent.parent)


@contextmanager
def other_version(source: str) -> Iterator[ToileVersion]:
    """Unpack a wheel, or a git revision of the repository that this version lies in, for a while.

    Other packages are those of this environment. Raises InputError if there is no such wheel or revision.
    """
    with TemporaryDirectory(prefix="toile-bench-") as folder:
        path = Path(folder)
        if source.endswith(".whl"):
            _unpack_wheel(Path(source), path)
            name = "-".join(Path(source).name.split("-")[:2])
        else:
            _unpack_revision(source, path)
            name = source
        if not (path / "toile").is_dir():
            raise InputError(f"{source}: holds no package 'toile'", field="--against")
        yield ToileVersion(name, path)


def _unpack_wheel(wheel: Path, folder: Path) -> None:
    """Unpack a wheel of pure Python, which is what toile's are."""
    try:
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(folder)
    except FileNotFoundError:
        raise InputError(f"{wheel}: there is no such wheel", file=wheel, field="--against") from None
    except (OSError, zipfile.BadZipFile) as error:
        raise InputError(
            f"{wheel}: cannot be read as a wheel ({error})", file=wheel, field="--against"
        ) from None


def _unpack_revision(revision: str, folder: Path) -> None:
    """Unpack the files of a revision, without a history."""
    root = Path(__file__).resolve().parents[2]
    try:
        done = subprocess.run(
            ["git", "-C", str(root), "archive", "--format=tar", f"{revision}^{{commit}}"], capture_output=True
        )
    except FileNotFoundError:
        raise InputError("--against a revision needs git; give a wheel instead", field="--against") from None
    if done.returncode:
        said = done.stderr.decode(errors="replace").strip().splitlines() or [""]
        raise InputError(
            f"{revision}: git knows no such revision here ({said[-1]}); run toile bench from a checkout "
            "that has it, or give a wheel",
            field="--against",
        )
    with tarfile.open(fileobj=BytesIO(done.stdout)) as archive:
        if sys.version_info >= (3, 12):
            archive.extractall(folder, filter="tar")
        else:
            archive.extractall(folder)
