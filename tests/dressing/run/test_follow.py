"""A shirt follows a mannequin that walks off: frames on disk, a break in between, the same bytes."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.dressing.json_schema import misfits
from toile.dressing.body.mannequin import mannequin
from toile.dressing.cli.main import main
from toile.dressing.files.writers.ply import read_own_ply
from toile.dressing.run.air import Air
from toile.dressing.run.dress import dress, resume
from toile.dressing.run.output import report_schema
from toile.dressing.run.progress import ProgressState
from toile.dressing.run.scene import AvatarFile, Garment, Scene
from toile.geometry.errors import InputError

FRAMES = 5


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    body = mannequin()
    time = np.arange(FRAMES) / 24.0
    ahead = np.column_stack((np.zeros(FRAMES), 0.02 * np.sin(20.0 * time), 0.5 * time**2))
    path = tmp_path_factory.mktemp("motion") / "walk.npz"
    np.savez(path, vertices=body.vertices[None] + ahead[:, None, :], faces=body.faces, fps=24.0)
    return Scene(
        garments=[Garment("tshirt")], avatar=AvatarFile(path=path), quality="preview", edge_length=0.03
    )


@pytest.fixture(scope="module")
def whole(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole")
    result = dress(scene, folder)
    assert result.status in ("converged", "frame_limit")
    return folder


def frames(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted((folder / "frames").iterdir())}


def test_every_frame_is_written_and_none_crosses(whole: Path) -> None:
    names = {f"{stem}.{number:04d}.ply" for stem in ("body", "tshirt") for number in range(FRAMES)}
    assert set(frames(whole)) == names
    report = json.loads((whole / "report.json").read_text())
    assert not list(misfits(report, report_schema()))
    animation = report["animation"]
    assert animation["frames"] == FRAMES - 1 and animation["fps"] == 24.0
    assert animation["intersections_max"] == 0 and animation["skin_held_back_mm_max"] < 1.0
    # Three steps of at most 1/60 s make a frame; where vibrating threads cut them short it takes a hundred.
    assert animation["steps"] <= 10 * (FRAMES - 1)
    assert (whole / "dressed.glb").is_file() and (whole / "preview.png").is_file()
    assert not (whole / ".resume").exists()


def test_stages_are_apart_and_add_up_to_the_time_of_the_run(whole: Path) -> None:
    report = json.loads((whole / "report.json").read_text())
    for clock in ("cpu", "wall"):
        stages, total = report[f"stage_{clock}_seconds"], report[f"{clock}_seconds"]
        assert sum(stages.values()) == pytest.approx(total, abs=1e-6)
        assert all(spent >= 0.0 for spent in stages.values()), stages
        assert stages["other"] < 0.25 * total, stages
        assert min(stages[name] for name in ("assembly", "solve", "contact", "avatar", "audit", "io")) > 0.0


def test_usd_has_a_sample_per_frame_of_body_and_garment(whole: Path) -> None:
    usd = pytest.importorskip("pxr.Usd", reason="USD is not installed: pip install 'toile[usd]'")
    geometry = pytest.importorskip("pxr.UsdGeom")
    stage = usd.Stage.Open(str(whole / "dressed.usdc"))
    assert stage.GetTimeCodesPerSecond() == 24.0 and stage.GetEndTimeCode() == FRAMES - 1
    for name in ("body", "tshirt"):
        mesh = geometry.Mesh(stage.GetPrimAtPath(f"/dressed/{name}"))
        for frame in range(FRAMES):
            stored = read_own_ply(whole / "frames" / f"{name}.{frame:04d}.ply")
            assert np.allclose(mesh.GetPointsAttr().Get(frame), stored.positions, atol=1e-6)
            assert np.array_equal(mesh.GetFaceVertexIndicesAttr().Get(frame), stored.faces.ravel())
    uv = geometry.PrimvarsAPI(stage.GetPrimAtPath("/dressed/tshirt")).GetPrimvar("st")
    assert len(uv.Get(2)) == 3 * len(stored.faces)


@pytest.mark.parametrize("last", [2, FRAMES - 1])
def test_a_broken_off_run_goes_on_to_the_same_bytes(
    scene: Scene, whole: Path, tmp_path: Path, last: int
) -> None:
    """Also one that was stopped after its last frame, before it wrote its end; with any number of threads."""
    started = False

    def stop(state: ProgressState) -> bool:
        nonlocal started
        started = started or (state.max_frames == FRAMES - 1 and state.frame == 0)
        return not (started and state.frame == last)

    broken = dress(replace(scene, threads=3), tmp_path, stop)
    assert broken.status == "cancelled" and len(frames(tmp_path)) == 2 * (last + 1)
    (tmp_path / "dressed.glb").unlink()
    said: list[str] = []
    result = resume(tmp_path, say=said.append, threads=2)
    assert result.status in ("converged", "frame_limit")
    assert any(f"resuming after frame {last}" in line for line in said)
    assert frames(tmp_path) == frames(whole)
    assert (tmp_path / "dressed.glb").read_bytes() == (whole / "dressed.glb").read_bytes()


def test_a_run_broken_off_while_it_hangs_starts_over(scene: Scene, whole: Path, tmp_path: Path) -> None:
    dress(scene, tmp_path, lambda state: state.frame < 1)
    assert not (tmp_path / "frames").exists()
    resume(tmp_path)
    assert frames(tmp_path) == frames(whole)


def test_wind_moves_what_follows(scene: Scene, whole: Path, tmp_path: Path) -> None:
    """A gale from the front presses the shirt's back hem away from the body."""
    result = dress(replace(scene, air=Air(velocity=(0.0, 0.0, -30.0), gusts=0.1)), tmp_path)
    assert result.report["animation"]["intersections_max"] == 0
    still = read_own_ply(whole / "frames" / f"tshirt.{FRAMES - 1:04d}.ply").positions
    blown = result.garments[0].positions
    low = [points[points[:, 1] < np.quantile(points[:, 1], 0.2)] for points in (still, blown)]
    assert low[1][:, 2].min() < low[0][:, 2].min() - 0.01
    first = [(folder / "frames" / "tshirt.0000.ply").read_bytes() for folder in (whole, tmp_path)]
    assert first[0] == first[1]


def test_bad_input_leaves_a_run_that_can_be_taken_up(tmp_path: Path) -> None:
    (tmp_path / ".resume").mkdir()
    (tmp_path / ".resume" / "scene.npz").write_bytes(b"of a run before")
    with pytest.raises(InputError, match="garment file not found"):
        dress(Scene(garments=[Garment("missing.obj")]), tmp_path)
    assert (tmp_path / ".resume" / "scene.npz").read_bytes() == b"of a run before"


def test_nothing_to_take_up_and_damage_are_named(whole: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no run to resume"):
        resume(whole)
    (tmp_path / ".resume").mkdir()
    (tmp_path / ".resume" / "scene.npz").write_bytes(b"broken")
    with pytest.raises(InputError, match="is damaged"):
        resume(tmp_path)


def test_the_command_wants_one_of_output_and_resume(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["dress", "--garment", "tshirt"]) == 2
    assert "--resume OUTDIR" in capsys.readouterr().err
    assert main(["dress", "--resume", "nowhere"]) == 2
    assert "there is no run to resume" in capsys.readouterr().err
