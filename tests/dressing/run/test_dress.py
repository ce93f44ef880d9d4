import os
import signal
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import toile
from toile.dressing.files.corner_surface import Surface
from toile.dressing.garment.mesh_garment import garment_from_surface

PYRAMID = toile.Avatar(
    name="tetrahedron",
    vertices=np.array([[-0.3, 0.0, -0.3], [0.3, 0.0, -0.3], [0.0, 0.0, 0.4], [0.0, 1.7, 0.0]]),
    faces=np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]], dtype=np.int32),
    notes=("Recognised.",),
)


def square(size: float = 0.5) -> toile.GarmentMesh:
    faces = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    return garment_from_surface(
        Surface(
            positions=size * np.array([[0.0, 1, 1], [1, 1, 1], [1, 2, 1], [0, 2, 1]]),
            faces=faces,
            uv=np.empty((0, 2)),
            uv_faces=np.full((2, 3), -1, dtype=np.int32),
            panel=np.zeros(2, dtype=np.int32),
            panel_names=("square",),
            file_face=np.arange(2, dtype=np.int32),
        ),
        name="square",
    )


def scene(**options: Any) -> toile.Scene:
    return toile.Scene(avatar=PYRAMID, garments=[toile.Garment(square())], **options)


def test_nothing_is_written_without_an_output_folder(
    tmp_path: Path, fake_drape: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    fake_drape()
    monkeypatch.chdir(tmp_path)
    said: list[str] = []
    result = toile.dress(scene(quality="preview"), say=said.append)
    assert os.listdir(tmp_path) == []
    assert (result.status, result.garments[0].name) == ("converged", "square")
    assert "tetrahedron: Recognised." in said
    written = result.save("later")
    assert {path.name for path in written} == set(os.listdir("later"))
    assert len(written) == 6


def test_same_scene_writes_the_same_bytes(tmp_path: Path, fake_drape: Callable[..., Any]) -> None:
    fake_drape()
    for run in ("a", "b"):
        toile.dress(scene(), output=tmp_path / run)
    for name in ("dressed.glb", "preview.png", "square.obj", "square.ply"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_progress_can_cancel(fake_drape: Callable[..., Any]) -> None:
    fake_drape()
    seen: list[toile.ProgressState] = []

    def progress(state: toile.ProgressState) -> bool:
        seen.append(state)
        return state.frame < 3

    result = toile.dress(scene(), progress=progress)
    assert result.status == "cancelled"
    assert [state.frame for state in seen] == [1, 2, 3]
    assert seen[-1].seconds_left is not None
    assert result.report["frames"] == 3


def test_ctrl_c_keeps_what_is_draped(fake_drape: Callable[..., Any], tmp_path: Path) -> None:
    """In the midst of the second frame: the result is that of a drape whose progress says stop."""
    fake_drape()

    def press(state: toile.ProgressState) -> None:
        if state.frame == 2:
            signal.raise_signal(signal.SIGINT)

    result = toile.dress(scene(), tmp_path, press)
    assert result.status == "cancelled" and result.report["frames"] == 2
    assert (tmp_path / "dressed.glb").is_file() and (tmp_path / "report.json").is_file()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler

    def press_twice(state: toile.ProgressState) -> None:
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        toile.dress(scene(), progress=press_twice)


def test_fabric_of_garment_scene_and_default(fake_drape: Callable[..., Any]) -> None:
    fake = fake_drape()
    own = toile.fabric("canvas")
    garments = [toile.Garment(square(), fabric=own), toile.Garment(square(0.4))]
    toile.dress(toile.Scene(avatar=PYRAMID, garments=garments, fabric="ponte-roma"))
    toile.dress(scene())
    names = [[fabric.name for _, fabric in call[1]] for call in fake.calls]
    assert names == [["canvas", "ponte-roma"], ["cotton-poplin"]]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"gravity": float("nan")}, "gravity"),
        ({"max_frames": 0}, "max_frames"),
        ({"quality": "Standard"}, "did you mean 'standard'"),
        ({"fabric": "silk"}, "did you mean 'silk-charmeuse'"),
    ],
)
def test_bad_scenes(options: dict[str, Any], message: str, fake_drape: Callable[..., Any]) -> None:
    fake = fake_drape()
    with pytest.raises(toile.InputError, match=message):
        toile.dress(scene(**options))
    assert not fake.calls
    with pytest.raises(toile.InputError, match="no garment"):
        toile.Scene(garments=[])
    with pytest.raises(toile.InputError, match="threads must lie between 1 and"):
        scene(threads=0)


def test_two_threads_at_once_get_what_one_gets() -> None:
    with ThreadPoolExecutor(2) as threads:
        one, other = threads.map(toile.dress, [scene(max_frames=4), scene(max_frames=4)])
    alone = toile.dress(scene(max_frames=4))
    assert one.report["residual"] == other.report["residual"] == alone.report["residual"]
    assert one.garments == other.garments == alone.garments
