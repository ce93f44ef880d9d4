"""Real Blender beside the tests: a folder with bpy, and scripts that run in it and tell what they found."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import toile

SCRIPTS = Path(__file__).parent / "in_blender"
VERSION = "bpy==4.5.*"
OTHER = os.environ.get("TOILE_BLENDER", "")
"""A Python that has another bpy and what toile needs, in which the tests run instead."""
TOILE = Path(toile.__file__).parents[1]
"""Where the toile under test is found."""
Blender = Callable[..., dict[str, Any]]


@pytest.fixture(scope="session")
def bpy_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder that holds bpy and what it needs.

    TOILE_BPY names one that is kept; else it is downloaded for this session (373 MB). It does not go into the
    tests' own environment: bpy 4.5 needs numpy 1, and its copy of USD would meet usd-core in one process.
    """
    if OTHER:
        pytest.skip("needs the folder of bpy 4.5, and TOILE_BLENDER names another")
    if sys.version_info[:2] != (3, 11):
        pytest.skip("bpy 4.5 needs Python 3.11")
    given = os.environ.get("TOILE_BPY")
    folder = Path(given) if given else tmp_path_factory.mktemp("bpy")
    if not (folder / "bpy").is_dir():
        done = subprocess.run(
            [sys.executable, "-m", "pip", "install", "--quiet", "--target", str(folder), VERSION],
            capture_output=True, text=True,
        )  # fmt: skip
        if done.returncode:
            pytest.skip(f"bpy cannot be installed: {done.stderr.strip().splitlines()[-1:]}")
    return folder


def run_in_blender(python: str, paths: list[Path], script: str, *arguments: object) -> dict[str, Any]:
    """Run a script of in_blender/ in Blender; return the object that it prints as its last line."""
    folder = Path(str(arguments[0]))
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(map(str, paths)),
        "BLENDER_USER_RESOURCES": str(folder / "blender"),
        "TOILE_TRACEBACK": "1",
    }
    done = subprocess.run(
        [python, str(SCRIPTS / script), *map(str, arguments)],
        env=environment, capture_output=True, text=True, cwd=folder, timeout=900,
    )  # fmt: skip
    assert done.returncode == 0, f"{done.stdout[-3000:]}\n{done.stderr[-5000:]}"
    found: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
    return found


@pytest.fixture(scope="session")
def blender(request: pytest.FixtureRequest) -> Blender:
    """Return a function that runs a script in Blender; its first argument is a folder to work in."""
    python, paths = OTHER, [TOILE]
    if not OTHER:
        python, paths = sys.executable, [request.getfixturevalue("bpy_folder"), TOILE]

    def run(script: str, *arguments: object) -> dict[str, Any]:
        return run_in_blender(python, paths, script, *arguments)

    return run


@pytest.fixture(scope="session")
def bare_blender(bpy_folder: Path) -> Blender:
    """Return the same in a Python that has no toile."""
    python = getattr(sys, "_base_executable", sys.executable)

    def run(script: str, *arguments: object) -> dict[str, Any]:
        return run_in_blender(python, [bpy_folder], script, *arguments)

    return run
