"""A certificate tells what changed: a vertex by a micrometre, a byte, a frame, a crossing."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

import toile
from toile.dressing.certificate.certificate import NAME, CertifiedGarment, seal_of, write_certificate
from toile.dressing.certificate.input_files import plain_data, sha256_of
from toile.dressing.certificate.verify import verify
from toile.dressing.cli.main import main
from toile.dressing.files.writers.ply import ply_bytes, read_own_ply
from toile.dressing.run.report import report_bytes
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError
from toile.remesh.panel.rectangle import rectangle

REPORT: dict[str, Any] = {"versions": {"toile": "0"}, "status": "converged", "residual": 1e-4}
FRAMES = 3


def sheet(height: float) -> tuple[Float, Int]:
    flat, faces = rectangle(0.3, 0.3, 0.1)
    return np.column_stack((flat[:, 0], np.full(len(flat), height), -flat[:, 1])), faces


@pytest.fixture
def result(tmp_path: Path) -> Path:
    """A film of a sheet above a ball, of three frames."""
    ball = trimesh.creation.icosphere(subdivisions=1, radius=0.1)
    body = ply_bytes(np.asarray(ball.vertices), np.asarray(ball.faces, np.int32))
    (tmp_path / "frames").mkdir()
    for index in range(FRAMES):
        (tmp_path / "frames" / f"body.{index:04d}.ply").write_bytes(body)
        cloth = ply_bytes(*sheet(0.11 + 0.01 * index))
        (tmp_path / "frames" / f"sheet.{index:04d}.ply").write_bytes(cloth)
    (tmp_path / "body.ply").write_bytes(body)
    (tmp_path / "sheet.ply").write_bytes(ply_bytes(*sheet(0.13)))
    (tmp_path / "report.json").write_bytes(report_bytes(REPORT))
    (tmp_path / "notes.txt").write_text("mine")
    write_certificate(tmp_path, StepOptions(), REPORT, [CertifiedGarment("sheet", 0)])
    return tmp_path


def test_what_is_whole_is_as_certified(result: Path) -> None:
    certificate = json.loads((result / NAME).read_text())
    assert len(certificate["shapes"]) == FRAMES + 1
    assert all(shape["crossings"] == {"body": 0, "cloth": 0} for shape in certificate["shapes"])
    assert certificate["outputs"]["sheet.ply"] == sha256_of(result / "sheet.ply")
    assert "notes.txt" not in certificate["outputs"]
    assert certificate["settings"]["gravity"] == 9.81
    assert verify(result) == []


def test_a_vertex_moved_by_a_micrometre(result: Path) -> None:
    mesh = read_own_ply(result / "frames" / "sheet.0001.ply")
    moved = mesh.positions.copy()
    moved[3, 1] += 1e-6
    (result / "frames" / "sheet.0001.ply").write_bytes(ply_bytes(moved, mesh.faces))
    assert verify(result) == ["frames/sheet.0001.ply: is not what was written"]


def test_a_changed_byte_and_a_removed_frame(result: Path) -> None:
    report = bytearray((result / "report.json").read_bytes())
    report[20] ^= 1
    (result / "report.json").write_bytes(report)
    (result / "frames" / "body.0002.ply").unlink()
    assert verify(result) == ["frames/body.0002.ply: is missing", "report.json: is not what was written"]


def test_a_changed_certificate(result: Path) -> None:
    certificate = json.loads((result / NAME).read_text())
    certificate["shapes"].pop(0)
    (result / NAME).write_text(json.dumps(certificate))
    assert verify(result) == ["certificate.json: was changed after it was sealed"]


def test_the_audit_does_not_trust_the_counts(result: Path) -> None:
    """Somebody presses the cloth into the body and certifies it anew, with the old counts."""
    certificate = json.loads((result / NAME).read_text())
    (result / "sheet.ply").write_bytes(ply_bytes(*sheet(0.05)))
    certificate["outputs"]["sheet.ply"] = sha256_of(result / "sheet.ply")
    certificate["seal"] = seal_of(certificate)
    (result / NAME).write_text(json.dumps(certificate))
    (fault,) = verify(result)
    assert fault.startswith("body.ply: ")
    assert fault.endswith("pairs of triangles of the cloth cross the body, certified are 0")


def test_rigid_trims_are_not_audited(tmp_path: Path) -> None:
    positions, faces = sheet(0.13)
    button = trimesh.creation.icosphere(subdivisions=0, radius=0.02)
    both = np.concatenate([positions, button.vertices + positions[0]])
    whole = np.concatenate([faces, np.asarray(button.faces, np.int32) + np.int32(len(positions))])
    (tmp_path / "body.ply").write_bytes(ply_bytes(*sheet(0.0)))
    (tmp_path / "coat.ply").write_bytes(ply_bytes(both, whole))
    for trims, clear in ((0, False), (len(button.faces), True)):
        write_certificate(tmp_path, StepOptions(), REPORT, [CertifiedGarment("coat", trims)])
        (shape,) = json.loads((tmp_path / NAME).read_text())["shapes"]
        assert (shape["crossings"]["cloth"] == 0) is clear


def test_scene_and_command(
    tmp_path: Path, fake_drape: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    fake_drape()
    body, square = tmp_path / "body.obj", tmp_path / "square.obj"
    trimesh.creation.icosphere(subdivisions=2, radius=0.85).export(body)
    square.write_text("v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 1 2 3\nf 1 3 4\n")
    out, other = tmp_path / "out", tmp_path / "other"
    scene = toile.Scene(avatar=body, garments=[toile.Garment(square)], certificate=True)
    toile.dress(scene, out)
    certificate = json.loads((out / NAME).read_text())
    assert certificate["inputs"] == {"square.obj": sha256_of(square), "body.obj": sha256_of(body)}
    assert certificate["settings"]["quality"] == "standard"
    assert {
        "dressed.glb",
        "preview.png",
        "report.json",
        "view.html",
        "body.ply",
        "square.ply",
        "square.obj",
    } == set(certificate["outputs"])
    assert main(["verify", str(out)]) == 0
    assert "converged; 7 files and 1 shapes are as certified, 0 pairs" in capsys.readouterr().out
    assert main(["verify", str(out), str(other)]) == 1
    assert capsys.readouterr().out.endswith("1 of 2 results are as certified\n")
    toile.dress(toile.Scene(avatar=body, garments=[toile.Garment(square)]), other)
    assert not (other / NAME).exists()
    assert not (other / "body.ply").exists()
    with pytest.raises(InputError, match="there is no certificate"):
        verify(other)
    (other / NAME).write_text("{}")
    with pytest.raises(InputError, match="is no certificate"):
        verify(other)


def test_settings_are_plain_data() -> None:
    assert plain_data({"a": (1, np.float64(2.0)), "p": Path("deep/file.obj"), "n": float("inf")}) == {
        "a": [1, 2.0], "p": "file.obj", "n": "inf",
    }  # fmt: skip
    assert plain_data(np.zeros(2))["shape"] == [2]
