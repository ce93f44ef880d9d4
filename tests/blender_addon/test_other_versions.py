"""The same film in later versions of Blender: TOILE_BLENDERS names Pythons that have bpy and toile."""

import os
from pathlib import Path

import pytest

from tests.blender_addon.conftest import run_in_blender


@pytest.mark.slow
@pytest.mark.parametrize("python", os.environ.get("TOILE_BLENDERS", "").split(os.pathsep))
def test_film_in_another_version(python: str, tmp_path: Path) -> None:
    if not python:
        pytest.skip("TOILE_BLENDERS names no Python with another bpy and toile")
    found = run_in_blender(python, [], "film.py", tmp_path)
    assert found["state"] == "complete" and max(found["errors"].values()) < 1e-5
    assert len({frame["vertices"] for frame in found["frames"]}) > 1
    assert all(found["moved"]) and found["original shown"] and found["applied"][0]
