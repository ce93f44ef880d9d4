"""An output folder belongs to one run at a time, and holds what that run wrote, not an earlier one."""

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.sparse import csr_array

from tests.dressing.run.test_dress import PYRAMID, scene, square
from toile.dressing.cli.main import main
from toile.dressing.files.writers.file_lock import try_lock, unlock
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.run.dress import dress, resume
from toile.dressing.run.output.earlier_run import remove_earlier_run
from toile.dressing.run.output.state_file import read_state, state_bytes
from toile.dressing.run.resolved_scene import ResolvedScene, resolve
from toile.dressing.run.scene import Garment, Scene
from toile.engine.forces.ground import Ground
from toile.geometry.errors import InputError

FILES = {"dressed.glb", "preview.png", "report.json", "square.obj", "square.ply", "view.html"}


def test_a_second_run_into_the_same_folder_is_refused(tmp_path: Path, fake_drape: Callable[..., Any]) -> None:
    inside, go_on = threading.Event(), threading.Event()

    def at_start() -> None:
        inside.set()
        assert go_on.wait(300.0)

    fake_drape(at_start=at_start)
    first = threading.Thread(target=lambda: dress(scene(), tmp_path))
    first.start()
    assert inside.wait(300.0)
    with pytest.raises(InputError, match="another run of toile writes into this folder"):
        dress(scene(), tmp_path)
    with pytest.raises(InputError, match="another run of toile writes"):
        resume(tmp_path)
    go_on.set()
    first.join()
    assert set(os.listdir(tmp_path)) == FILES, "the lock is gone, and the first run came to its end"
    dress(scene(), tmp_path)


def test_a_killed_process_holds_no_lock(tmp_path: Path) -> None:
    code = (
        "import sys, time; from pathlib import Path; "
        "from toile.dressing.files.writers.file_lock import try_lock; "
        "assert try_lock(Path(sys.argv[1])) is not None; print('held', flush=True); time.sleep(60)"
    )
    held = subprocess.Popen([sys.executable, "-c", code, str(tmp_path / "lock")], stdout=subprocess.PIPE)
    assert held.stdout is not None and held.stdout.readline() == b"held\n"
    assert try_lock(tmp_path / "lock") is None
    held.send_signal(signal.SIGKILL)
    held.wait()
    descriptor = try_lock(tmp_path / "lock")
    assert descriptor is not None
    unlock(tmp_path / "lock", descriptor)
    assert not (tmp_path / "lock").exists()


def test_what_an_earlier_run_wrote_is_gone_before_the_first_frame(
    tmp_path: Path, fake_drape: Callable[..., Any]
) -> None:
    fake_drape()
    (tmp_path / "mine.ply").write_text("mine")
    (tmp_path / "frames").mkdir()
    for name in ("body.0000.ply", "coat.0009.ply", "notes.txt"):
        (tmp_path / "frames" / name).write_text("old")
    dress(Scene(avatar=PYRAMID, garments=[Garment(square(), name="coat")], formats=["vtu"]), tmp_path)
    assert (tmp_path / "coat.vtu").is_file() and os.listdir(tmp_path / "frames") == ["notes.txt"]
    seen: set[str] = set()

    def die() -> None:
        seen.update(os.listdir(tmp_path))
        raise KeyboardInterrupt

    fake_drape(at_start=die)
    with pytest.raises(KeyboardInterrupt):
        dress(scene(), tmp_path)
    assert seen == {"mine.ply", "frames", ".resume", ".toile.lock"}, "no report of the coat beside new frames"
    fake_drape()
    dress(scene(), tmp_path)
    assert set(os.listdir(tmp_path)) == {*FILES, "mine.ply", "frames"}


def test_a_report_can_name_no_files_of_others(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    for place in (tmp_path / "coat.ply", folder / "other.txt"):
        place.write_text("mine")
    (folder / "report.json").write_text(
        json.dumps({"garments": [{"name": "../coat"}, {"name": "other.txt"}]})
    )
    remove_earlier_run(folder)
    assert (tmp_path / "coat.ply").is_file() and os.listdir(folder) == ["other.txt"]
    (folder / "report.json").write_text("[" * 100_000)
    remove_earlier_run(folder)
    assert os.listdir(folder) == ["other.txt"]


def test_state_comes_back_as_it_was(tmp_path: Path) -> None:
    resolved = resolve(
        scene(friction_between={("cotton-poplin", "body"): 0.5}, ground=0.1, measurements={"waist": 0.8})
    )
    matrix = csr_array(np.array([[0.0, 0.5], [1.0, 0.0]]))
    arrays: dict[int, Any] = {
        3: np.arange(6, dtype=np.float32).reshape(2, 3),
        4: np.zeros((0, 3)),
        5: np.array([True, False]),
    }
    content = (
        resolved,
        matrix,
        arrays,
        float("inf"),
        np.float64(0.1),
        partial(Ground.under, 0.25),
        Path("a"),
    )
    path = tmp_path / "state.npz"
    path.write_bytes(state_bytes(content))
    back = read_state(path)
    assert isinstance(back, tuple) and isinstance(back[0], ResolvedScene)
    mapping: Any = back[2]
    for name in vars(resolved):
        if name not in ("avatar", "garments"):
            assert getattr(back[0], name) == getattr(resolved, name)
    (garment,) = back[0].garments
    assert garment.fabric == resolved.garments[0].fabric and garment.name == "square"
    source = garment.source
    assert isinstance(source, GarmentMesh)
    assert np.array_equal(source.rest_corners, square().rest_corners) and source.faces.dtype == np.int32
    assert np.array_equal(back[1].toarray(), matrix.toarray())
    assert mapping.keys() == arrays.keys()
    for key, array in arrays.items():
        assert mapping[key].dtype == array.dtype and np.array_equal(mapping[key], array)
    assert back[3:5] == (float("inf"), 0.1) and isinstance(back[4], np.float64) and back[6] == Path("a")
    assert (back[5].func, back[5].args) == (Ground.under, (0.25,))
    with pytest.raises(TypeError, match="no state of a run"):
        state_bytes(open)


@pytest.mark.parametrize(
    "tree",
    [
        {"os:system": {"command": "touch harm"}},
        {"builtins:print": {}},
        {"toile.dressing.run.dress:dress": {}},
        {"toile.dressing.cli.main:main": {"arguments": []}},
        {"array": "missing"},
        {"csr": []},
        [1, 2],
        {},
    ],
)
def test_a_state_file_can_name_no_code(tmp_path: Path, tree: object) -> None:
    (tmp_path / ".resume").mkdir()
    path = tmp_path / ".resume" / "scene.npz"
    with path.open("wb") as file:
        np.savez(file, tree=np.frombuffer(json.dumps(tree).encode(), np.uint8))
    with pytest.raises(InputError, match=r"scene\.npz: is damaged"):
        read_state(path)
    assert main(["dress", "--resume", str(tmp_path)]) == 2
    assert not Path("harm").exists()


@pytest.mark.parametrize(
    "command",
    [
        ["mannequin", "-o", "body.glb"],
        ["mannequin", "-o", "body.ply"],
        ["patterns", "--write", "patterns"],
        ["dress", "--garment", "square.obj", "--avatar", "body.obj", "-o", "out", "--quiet"],
    ],
)
def test_a_full_disk_is_said_in_a_line(
    command: list[str], tmp_path: Path, fake_drape: Callable[..., Any], monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    fake_drape()
    monkeypatch.chdir(tmp_path)
    (tmp_path / "square.obj").write_text("v -.2 1 .5\nv .2 1 .5\nv .2 1.4 .5\nv -.2 1.4 .5\nf 1 2 3 4\n")
    lines = [f"v {x} {y} {z}\n" for x, y, z in PYRAMID.vertices] + [
        f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in PYRAMID.faces
    ]
    (tmp_path / "body.obj").write_text("".join(lines))
    whole = Path.write_bytes

    def full(path: Path, data: bytes) -> int:
        if len(data) > 1000:
            raise OSError(28, "No space left on device")
        return whole(path, data)

    monkeypatch.setattr(Path, "write_bytes", full)
    assert main(command) == 3
    (line,) = capsys.readouterr().err.splitlines()
    assert "the disk is full (No space left on device); make room" in line and "bug" not in line
