"""The pages of a batch in a real browser: cards, filters, the 3-D view, the summary."""

from array import array
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from tests.dressing.browser import opened_page
from toile.dressing.batch.batch_progress import BatchProgress
from toile.dressing.batch.gallery.histogram import histogram
from toile.dressing.batch.gallery.write_gallery import write_gallery
from toile.dressing.batch.ledger import Entry, Ledger
from toile.dressing.batch.outcome import Outcome
from toile.dressing.batch.thumbnail import smaller, write_thumbnail
from toile.dressing.body.avatar import Avatar
from toile.dressing.files.writers.png import png_bytes, png_pixels
from toile.dressing.garment.fabrics import fabric
from toile.dressing.run.result import DressedGarment, dressed_glb
from toile.geometry.errors import InputError


@pytest.fixture(scope="module")
def batch_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A batch of 300 jobs that never ran: a third failed, the first one has shapes."""
    folder = tmp_path_factory.mktemp("batch")
    ledger = Ledger(folder)
    ledger.begin_run(1, 300)
    for k in range(300):
        name = f"job{k:03d}"
        ledger.register(
            Entry(
                name=name, avatar=f"body{k % 5}", garments="tshirt", fabrics="canvas", quality="preview",
                fingerprint=str(k), inputs={}, settings={},
            )
        )  # fmt: skip
        failed = k % 3 == 1
        ledger.end(
            name,
            Outcome(
                state="failed" if failed else "done",
                failure_class=("timeout" if k % 2 else "open_seams") if failed else "",
                message="<b>stopped</b> & gone" if failed else "",
                published=k == 0,
                cpu_seconds=float(k),
                peak_memory=300_000_000,
                figures={} if failed else {"status": "converged", "strain_p99": 0.1 * k, "faces": 2000},
            ),
        )
    ledger.end_run()
    ledger.close()
    result = folder / "jobs" / "job000"
    result.mkdir(parents=True)
    (result / "dressed.glb").write_bytes(glb())
    (result / "preview.png").write_bytes(png_bytes(np.full((40, 80, 3), 200, dtype=np.uint8)))
    write_thumbnail(result)
    return folder


def glb() -> bytes:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.8)
    tube = trimesh.creation.cylinder(radius=0.9, height=0.6, sections=40, cap=False)
    points, faces = np.asarray(tube.vertices), np.asarray(tube.faces, dtype=np.int32)
    garment = DressedGarment(
        name="tube", fabric=fabric("canvas"), positions=points, faces=faces, uv=points[:, :2].copy(),
        uv_faces=faces, panel=np.zeros(len(faces), dtype=np.int32), panel_names=("tube",),
    )  # fmt: skip
    body = Avatar(
        name="ball", vertices=np.asarray(ball.vertices), faces=np.asarray(ball.faces, dtype=np.int32)
    )
    return dressed_glb(body, (garment,))


@pytest.fixture(scope="module")
def page(batch_folder: Path) -> Iterator[Any]:
    """A page of headless Chromium that may not reach the network."""
    write_gallery(batch_folder)
    with opened_page() as opened:
        yield opened


def address(folder: Path, page: str) -> str:
    return f"{(folder / 'gallery').as_uri()}/{page}"


def test_cards_and_filters(page: Any, batch_folder: Path) -> None:
    page.goto(address(batch_folder, "index.html"))
    assert page.locator("#count").inner_text() == "300 of 300 jobs"
    assert 100 <= page.locator(".card").count() < 300, "cards come as one scrolls"
    page.wait_for_function("document.querySelector('.card img').naturalWidth === 20")
    page.select_option("#state", "failed")
    assert page.locator("#count").inner_text() == "100 of 300 jobs"
    assert "<b>stopped</b> & gone" in page.locator(".card").first.inner_text()
    page.select_option("#class", "timeout")
    assert page.locator("#count").inner_text() == "50 of 300 jobs"
    page.click("button[type=reset]")
    page.wait_for_function("document.getElementById('count').textContent === '300 of 300 jobs'")
    page.fill("#strain_low", "10")
    page.fill("#strain_high", "20")
    assert page.locator("#count").inner_text() == "67 of 300 jobs"
    page.fill("#cpu_high", "110")
    assert page.locator("#count").inner_text() == "7 of 300 jobs"
    page.select_option("#order", "cpu_seconds")
    assert page.locator(".card b").first.inner_text() == "job110"
    page.fill("#find", "no such thing")
    assert "No job fits" in page.locator("#cards").inner_text()
    assert not page.problems


def test_each_card_opens_its_3d_view(page: Any, batch_folder: Path) -> None:
    page.goto(address(batch_folder, "index.html"))
    page.locator(".card").first.click()
    page.wait_for_function("document.getElementById('canvas').dataset.drawn === '2'")
    colours = "(() => { const c = document.getElementById('canvas'), t = document.createElement('canvas');"
    colours += "t.width = 60; t.height = 60; const d = t.getContext('2d'); d.drawImage(c, 0, 0, 60, 60);"
    colours += "const p = d.getImageData(0, 0, 60, 60).data, s = new Set();"
    colours += "for (let k = 0; k < p.length; k += 4) if (p[k + 3]) s.add(p[k] >> 4);"
    colours += "return s.size; })()"
    assert page.evaluate(colours) > 4, "a shaded ball in a tube has many shades"
    page.uncheck("#body")
    page.wait_for_function("document.getElementById('canvas').dataset.drawn === '1'")
    page.goto(address(batch_folder, "view.html#job001"))
    page.wait_for_selector("text=<b>stopped</b> & gone")
    assert not page.problems


def test_summary(page: Any, batch_folder: Path) -> None:
    page.goto(address(batch_folder, "summary.html"))
    text = page.locator("main").inner_text()
    assert "66.7 %" in text and "finished: 200 of 300" in text
    assert "seams did not close" in text
    assert page.locator("figure svg").count() == 4
    assert "job299" in page.locator("table").last.inner_text()
    page.click("text=timeout")
    page.wait_for_selector("#count")
    assert page.locator("#count").inner_text() == "50 of 300 jobs"
    assert not page.problems


def test_pages_again_take_what_is_new(batch_folder: Path) -> None:
    write_gallery(batch_folder)
    view = batch_folder / "gallery/views/job000.js"
    before = view.stat().st_mtime_ns
    assert write_gallery(batch_folder) == batch_folder / "gallery/index.html"
    assert view.stat().st_mtime_ns == before


def test_thumbnail_of_own_pictures() -> None:
    pixels = np.random.default_rng(1).integers(0, 256, (12, 20, 3), dtype=np.uint8)
    assert np.array_equal(png_pixels(png_bytes(pixels)), pixels)
    small = smaller(pixels, 4)
    assert small.shape == (3, 5, 3)
    assert abs(int(small[0, 0, 0]) - pixels[:4, :4, 0].mean()) <= 0.5


def test_a_folder_without_a_batch(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no batch here"):
        write_gallery(tmp_path)


def test_one_job_is_one_job() -> None:
    """And a figure without a unit leaves no gap."""
    page = histogram("faces", "", array("d", [2280.0]))
    assert "95th percentile 2,280, 1 job</p>" in page
    assert " </text>" not in page
    assert BatchProgress(total=1).line(1) == "0/1 job: 0 done, 0 failed, 1 running"
