import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
import trimesh

import toile
from toile.dressing.body.avatar import Avatar
from toile.dressing.cli.main import main
from toile.dressing.cli.parser import body_length
from toile.dressing.pattern.sewing_edges import SEWING_COARSENESS
from toile.dressing.run.kernels import REMESH_KERNELS
from toile.dressing.run.quality import quality_preset
from toile.dressing.run.resolved_scene import SEWING_FINENESS
from toile.geometry.cache_folder import cache_root

FakeDrapes = Callable[..., Any]
FILES = {"dressed.glb", "preview.png", "report.json", "shirt.obj", "shirt.ply", "view.html"}


@pytest.fixture
def body(tmp_path: Path) -> Path:
    """A body of the size of a torso with limbs missing, in centimetres, Z up."""
    shape = trimesh.creation.icosphere(subdivisions=3)
    shape.apply_scale((20.0, 12.0, 85.0))
    shape.apply_translation((0.0, 0.0, 85.0))
    path = tmp_path / "body.obj"
    shape.export(path, include_normals=False)
    return path


@pytest.fixture
def shirt(tmp_path: Path) -> Path:
    """A tube around that body in its file's units."""
    tube = trimesh.creation.cylinder(30.0, 40.0, sections=24, cap=False)
    tube.apply_translation((0.0, 0.0, 100.0))
    path = tmp_path / "shirt.obj"
    tube.export(path, include_normals=False)
    return path


def dress(*arguments: object) -> int:
    return main(["dress", *(str(argument) for argument in arguments)])


def one_line(capsys: pytest.CaptureFixture[str]) -> str:
    error = capsys.readouterr().err
    assert error.count("\n") == 1, error
    assert "Traceback" not in error
    return error


def test_outputs(
    tmp_path: Path, body: Path, shirt: Path, fake_drape: FakeDrapes, capsys: pytest.CaptureFixture[str]
) -> None:
    fake = fake_drape()
    out = tmp_path / "deep" / "out"
    options = ("--units", "cm", "--up", "z", "--fabric", "canvas", "--quality", "preview", "--max-frames", 9)
    assert dress("--avatar", body, "--garment", shirt, *options, "-o", out) == 0
    assert set(os.listdir(out)) == FILES
    report = json.loads((out / "report.json").read_text())
    assert report["status"] == "converged"
    assert report["avatar"]["up_axis"] == "z"
    assert report["garments"][0]["fabric"] == "canvas"
    assert report["min_gap_mm"] is None
    ((form, [(mesh, fabric)], asked),) = fake.calls
    assert fabric.name == "canvas"
    assert asked.max_frames == 9
    assert asked.sizing.size_min == quality_preset("preview").edge_length
    assert form.avatar.vertices[:, 1].max() == pytest.approx(1.7, abs=0.01)
    # The garment's files are in the avatar file's units and axes, dressed.glb is in metres, Y up.
    written = trimesh.load(out / "shirt.ply", process=False)
    assert written.bounds[:, 2] == pytest.approx([80.0, 120.0])
    assert trimesh.load(out / "shirt.obj", process=False).bounds[:, 2] == pytest.approx([80.0, 120.0])
    scene = trimesh.load_scene(out / "dressed.glb")
    assert set(scene.geometry) == {"body", "shirt"}
    assert scene.geometry["shirt"].bounds[:, 1] == pytest.approx([0.8, 1.2])
    assert np.allclose(mesh.positions[:, 1].min(), 0.8)
    assert "converged after 6 frames" in capsys.readouterr().out


def test_more_formats(tmp_path: Path, body: Path, shirt: Path, fake_drape: FakeDrapes) -> None:
    """In the avatar file's units, like the other files, with the panels of the report."""
    fake_drape()
    options = ("--units", "cm", "--up", "z", "--quality", "preview", "--format", "vtu", "--format", "inp")
    assert dress("--avatar", body, "--garment", shirt, *options, "-o", tmp_path / "out") == 0
    assert set(os.listdir(tmp_path / "out")) == FILES | {"shirt.vtu", "shirt.inp"}
    read = meshio.vtu.read(tmp_path / "out" / "shirt.vtu")
    sewn = meshio.abaqus.read(tmp_path / "out" / "shirt.inp")
    assert read.points[:, 2].min() == pytest.approx(80.0)
    assert np.array_equal(sewn.points, trimesh.load(tmp_path / "out" / "shirt.ply", process=False).vertices)
    panels = json.loads((tmp_path / "out" / "report.json").read_text())["garments"][0]["panels"]
    assert set(read.cell_data["panel"][0].tolist()) == set(range(len(panels)))


def test_no_remesh_keeps_the_mesh_and_loads_no_kernels_for_it(
    tmp_path: Path, body: Path, shirt: Path, fake_drape: FakeDrapes, monkeypatch: pytest.MonkeyPatch
) -> None:
    loaded: list[str] = []
    monkeypatch.setattr("toile.dressing.run.hang.load_kernels", loaded.extend)
    fake = fake_drape()
    options = (
        "--avatar",
        body,
        "--garment",
        shirt,
        "--quality",
        "preview",
        "-o",
        tmp_path / "out",
        "--quiet",
    )
    assert dress(*options, "--no-remesh") == 0
    ((_, _, asked),) = fake.calls
    assert asked.sizing is None
    assert asked.edge_length == quality_preset("preview").edge_length
    assert loaded and not set(loaded) & set(REMESH_KERNELS)
    assert dress(*options) == 0
    assert fake.calls[1][2].sizing is not None and set(REMESH_KERNELS) <= set(loaded)


def test_a_garment_that_jams_is_sewn_again_in_other_triangles(
    tmp_path: Path, body: Path, shirt: Path, fake_drape: FakeDrapes, capsys: pytest.CaptureFixture[str]
) -> None:
    fake = fake_drape()
    fake.jams = len(SEWING_COARSENESS) - 1
    options = ("--avatar", body, "--garment", shirt, "--quality", "preview")
    assert dress(*options, "-o", tmp_path / "out") == 0
    finest = quality_preset("preview").edge_length
    asked = [options for _, _, options in fake.calls]
    assert [one.edge_length / finest for one in asked] == pytest.approx(SEWING_COARSENESS)
    assert [one.persistent for one in asked] == [*[False] * fake.jams, True]
    assert capsys.readouterr().out.count("seams jammed in triangles of") == fake.jams
    report = json.loads((tmp_path / "out/report.json").read_text())
    assert report["stage_cpu_seconds"]["solve"] == pytest.approx(0.25 * len(SEWING_COARSENESS))
    fake.calls.clear()
    assert dress(*options, "--no-remesh", "-o", tmp_path / "other", "--quiet") == 0
    asked = [options for _, _, options in fake.calls]
    assert [one.edge_length / finest for one in asked] == pytest.approx(SEWING_FINENESS)
    assert [one.persistent for one in asked] == [False, True]


def test_scene_file_and_options_that_win(
    tmp_path: Path, body: Path, shirt: Path, fake_drape: FakeDrapes
) -> None:
    fake = fake_drape()
    scene = tmp_path / "scene.toml"
    scene.write_text(
        'quality = "preview"\n[avatar]\nfile = "body.obj"\n'
        '[[garment]]\nsource = "shirt.obj"\nfabric = "mine"\npins = [0, 3]\nwarp_angle = 90\n'
        '[[garment]]\nsource = "shirt.obj"\nself_contact = false\n'
        "[fabric.mine]\nlike = 'canvas'\nshear = 7\n"
    )
    assert dress(scene, "--edge-length", 0.1, "-o", tmp_path / "out", "--quiet") == 0
    ((_, garments, asked),) = fake.calls
    assert [mesh.name for mesh, _ in garments] == ["shirt", "shirt_2"]
    assert [fabric.shear for _, fabric in garments] == [7.0, 120.0]
    assert asked.sizing.size_min == 0.1
    assert asked.pins[0].tolist() == [0, 3]
    assert asked.self_contact == (True, False)
    turned, plain = garments[0][0].rest_corners, garments[1][0].rest_corners
    assert np.allclose(turned[..., 0], plain[..., 1])
    assert np.allclose(turned[..., 1], -plain[..., 0])
    assert (tmp_path / "out" / "shirt_2.obj").exists()


@pytest.mark.parametrize(("end", "code"), [("failed", 3), ("frame_limit", 0), ("converged", 0)])
def test_exit_codes(
    end: str,
    code: int,
    tmp_path: Path,
    body: Path,
    shirt: Path,
    fake_drape: FakeDrapes,
    capsys: pytest.CaptureFixture[str],
) -> None:
    fake_drape(end)
    out = tmp_path / "out"
    assert dress("--avatar", body, "--garment", shirt, "-o", out, "--quiet") == code
    assert set(os.listdir(out)) == FILES
    captured = capsys.readouterr()
    assert captured.out == ""
    assert ("cannot move (panel front)" in captured.err) == (code == 3)


def test_ctrl_c_keeps_the_result(tmp_path: Path, body: Path, shirt: Path, fake_drape: FakeDrapes) -> None:
    fake_drape(at_start=lambda: os.kill(os.getpid(), signal.SIGINT))
    before = signal.getsignal(signal.SIGINT)
    out = tmp_path / "out"
    assert dress("--avatar", body, "--garment", shirt, "-o", out, "--quiet") == 130
    assert signal.getsignal(signal.SIGINT) is before
    report = json.loads((out / "report.json").read_text())
    assert (report["status"], report["frames"]) == ("cancelled", 1)
    assert set(os.listdir(out)) == {*FILES, ".resume"}, "what --resume needs stays"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "nothing to dress"),
        (("--garment", "tshrt"), "unknown garment 'tshrt'; did you mean 'tshirt'"),
        (("--garment", "missing.obj"), "missing.obj: garment file not found"),
        (("--garment", "shirt.docx"), "unknown garment format '.docx'"),
        (("--garment", "missing.json"), "missing.json: garment file not found"),
        (("--garment", "tshirt", "--fabric", "denm"), "unknown fabric 'denm'; did you mean 'denim-12oz'"),
        (("--garment", "tshirt", "--quality", "best"), "unknown quality 'best'"),
        (("--garment", "tshirt", "--edge-length", "7"), "edge_length must lie between"),
        (("--garment", "tshirt", "--edge-length", "seven"), "invalid float value"),
        (("--garment", "tshirt", "--avatar", "missing.ply"), "missing.ply"),
        (("--garment", "tshirt", "--avatar", "body.xyz"), ".xyz"),
        (("--garment", "tshirt", "--units", "cm"), "--units"),
        (("--garment", "tshirt", "--fps", "0"), "--fps"),
        (("--colour", "red"), "unrecognized arguments"),
        (("--garment", "tshirt", "--threads", "0"), "threads must lie between 1 and"),
        (("scene.txt",), "ends in .toml"),
        (("missing.toml",), "no such scene file"),
    ],
)
def test_bad_options(
    arguments: tuple[str, ...],
    message: str,
    tmp_path: Path,
    fake_drape: FakeDrapes,
    capsys: pytest.CaptureFixture[str],
) -> None:
    fake = fake_drape()
    assert dress(*arguments, "-o", tmp_path / "out") == 2
    assert message in one_line(capsys)
    assert not fake.calls


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "the file is empty"),
        ("v 0 0 0\n", "no faces"),
        ("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
        ("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "no face has an area"),
        ("v 990 0 0\nv 991 0 0\nv 990 0 1\nf 1 2 3\n", "m away from the body"),
    ],
)
def test_bad_garment_files(
    content: str,
    message: str,
    tmp_path: Path,
    body: Path,
    fake_drape: FakeDrapes,
    capsys: pytest.CaptureFixture[str],
) -> None:
    fake_drape()
    garment = tmp_path / "bad.obj"
    garment.write_text(content)
    assert dress("--avatar", body, "--garment", garment, "-o", tmp_path / "out") == 2
    assert message in one_line(capsys)


def test_bad_scene_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text("[[garment]]\nsource = 'tshirt'\n[fabric.a]\nlike = 'canvas'\nstretch_weft = -1\n")
    assert dress(scene, "-o", tmp_path / "out") == 2
    assert "scene.toml, line 5: fabric 'a': stretch_weft must be greater than zero" in one_line(capsys)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("pins = ['waist']", "unknown label 'waist'"),
        ("pins = [99999]", "vertex 99999 is not in 0.."),
        ("warp_angle = { sleeve = 3 }", "unknown panel 'sleeve'"),
    ],
)
def test_names_that_the_garment_does_not_have(
    line: str, message: str, tmp_path: Path, body: Path, shirt: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(f"[avatar]\nfile = 'body.obj'\n[[garment]]\nsource = 'shirt.obj'\n{line}\n")
    assert dress(scene, "-o", tmp_path / "out", "--quiet") == 2
    assert message in one_line(capsys)


def test_output_folder_is_checked_before_anything_runs(
    tmp_path: Path,
    fake_drape: FakeDrapes,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    fake = fake_drape()
    (tmp_path / "file").write_text("")
    assert dress("--garment", "tshirt", "-o", tmp_path / "file" / "out") == 2
    assert "cannot write into the output folder" in one_line(capsys)

    def refused(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "write_bytes", refused)
    assert dress("--garment", "tshirt", "-o", tmp_path) == 2
    assert "Permission denied" in one_line(capsys)
    assert not fake.calls


def test_surprises_are_one_line_too(
    tmp_path: Path, body: Path, shirt: Path, fake_drape: FakeDrapes, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken() -> None:
        raise ZeroDivisionError("division\nby zero")

    fake_drape(at_start=broken)
    assert dress("--avatar", body, "--garment", shirt, "-o", tmp_path / "out", "--quiet") == 3
    assert "ZeroDivisionError: division by zero" in one_line(capsys)


def test_lists_and_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fabrics"]) == 0
    assert "cotton-poplin *" in capsys.readouterr().out
    assert main(["patterns"]) == 0
    assert capsys.readouterr().out.split() == ["circle_skirt", "trousers", "tshirt"]
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("toile ")
    assert main(["--help"]) == 0
    helped = capsys.readouterr().out
    assert "exit codes" in helped and f"compiled kernels are kept in {cache_root()}" in helped
    assert main(["dress", "--scene-keys"]) == 0
    assert "warp_angle" in capsys.readouterr().out


@pytest.mark.parametrize("extension", [".obj", ".ply", ".stl", ".glb"])
def test_mannequin_in_every_format(extension: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def build(*, height: float) -> Avatar:
        box = trimesh.creation.box((0.4, height, 0.3))
        faces = np.array(box.faces, dtype=np.int32)
        return Avatar(name="mannequin", vertices=np.array(box.vertices), faces=faces)

    monkeypatch.setattr("toile.dressing.body.mannequin.mannequin", build)
    path = tmp_path / f"new/body{extension}"
    assert main(["mannequin", "-o", str(path), "--height", "180"]) == 0
    body = trimesh.load(path, force="mesh")
    assert np.ptp(body.vertices[:, 1]) == pytest.approx(1.8)
    assert body.is_watertight


@pytest.mark.parametrize("text", ["180", "180cm", "1.8", "1.8m", "1800mm", " 180 cm "])
def test_lengths_of_bodies_come_in_any_unit(text: str) -> None:
    assert body_length(text) == pytest.approx(1.8)


@pytest.mark.parametrize("text", ["tall", "1.8 ft", ""])
def test_a_length_that_is_none_is_named(
    text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["mannequin", "-o", str(tmp_path / "body.ply"), "--height", text]) == 2
    assert "is no length; write 1.75m or 175cm" in one_line(capsys)


def test_mannequin_of_unknown_format(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mannequin", "-o", str(tmp_path / "body.docx")]) == 2
    assert "unknown format '.docx'" in one_line(capsys)


def test_patterns_are_written(tmp_path: Path) -> None:
    assert main(["patterns", "--write", str(tmp_path / "p")]) == 0
    written = sorted(os.listdir(tmp_path / "p"))
    assert written == [f"{name}_specification.json" for name in ("circle_skirt", "trousers", "tshirt")]


def test_import_and_help_are_quick_and_load_nothing_heavy() -> None:
    code = (
        "import sys, toile, toile.dressing.cli.main;"
        "heavy = {'numpy', 'numba', 'trimesh', 'scipy'} & set(sys.modules);"
        "assert not heavy, heavy"
    )
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", code], check=True)
    subprocess.run([sys.executable, "-m", "toile", "--help"], check=True, stdout=subprocess.DEVNULL)
    assert time.perf_counter() - start < 2.0


def test_public_names() -> None:
    for name in toile.__all__:
        assert getattr(toile, name) is not None
    assert callable(toile.dress)
    with pytest.raises(AttributeError):
        _ = toile.undress
