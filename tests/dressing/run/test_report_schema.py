"""Reports are what the published schema says, and their figures are those of the garments as they end."""

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

import toile
from tests.dressing.json_schema import misfits
from tests.dressing.run.test_report import make
from tests.dressing.wear.test_lay_on import sheet
from toile.dressing.run.output import report_schema
from toile.dressing.run.output.garment_figures import strain_figures
from toile.dressing.run.report import SCHEMA


@pytest.fixture(scope="module")
def schema() -> dict[str, Any]:
    return report_schema()


@pytest.fixture(scope="module")
def film(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, toile.Result, list[toile.ProgressState]]:
    """A small sheet on a ball that sinks by 10 cm in three frames, and what its progress was."""
    folder = tmp_path_factory.mktemp("film")
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.3)
    positions = np.asarray(ball.vertices) + np.array([0.0, 0.3, 0.0])
    frames = np.stack([positions - np.array([0.0, 0.03 * frame, 0.0]) for frame in range(4)])
    np.savez(folder / "ball.npz", vertices=frames, faces=np.asarray(ball.faces), fps=24.0)
    rows = [line.split() for line in sheet((-0.2, -0.2), (0.4, 0.4), 8).splitlines()]
    lines = [f"v {row[1]} 0.62 {row[2]}" if row[0] == "v" else " ".join(row) for row in rows]
    (folder / "sheet.obj").write_text("\n".join(lines) + "\n")
    seen: list[toile.ProgressState] = []
    scene = toile.Scene(
        garments=folder / "sheet.obj", avatar=toile.AvatarFile(path=folder / "ball.npz", units="m", up="y"),
        edge_length=0.05, ground=False,
    )  # fmt: skip
    result = toile.dress(scene, folder / "out", progress=seen.append)
    return folder, result, seen


def test_reports_fit_the_schema(
    schema: dict[str, Any], film: tuple[Path, toile.Result, list[toile.ProgressState]]
) -> None:
    folder, result, _ = film
    written = json.loads((folder / "out/report.json").read_text())
    assert written == json.loads(json.dumps(result.report)) and written["schema"] == SCHEMA
    assert not list(misfits(written, schema))
    still = written | written["drape"]
    del still["animation"], still["drape"]
    assert not list(misfits(still, schema))
    assert list(misfits(written | {"frames": -1, "stray": 0, "status": "fine"}, schema)) == [
        "report.status: 'fine' is none of ['converged', 'frame_limit', 'cancelled', 'failed']",
        "report.frames: -1 is below 0",
        "report: stray is unknown",
    ]
    assert any("lacks fabric" in misfit for misfit in misfits(make(), schema))


def test_a_film_has_the_figures_of_its_end(
    film: tuple[Path, toile.Result, list[toile.ProgressState]],
) -> None:
    """Not those of the drape on its first frame, which come under `drape`."""
    _, result, seen = film
    report, garment = result.report, result.garments[0]
    assert report["animation"]["frames"] == 3
    assert report["nodes"]["final"] == report["garments"][0]["nodes"] == len(garment.positions)
    assert report["faces"]["final"] == report["garments"][0]["faces"] == len(garment.faces)
    assert garment.strain is not None
    assert report["strain_percent"]["warp_max"] == pytest.approx(100.0 * garment.strain[:, 0].max(), abs=1e-6)
    assert report["drape"]["strain_percent"]["warp_max"] != report["strain_percent"]["warp_max"]
    phases = list(dict.fromkeys(state.phase for state in seen))
    assert phases == ["growing", "settling", "film"]
    assert [state.frame for state in seen if state.phase == "film"] == [0, 1, 2, 3]


def test_inputs_are_hashed(film: tuple[Path, toile.Result, list[toile.ProgressState]]) -> None:
    folder, result, _ = film
    assert result.report["inputs"] == [
        {"of": of, "file": name, "sha256": hashlib.sha256((folder / name).read_bytes()).hexdigest()}
        for of, name in (("avatar", "ball.npz"), ("garment sheet", "sheet.obj"))
    ]


def test_strain_is_told_by_panel_and_place() -> None:
    """Two squares: one stretched along its warp by 20 %, the other of three times the area at rest."""
    positions = np.array([[0, 0, 0], [0.12, 0, 0], [0.12, 0.1, 0], [0, 0.1, 0]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    large = positions * (0.3 / 0.12, 1.2, 1.0) + (1.0, 0.0, 0.0)
    garment = toile.DressedGarment(
        name="a", fabric=toile.fabric("canvas"), positions=np.concatenate([positions, large]),
        faces=np.concatenate([faces, faces + 4]).astype(np.int32), uv=np.zeros((8, 2)),
        uv_faces=np.concatenate([faces, faces + 4]).astype(np.int32),
        panel=np.array([0, 0, 1, 1], np.int32), panel_names=("small", "large"),
        strain=np.array([[0.2, 0.0], [0.1, -0.05], [0.0, 0.0], [0.0, 0.0]]),
    )  # fmt: skip
    figures = strain_figures(garment)
    assert figures["strain"]["area_m2"] == pytest.approx(0.048)
    assert figures["strain"]["warp_percent"] == pytest.approx({"min": 0, "median": 0, "p95": 20, "max": 20})
    assert figures["strain"]["max_at"] == pytest.approx(positions[faces[0]].mean(axis=0))
    small, other = figures["panel_strain"]
    assert (small["panel"], other["panel"]) == ("small", "large")
    assert small["weft_percent"] == pytest.approx({"min": -5, "median": -5, "p95": 0, "max": 0})
    assert small["warp_percent"] == pytest.approx({"min": 10, "median": 10, "p95": 20, "max": 20})
    assert other["warp_percent"]["max"] == 0.0
