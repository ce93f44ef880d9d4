"""`toile batch` as a person uses it: real garments, mistakes among them, resuming, status, export, Ctrl-C."""

import csv
import hashlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import trimesh

from tests.dressing.report_keys import VOLATILE_KEYS
from toile.dressing.batch.ledger import rows
from toile.dressing.cli.main import main


def batch(*arguments: object) -> int:
    return main(["batch", *(str(argument) for argument in arguments)])


def contents(folder: Path) -> dict[str, str]:
    """Hash of every result file by its path; of report.json without what differs between runs."""
    found = {}
    for path in sorted((folder / "jobs").rglob("*")):
        if path.name == "report.json":
            report = json.loads(path.read_text())
            kept = {key: value for key, value in report.items() if key not in VOLATILE_KEYS}
            found[str(path.relative_to(folder))] = json.dumps(kept, sort_keys=True)
        elif path.is_file() and path.name != "job.json":
            found[str(path.relative_to(folder))] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


def shapes(folder: Path) -> None:
    """Write a body without limbs and a tube around it [m], too narrow above to slip off."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    ball.apply_scale((0.20, 0.85, 0.12))
    ball.apply_translation((0.0, 0.85, 0.0))
    ball.export(folder / "body.obj", include_normals=False)
    turns = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    rings = [
        ((0.26 - 0.07 * up) * np.cos(turn), 0.8 + 0.4 * up, (0.26 - 0.14 * up) * np.sin(turn))
        for up in np.linspace(0.0, 1.0, 9) for turn in turns
    ]  # fmt: skip
    quads = [(24 * row + k, 24 * row + (k + 1) % 24) for row in range(8) for k in range(24)]
    faces = [face for a, b in quads for face in ((a, a + 24, b), (b, a + 24, b + 24))]
    trimesh.Trimesh(rings, faces, process=False).export(folder / "tube.obj", include_normals=False)


QUICK = ("--quality", "preview", "--max-frames", 6)


@pytest.fixture(scope="module")
def jobs_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A tube in two ways, a few frames long, and files that cannot be read."""
    folder = tmp_path_factory.mktemp("jobs")
    shapes(folder)
    (folder / "text.ply").write_text("this is no mesh\n")
    (folder / "empty.obj").write_text("")
    path = folder / "jobs.csv"
    path.write_text(
        "name,avatar,garment,fabric,remesh,edge_length\n"
        "plain,body.obj,tube.obj,,false,0.1\n"
        "text,text.ply,tshirt,,,\n"
        "gone,nowhere.obj,tshirt,,,\n"
        "empty,body.obj,empty.obj,,,\n"
        "stiff,body.obj,tube.obj,canvas,false,0.1\n"
    )
    return path


@pytest.fixture(scope="module")
def finished(jobs_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The batch of that file, run on one worker."""
    out = tmp_path_factory.mktemp("finished")
    assert batch("--jobs", jobs_file, *QUICK, "--workers", 1, "-o", out) == 1, "some jobs failed"
    return out


def test_good_jobs_are_dressed_and_bad_ones_say_why(finished: Path) -> None:
    table = {row["name"]: row for row in rows(finished)}
    assert [table[name]["failure_class"] for name in ("text", "gone", "empty")] == ["bad_input"] * 3
    assert "text.ply: cannot be read as a mesh" in table["text"]["message"]
    assert "nowhere.obj: avatar file not found" in table["gone"]["message"]
    assert "empty.obj: the file is empty" in table["empty"]["message"]
    for name in ("plain", "stiff"):
        assert table[name]["state"] == "done" and table[name]["status"] in ("frame_limit", "converged")
        assert table[name]["nodes"] > 20 and table[name]["avatar_intersections"] == 0
        assert table[name]["peak_memory"] > 1e8 and table[name]["cpu_seconds"] > 0.1
        assert len(json.loads(table[name]["inputs"])) == 2
    files = "dressed.glb job.json preview.png report.json thumbnail.png tube.obj tube.ply view.html".split()
    assert sorted(os.listdir(finished / "jobs/plain")) == files
    assert sorted(os.listdir(finished / "jobs")) == ["plain", "stiff"]


@pytest.mark.parametrize(
    "options",
    [
        ("--workers", 2),
        ("--workers", 2, "--dask", "local"),
        pytest.param(("--workers", 2, "--dask", "local", "--ship"), marks=pytest.mark.slow),
    ],
    ids=["two", "dask", "shipped"],
)
def test_the_same_bytes_on_two_workers_and_on_dask(
    options: tuple[object, ...], finished: Path, jobs_file: Path, tmp_path: Path
) -> None:
    if "--dask" in options:
        pytest.importorskip("distributed")
    expected = contents(finished)
    assert len(expected) == 14
    assert batch("--jobs", jobs_file, *QUICK, "-o", tmp_path / "out", "--quiet", *options) == 1
    assert contents(tmp_path / "out") == expected


def test_again_and_retry(finished: Path, jobs_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ("--jobs", jobs_file, *QUICK, "-o", finished)
    started = time.monotonic()
    assert batch(*command) == 1
    assert "5 of them earlier" in capsys.readouterr().out
    assert time.monotonic() - started < 5.0
    assert batch(*command, "--retry", "failed", "--workers", 2) == 1
    assert "2 of them earlier" in capsys.readouterr().out
    attempts = {row["name"]: row["attempts"] for row in rows(finished)}
    assert attempts == {"plain": 1, "stiff": 1, "text": 2, "gone": 2, "empty": 2}


def test_status_and_export(finished: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert batch("status", finished) == 0
    said = capsys.readouterr().out
    assert "done     2" in said and "failed   3 (3 bad_input)" in said and "left     0" in said
    assert batch("export", finished, tmp_path / "new/results.csv") == 0
    with open(tmp_path / "new/results.csv", newline="") as file:
        table = list(csv.DictReader(file))
    assert [row["name"] for row in table] == ["empty", "gone", "plain", "stiff", "text"]
    assert table[0]["failure_class"] == "bad_input"
    pyarrow = pytest.importorskip("pyarrow.parquet")
    assert batch("export", finished, tmp_path / "results.parquet") == 0
    columns = pyarrow.read_table(tmp_path / "results.parquet").to_pydict()
    assert columns["name"] == [row["name"] for row in table]
    assert batch("export", finished, tmp_path / "results.xlsx") == 2
    assert "unknown kind of table" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--garments", "tshirt"), "give the batch's folder with -o DIR"),
        (("-o", "out"), "nothing to dress: give --garments or --jobs"),
        (("--avatars", "nothing*.ply", "--garments", "tshirt", "-o", "out"), "no file matches"),
        (("--jobs", "jobs.csv", "--garments", "tshirt", "-o", "out"), "--jobs names bodies"),
        (("--jobs", "jobs.csv", "-o", "out"), "there is no such jobs file"),
        (("--garments", "tshirt", "--workers", "0", "-o", "out"), "workers must lie between 1 and 1024"),
        (("--garments", "tshirt", "--quality", "best", "-o", "out"), "unknown quality 'best'"),
        (("--garments", "tshirt", "--ship", "-o", "out"), "without dask there are none"),
        (("status", "out"), "there is no batch here"),
        (("export", "out", "a.csv"), "there is no batch here"),
    ],
)
def test_bad_options(
    arguments: tuple[str, ...],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert batch(*arguments) == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1


def many_jobs(folder: Path, count: int) -> Path:
    """Write the shapes and a file with jobs of them."""
    shapes(folder)
    path = folder / "jobs.csv"
    lines = [f"job{k},body.obj,tube.obj,false,0.1\n" for k in range(count)]
    path.write_text("name,avatar,garment,remesh,edge_length\n" + "".join(lines))
    return path


@pytest.mark.parametrize("presses", [1, 2])
def test_ctrl_c_finishes_or_ends_what_runs(presses: int, tmp_path: Path) -> None:
    table = many_jobs(tmp_path, 30)
    out = tmp_path / "out"
    command = [
        sys.executable,
        "-m",
        "toile.dressing.cli.main",
        "batch",
        "--jobs",
        str(table),
        "--workers",
        "1",
    ]
    command += [*map(str, QUICK), "-o", str(out)]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    until = time.monotonic() + 60.0
    while not list((out / "jobs").glob("*")) and time.monotonic() < until:
        time.sleep(0.05)
    for _ in range(presses):
        process.send_signal(signal.SIGINT)
        time.sleep(0.3)
    _, error = process.communicate(timeout=60.0)
    assert process.returncode == 130
    assert "cancelled" in error
    states = {row["state"] for row in rows(out)}
    assert "running" not in states
    if presses == 1:
        assert "the same command resumes" in error
        assert len(list((out / "jobs").iterdir())) >= 2
    else:
        assert "pending" in states


@pytest.mark.skipif(
    sys.platform != "linux" or os.geteuid() != 0, reason="mounting a small disk needs root on Linux"
)
def test_a_disk_that_runs_full(tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=1000k", "tmpfs", str(disk)], capture_output=True
    )
    if mounted.returncode:
        pytest.skip("a small disk cannot be mounted here")
    try:
        table = many_jobs(tmp_path, 5)
        command = [
            sys.executable,
            "-m",
            "toile.dressing.cli.main",
            "batch",
            "--jobs",
            str(table),
            "--workers",
            "1",
        ]
        command += [*map(str, QUICK), "-o", str(disk / "out"), "--quiet"]
        full = subprocess.run(command, capture_output=True, text=True)
        assert full.returncode == 3, full.stderr
        assert "the disk is full; finished jobs are kept" in full.stderr.splitlines()[-1]
        assert "Traceback" not in full.stderr
        kept = sorted(path.name for path in (disk / "out/jobs").iterdir())
        assert 1 <= len(kept) < 5
        before = {name: (disk / "out/jobs" / name / "dressed.glb").stat().st_mtime_ns for name in kept}
        subprocess.run(["mount", "-o", "remount,size=60m", str(disk)], check=True)
        again = subprocess.run(command, capture_output=True, text=True)
        assert again.returncode == 0, again.stderr
        assert len(list((disk / "out/jobs").iterdir())) == 5
        for name, changed in before.items():
            assert (disk / "out/jobs" / name / "dressed.glb").stat().st_mtime_ns == changed
    finally:
        subprocess.run(["umount", str(disk)], check=False)
