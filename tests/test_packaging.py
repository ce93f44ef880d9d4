"""What users install: a source archive without links, and a wheel that is whole wherever it was built."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tarfile
from importlib.metadata import version
from pathlib import Path
from zipfile import ZipFile

import pytest

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("geometry", "collide", "remesh", "engine", "dressing", "studies", "blender_addon")
TOP = ("pyproject.toml", "setup.py", "MANIFEST.in", "README.md", "LICENSE", "CHANGELOG.md", "CITATION.cff")
NEEDED = 77
"""The version of setuptools that pyproject.toml asks for."""

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("setuptools") is None or int(re.split(r"\D", version("setuptools"))[0]) < NEEDED,
    reason=f"setuptools>={NEEDED} is not installed (pip install -e '.[dev]')",
)


def build(kind: str, folder: Path, out: Path) -> Path:
    """Build an "sdist" or a "wheel" of a source folder as pip does, without the network."""
    code = f"from setuptools.build_meta import build_{kind} as b; print('made', b({str(out)!r}))"
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return out / done.stdout.splitlines()[-1].removeprefix("made ")


def copied(folder: Path, *, links: bool) -> Path:
    """Copy what a build needs of this checkout; without links as git leaves it on Windows."""
    for room in ROOMS:
        shutil.copytree(ROOT / room, folder / room, ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "toile").mkdir()
    for name in TOP:
        shutil.copy(ROOT / name, folder)
    for path in (ROOT / "toile").glob("*.*"):
        shutil.copy(path, folder / "toile")
    for room in ROOMS:
        place = folder / "toile" / room
        if links:
            place.symlink_to(f"../{room}", target_is_directory=True)
        else:
            place.write_text(f"../{room}")
    return folder


def contents(wheel: Path) -> dict[str, int]:
    """Files of a wheel and their checksums."""
    with ZipFile(wheel) as file:
        return {entry.filename: entry.CRC for entry in file.infolist()}


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The source archive of a copy of this checkout."""
    folder = tmp_path_factory.mktemp("source")
    return build("sdist", copied(folder / "tree", links=os.name != "nt"), folder)


@pytest.fixture(scope="module")
def wheel(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of the source archive."""
    folder = tmp_path_factory.mktemp("wheel")
    with tarfile.open(source) as archive:
        archive.extractall(folder, filter="data")
    return build("wheel", folder / source.name.removesuffix(".tar.gz"), folder)


def test_the_source_archive_holds_no_links(source: Path) -> None:
    with tarfile.open(source) as archive:
        members = archive.getmembers()
    assert {member.name for member in members if not (member.isfile() or member.isdir())} == set()
    inside = {member.name.partition("/")[2] for member in members}
    assert {"LICENSE", "blender_addon/LICENSE", "geometry/kernel.py", "CHANGELOG.md"} <= inside
    assert not [name for name in inside if name.startswith(("toile/geometry", "tests"))]


def test_the_wheel_of_the_archive_holds_every_file(wheel: Path) -> None:
    tree = {f"toile/{name}" for name in ("__init__.py", "__main__.py", "py.typed")}
    for room in ROOMS:
        for path in (ROOT / room).rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                tree.add(f"toile/{path.relative_to(ROOT).as_posix()}")
    packed = {name for name in contents(wheel) if ".dist-info/" not in name}
    assert packed == tree


def test_a_checkout_without_links_builds_the_same_wheel(wheel: Path, tmp_path: Path) -> None:
    plain = build("wheel", copied(tmp_path / "tree", links=False), tmp_path)
    assert plain.name == wheel.name
    assert contents(plain) == contents(wheel)


def test_the_installed_wheel_runs_outside_the_checkout(wheel: Path, tmp_path: Path) -> None:
    place = tmp_path / "installed"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target"]
    subprocess.run([*pip, str(place), str(wheel)], check=True, capture_output=True)
    environment = os.environ | {"PYTHONPATH": str(place)}

    def said(*arguments: str) -> str:
        done = subprocess.run(
            [sys.executable, *arguments], cwd=tmp_path, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    code = "import toile; print(toile.__file__, toile.fabric('canvas').name, toile.dress.__name__)"
    file, fabric, name = said("-c", code).split()
    assert Path(file).is_relative_to(place)
    assert (fabric, name) == ("canvas", "dress")
    assert "toile dress --garment tshirt" in said("-m", "toile", "--help")
    assert "cotton-poplin" in said("-m", "toile", "fabrics")
    assert said("-m", "toile", "--version").split() == ["toile", wheel.name.split("-")[1]]
