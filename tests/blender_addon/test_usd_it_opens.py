"""Blender opens a film in USD: every frame has its own mesh, also where remeshing changed it."""

from pathlib import Path

import pytest

from tests.blender_addon.conftest import Blender

pytest.importorskip("pxr", reason="USD is not installed: pip install 'toile[usd]'")

from tests.dressing.files.test_usd import FILMS, FPS, VELOCITY, moving
from toile.dressing.files.writers.usd import UsdMesh, write_usd


def test_blender_shows_every_frame(blender: Blender, tmp_path: Path) -> None:
    meshes = [UsdMesh(name, (0.1, 0.2, 0.3), moving(shapes)) for name, shapes in FILMS.items()]
    write_usd(tmp_path / "film.usdc", FPS, meshes)
    found = blender("open_film.py", tmp_path, 4)
    assert set(found) == set(FILMS)
    for name, shapes in FILMS.items():
        assert found[name]["materials"] == [name]
        for frame, (area, place, count) in enumerate(found[name]["frames"]):
            points, _ = shapes[frame]
            assert count == len(points)
            assert area == pytest.approx(0.16, abs=1e-6)
            assert place == pytest.approx(points[:, 0].mean() + VELOCITY[0] * frame / FPS, abs=1e-6)
