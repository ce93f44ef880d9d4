"""The API reference builds from docstrings and holds every public name."""

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import toile

ROOT = Path(__file__).resolve().parents[1]


@pytest.mark.skipif(importlib.util.find_spec("pdoc") is None, reason="pdoc is not installed (-e '.[dev]')")
def test_the_reference_holds_every_public_name(tmp_path: Path) -> None:
    paths = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    done = subprocess.run(
        [sys.executable, ROOT / "docs" / "api.py", tmp_path],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "Warn" not in done.stderr, done.stderr
    page = (tmp_path / "toile.html").read_text(encoding="utf-8")
    sections = set(re.findall(r'<section id="(\w+)">', page))
    assert sections == set(toile.__all__)
    for package in (tmp_path / "toile").iterdir():
        assert package.name.startswith("engine")
    engine = {path.stem for path in (ROOT / "engine").rglob("*.py")} - {"__init__"}
    assert engine <= {path.stem for path in (tmp_path / "toile" / "engine").rglob("*.html")}
    assert "areal_density" in page
    assert "Mass per area [kg/m^2]." in page
