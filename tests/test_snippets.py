"""Python in README and docs passes strict type checkers: what run time accepts, hints accept too."""

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
NAMES = {("batch.md", 0): "shirts"}
"""Snippets that others import, by page and number, and the name that their page gives them."""
SPELLINGS = '''
"""Convenient spellings that the documentation promises."""

from pathlib import Path

import numpy as np

import toile

toile.Scene(garments="tshirt", avatar="body.obj", formats="vtu")
toile.Scene(garments=["tshirt", Path("coat.obj"), toile.Garment("trousers", pins="hem")])
toile.Scene(garments=["tshirt"], avatar=toile.AvatarFile(path="body.obj", only="Body", fps=np.float32(24.0)))
toile.Scene(garments={"pattern": {}}, gravity=np.float32(9.81), max_frames=np.int64(3), ground=0)
toile.Scene(garments=["tshirt"], air=toile.Air(velocity=np.array([0.0, 0.0, 5.0]), gusts=np.float32(0.1)))
toile.Scene(garments=["tshirt"], avatar=toile.body(np.zeros((8, 3), np.float32), [[0, 1, 2]]))
garments: tuple[toile.Garment, ...] = tuple(toile.Scene(garments="tshirt").garments)
path: Path = toile.AvatarFile(path="body.obj").path
'''


@pytest.fixture(scope="module")
def snippets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with every snippet as a file."""
    folder = tmp_path_factory.mktemp("snippets")
    (folder / "spellings.py").write_text(SPELLINGS)
    for page in PAGES:
        blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
        for number, block in enumerate(blocks):
            name = NAMES.get((page.name, number), f"{page.stem.lower()}_{number}")
            (folder / f"{name}.py").write_text(block)
    return folder


def test_mypy_finds_nothing(snippets: Path) -> None:
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("mypy is not installed (pip install -e '.[dev]')")
    files = sorted(snippets.glob("*.py"))
    assert len(files) > 7
    # The project's settings are strict; said here again, they would undo its exceptions for kernels.
    command = [sys.executable, "-m", "mypy", "--config-file", str(ROOT / "pyproject.toml")]
    done = subprocess.run(
        [*command, "--cache-dir", str(ROOT / ".mypy_cache"), *map(str, files)],
        cwd=ROOT, env=os.environ | {"MYPYPATH": str(snippets)}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"


def test_pyright_finds_nothing(snippets: Path) -> None:
    pyright = os.environ.get("TOILE_PYRIGHT") or shutil.which("pyright")
    if pyright is None:
        pytest.skip("there is no pyright (pip install -e '.[pyright]', or name one in TOILE_PYRIGHT)")
    started = subprocess.run([pyright, "--version"], capture_output=True, text=True)
    if started.returncode:
        pytest.skip(f"pyright does not start here, it needs Node.js: {started.stderr.strip()[-200:]}")
    settings = {
        "extraPaths": [str(ROOT)], "include": [str(snippets)], "reportMissingImports": False,
        "reportMissingModuleSource": False, "typeCheckingMode": "standard", "failOnWarnings": False,
    }  # fmt: skip
    (snippets / "pyrightconfig.json").write_text(json.dumps(settings))
    command = [pyright, "--outputjson", "--pythonpath", sys.executable, "-p", str(snippets)]
    done = subprocess.run(command, capture_output=True, text=True)
    found = json.loads(done.stdout)
    assert found["summary"]["filesAnalyzed"] > 7
    assert not [entry for entry in found["generalDiagnostics"] if entry["severity"] == "error"], done.stdout


def test_the_main_function_helps() -> None:
    """In a process of its own: nothing of toile is loaded before help is asked for."""
    code = (
        "import inspect, toile; print(inspect.signature(toile.dress)); print(inspect.getdoc(toile.dress)); "
        "import pydoc; print(pydoc.render_doc(toile.dress))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    signature, *rest = done.stdout.splitlines()
    assert signature.startswith("(scene: ") and "progress" in signature and "Any" not in signature
    assert rest[0] == "Put a scene's garments on its avatar."
    assert "function dress in" in done.stdout and "PACKAGE CONTENTS" not in done.stdout
