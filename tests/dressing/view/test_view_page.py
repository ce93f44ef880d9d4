"""The page of a result: what it holds, and what it does in a real browser."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from tests.dressing.browser import opened_page
from toile.dressing.body.avatar import Avatar
from toile.dressing.cli.main import main
from toile.dressing.files.gltf.gltf_file import GltfFile
from toile.dressing.files.writers.ply import ply_bytes
from toile.dressing.garment.fabrics import fabric
from toile.dressing.run.result import DressedGarment, Result
from toile.dressing.view.result_folder import film_of_folder, parts_of_glb, view_of_folder
from toile.dressing.view.stretch import largest_stretch
from toile.geometry.arrays import Float, Int
from toile.remesh.panel.rectangle import rectangle


def sheet() -> tuple[Float, Int, Float]:
    """A square of 40 cm in front of a ball, 10 % longer along x than its pattern."""
    uv, faces = rectangle(0.4, 0.4, 0.1)
    positions = np.column_stack([1.1 * (uv[:, 0] - 0.2), uv[:, 1] - 0.2, np.full(len(uv), 0.6)])
    return positions, faces, uv


@pytest.fixture(scope="module")
def result() -> Result:
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.5)
    body = Avatar(
        name="ball", vertices=np.asarray(ball.vertices), faces=np.asarray(ball.faces, dtype=np.int32)
    )
    positions, faces, uv = sheet()
    garment = DressedGarment(
        name="a </script> sheet", fabric=fabric("canvas"), positions=positions, faces=faces, uv=uv,
        uv_faces=faces,         panel=np.zeros(len(faces), dtype=np.int32), panel_names=("square",),
        strain=np.tile([0.1, 0.0], (len(faces), 1)),
    )  # fmt: skip
    return Result(status="converged", report={}, avatar=body, garments=(garment,))


@pytest.fixture(scope="module")
def film_folder(result: Result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result with a film of three frames, in the last of which the mesh is another."""
    folder = tmp_path_factory.mktemp("film")
    result = replace(result, garments=(replace(result.garments[0], name="sheet"),))
    result.save(folder)
    (folder / "frames").mkdir()
    positions, faces, uv = sheet()
    for k in range(3):
        kept = faces if k < 2 else faces[::-1]
        moved = positions + np.array([0.0, 0.1 * k, 0.0])
        (folder / f"frames/sheet.{k:04d}.ply").write_bytes(ply_bytes(moved, kept, uv[kept]))
        content = ply_bytes(result.avatar.vertices, result.avatar.faces)
        (folder / f"frames/body.{k:04d}.ply").write_bytes(content)
    return folder


@pytest.fixture(scope="module")
def page() -> Iterator[Any]:
    with opened_page() as opened:
        yield opened


def test_stretch_is_that_of_the_worst_direction() -> None:
    positions, faces, uv = sheet()
    assert largest_stretch(positions, faces, uv) == pytest.approx(10.0, abs=1e-9)
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    assert largest_stretch(positions, faces, uv @ turn) == pytest.approx(10.0, abs=1e-9)


def test_a_folder_shows_bodies_panels_and_the_pattern(film_folder: Path) -> None:
    body, cloth = view_of_folder(film_folder)
    assert (body.kind, cloth.kind, cloth.panel_names) == ("body", "garment", ("square",))
    pose = cloth.poses[0]
    assert pose.shape.uv == pytest.approx(sheet()[2], abs=1e-6)
    assert pose.fields[0].values == pytest.approx(10.0, abs=1e-3)
    _, alone = parts_of_glb(GltfFile(film_folder / "dressed.glb"))
    assert alone.panel_names == ()


def test_a_film_keeps_triangles_that_stay(film_folder: Path) -> None:
    body, cloth = film_of_folder(film_folder, view_of_folder(film_folder))
    assert [len(part.poses) for part in (body, cloth)] == [3, 3]
    first, second, third = (pose.shape for pose in cloth.poses)
    assert first is second and first is not third
    heights = [float(pose.positions[:, 1].mean()) for pose in cloth.poses]
    assert heights == pytest.approx([0.0, 0.1, 0.2], abs=1e-6)


def test_view_command(film_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / "new" / "page.html"
    assert main(["view", str(film_folder), "--no-open", "-o", str(page)]) == 0
    assert not re.search(r"(src|href)=", page.read_text()), "everything is in the page"
    again = page.read_bytes()
    main(["view", str(film_folder), "--no-open", "-o", str(page)])
    assert page.read_bytes() == again
    assert main(["view", str(tmp_path), "--no-open"]) == 2
    assert "there is no dressed.glb" in capsys.readouterr().err
    assert main(["view", str(film_folder), "--no-open", "--every", "0"]) == 2


def test_a_notebook_shows_a_result(result: Result) -> None:
    shown = result._repr_html_()
    assert shown.startswith("<iframe") and "<script" not in shown


def test_the_page_of_a_result(page: Any, result: Result, tmp_path: Path) -> None:
    result.save(tmp_path)
    page.goto((tmp_path / "view.html").as_uri())
    page.wait_for_selector("[data-ready=yes]")
    canvas = page.locator("[data-view=canvas]")
    page.wait_for_function("document.getElementById('canvas').dataset.drawn === '2'")
    assert page.locator("[data-view=pieces]").get_attribute("data-pieces") == "1"
    page.click("text=Front")
    page.select_option("[data-view=colour]", "strain along warp")
    box = canvas.bounding_box()
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.move(*middle)
    page.wait_for_function("document.querySelector('[data-view=under]').textContent.includes('square')")
    assert "strain along warp 10.0 %" in page.locator("[data-view=under]").inner_text()
    pieces = page.locator("[data-view=pieces]").bounding_box()
    page.mouse.move(pieces["x"] + 60, pieces["y"] + 60)
    page.wait_for_function("document.querySelector('[data-view=under]').textContent.includes('square')")
    page.uncheck("#body")
    page.wait_for_function("document.getElementById('canvas').dataset.drawn === '1'")
    assert not page.problems


def test_distances_are_measured_by_pointer_and_by_keys(page: Any, result: Result, tmp_path: Path) -> None:
    result.save(tmp_path)
    page.goto((tmp_path / "view.html").as_uri())
    page.wait_for_selector("[data-ready=yes]")
    page.click("text=Front")
    page.wait_for_timeout(100)
    places = page.evaluate(
        "() => { const b = document.getElementById('canvas').getBoundingClientRect();"
        "return [[-0.2, 0, 0.6], [0.2, 0, 0.6]].map((p) => { const q = window.viewer.stage.project(p);"
        "return [q[0] + b.left, q[1] + b.top]; }); }"
    )
    page.click("text=Measure")
    for place in places:
        page.mouse.click(*place)
    page.wait_for_function("document.querySelector('[data-view=measured]').textContent.includes('cm')")
    length = float(page.locator("[data-view=measured]").inner_text().split()[0])
    assert length == pytest.approx(40.0, abs=0.5)
    page.locator("[data-view=canvas]").focus()
    page.keyboard.press("Escape")
    page.keyboard.press("m")
    before = page.evaluate("window.viewer.stage.turn")
    page.keyboard.press("ArrowLeft")
    assert page.evaluate("window.viewer.stage.turn") != before
    page.keyboard.press("Enter")
    page.wait_for_function("document.querySelectorAll('[data-view=marks] circle').length === 1")
    with page.expect_download() as download:
        page.click("text=Picture")
    assert Path(download.value.path()).read_bytes().startswith(b"\x89PNG")
    assert not page.problems


def test_a_film_plays_and_goes_to_frames(page: Any, film_folder: Path) -> None:
    assert main(["view", str(film_folder), "--no-open"]) == 0
    page.set_viewport_size({"width": 390, "height": 780})
    page.goto((film_folder / "view.html").as_uri())
    page.wait_for_selector("[data-ready=yes]")
    height = "(() => { const p = window.viewer.stage.meshes[1].positions; let s = 0;"
    height += "for (let k = 1; k < p.length; k += 3) s += 3 * p[k] / p.length; return s; })()"
    assert page.evaluate(height) == pytest.approx(0.0, abs=1e-4)
    for frame, expected in ((2, 0.2), (1, 0.1)):
        page.evaluate(f"window.viewer.goTo({frame})")
        assert page.evaluate(height) == pytest.approx(expected, abs=1e-4)
    page.click("text=Play")
    page.wait_for_function("window.viewer.frameShown !== 1")
    page.click("text=Pause")
    assert page.evaluate("document.documentElement.scrollWidth") <= 390, "nothing sticks out on a phone"
    assert not page.problems
