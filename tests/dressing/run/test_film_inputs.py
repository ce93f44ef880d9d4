"""Films of awkward motions: a rest pose first, a loop that jumps back, 120 frames a second, a used folder."""

import json
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from toile.dressing.body.mannequin import mannequin
from toile.dressing.files.writers.ply import read_own_ply
from toile.dressing.run.dress import dress
from toile.dressing.run.scene import AvatarFile, Garment, Scene
from toile.geometry.arrays import Float


def motion(folder: Path, places: Float, fps: float) -> Scene:
    """A shirt on a mannequin that is at these places [m], shape (k, 3), one after the other."""
    body = mannequin()
    path = folder / "motion.npz"
    vertices: npt.NDArray[np.float64] = body.vertices[None] + places[:, None, :]
    np.savez(path, vertices=vertices, faces=body.faces, fps=fps)
    return Scene(
        garments=[Garment("tshirt")], avatar=AvatarFile(path=path), quality="preview", edge_length=0.03
    )


def along(*x: float) -> Float:
    places = np.zeros((len(x), 3))
    places[:, 0] = x
    return places


def test_a_first_frame_far_from_the_others_is_told_before_anything_is_sewn(tmp_path: Path) -> None:
    said: list[str] = []
    scene = motion(tmp_path, along(0.0, 2.5, 2.51), 24.0)
    result = dress(scene, progress=lambda state: state.frame < 1 and state.max_frames > 2, say=said.append)
    assert result.status == "cancelled"
    told = [line for line in said if "jumps after frame 0" in line]
    assert len(told) == 1
    assert "moves 2.50 m in 0.0417 s" in told[0] and "leave out frame 0 if it is a rest pose" in told[0]


def test_a_film_leaves_nothing_of_a_longer_one(tmp_path: Path) -> None:
    """Frames of the run before are gone, whatever its garments were; other files stay."""
    frames = tmp_path / "out" / "frames"
    frames.mkdir(parents=True)
    for name in (
        "body.0002.ply",
        "body.0099.ply",
        "skirt.0000.ply",
        "tshirt.12345.ply",
        "mine.ply",
        "notes.txt",
    ):
        (frames / name).write_bytes(b"of the run before")
    (tmp_path / "out" / "dressed.usdc").write_bytes(b"of the run before")
    dress(motion(tmp_path, along(0.0, 0.005), 24.0), tmp_path / "out")
    own = {f"{name}.{frame:04d}.ply" for name in ("body", "tshirt") for frame in range(2)}
    assert {path.name for path in frames.iterdir()} == own | {"mine.ply", "notes.txt"}
    assert (tmp_path / "out" / "dressed.usdc").read_bytes() != b"of the run before"


def test_a_still_drape_leaves_nothing_of_a_film(tmp_path: Path) -> None:
    (tmp_path / "frames").mkdir()
    (tmp_path / "frames" / "tshirt.0000.ply").write_bytes(b"of the run before")
    (tmp_path / "dressed.usdc").write_bytes(b"of the run before")
    scene = Scene(garments=[Garment("tshirt")], quality="preview", edge_length=0.03)
    dress(scene, tmp_path, progress=lambda state: False)
    assert not (tmp_path / "frames").exists() and not (tmp_path / "dressed.usdc").exists()


@pytest.mark.slow
def test_the_same_motion_at_24_and_at_120_frames_per_second(tmp_path: Path) -> None:
    """The shirt hangs alike at the times that both have, and no frame crosses."""
    shirts = []
    for fps in (24.0, 120.0):
        folder = tmp_path / f"{fps:g}"
        folder.mkdir()
        time = np.arange(round(fps / 6.0) + 1) / fps
        result = dress(motion(folder, along(*(0.05 * (1.0 - np.cos(12.0 * time)))), fps), folder / "out")
        animation = result.report["animation"]
        assert animation["frames"] == round(fps / 6.0) and animation["fps"] == fps
        assert animation["intersections_max"] == 0 and animation["seconds"] == pytest.approx(1.0 / 6.0)
        shirts.append(
            read_own_ply(folder / "out" / "frames" / f"tshirt.{round(fps / 6.0):04d}.ply").positions
        )
    first = shirts[0].mean(axis=0)
    assert np.allclose(shirts[1].mean(axis=0), first, atol=2e-3)
    assert np.allclose(np.ptp(shirts[1], axis=0), np.ptp(shirts[0], axis=0), atol=0.02)


def test_cloth_that_no_fabric_bears_is_told_with_its_place(tmp_path: Path) -> None:
    """The body swells to three quarters more than its width: the shirt on it must stretch, at the trunk."""
    body = mannequin()
    swelling = np.linspace(1.0, 1.75, 3)[:, None, None] ** np.array([1.0, 0.0, 1.0])
    path = tmp_path / "motion.npz"
    np.savez(path, vertices=body.vertices[None] * swelling, faces=body.faces, fps=24.0)
    scene = Scene(
        garments=[Garment("tshirt")], avatar=AvatarFile(path=path), quality="preview", edge_length=0.045
    )
    said: list[str] = []
    result = dress(scene, say=said.append)
    animation = result.report["animation"]
    assert animation["strain_percent_max"] > 45.0 and animation["intersections_max"] == 0
    (told,) = [line for line in said if "more than fabric bears" in line]
    assert f"stretched by {animation['strain_percent_max']:.0f} %" in told
    assert f"in frame {animation['frames']}; garment tshirt: " in told and " near (" in told


@pytest.mark.slow
def test_a_loop_that_jumps_back(tmp_path: Path) -> None:
    """A step ahead of 0.3 m, back in one frame of 1/24 s: the shirt comes along, and nothing crosses."""
    scene = motion(tmp_path, along(0.0, 0.1, 0.2, 0.3, 0.0, 0.1), 24.0)
    result = dress(scene, tmp_path / "out")
    animation = json.loads((tmp_path / "out" / "report.json").read_text())["animation"]
    assert result.failure is None and animation["frames"] == 5
    assert animation["intersections_max"] == 0 and animation["strain_percent_max"] < 30.0
    shirt, body = (
        read_own_ply(tmp_path / "out" / "frames" / f"{name}.0005.ply") for name in ("tshirt", "body")
    )
    assert shirt.positions[:, 0].mean() == pytest.approx(body.positions[:, 0].mean(), abs=0.1)
