"""A clip that begins with hanging arms is dressed in the rest pose of its skeleton and led into."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.dressing.files.gltf_writer import Glb
from tests.dressing.files.skinned_mannequin import FPS, skinned_mannequin
from toile.dressing.batch.job import Job
from toile.dressing.batch.jobs_file import JobsFile
from toile.dressing.body.mannequin import mannequin
from toile.dressing.cli.main import main
from toile.dressing.files.writers.ply import ply_bytes, read_own_ply
from toile.dressing.run.dress import dress, resume
from toile.dressing.run.jumps import jump_of
from toile.dressing.run.lead_in import led_in
from toile.dressing.run.progress import ProgressState
from toile.dressing.run.result import Result
from toile.dressing.run.scene import AvatarFile, Garment, Scene
from toile.dressing.run.scene_avatar import load_dress_form
from toile.dressing.run.scene_file import load_scene
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.errors import InputError

FRAMES, LEAD = 4, 24
"""Frames of the clip, and of the lead-in that is made without asking."""

Whole = tuple[Path, Result, list[str], list[int]]
"""Output folder, result, sentences and recorded frames of a run."""


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    glb = skinned_mannequin(down=28.0, frames=FRAMES, at=(3.0, 0.0, 2.0))
    return glb.write(tmp_path_factory.mktemp("hanging") / "hanging.glb")


@pytest.fixture(scope="module")
def scene(path: Path) -> Scene:
    return Scene(
        garments=[Garment("tshirt")], avatar=AvatarFile(path=path), quality="preview", edge_length=0.045
    )


@pytest.fixture(scope="module")
def whole(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Whole:
    folder, said, recorded = tmp_path_factory.mktemp("whole"), list[str](), list[int]()
    result = dress(scene, folder, say=said.append, record=lambda frame, _: recorded.append(frame))
    return folder, result, said, recorded


def frames(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted((folder / "frames").iterdir())}


def test_a_clip_with_hanging_arms_is_dressed(whole: Whole) -> None:
    """Frames count as the clip's, none crosses, and one line says what was done."""
    folder, result, said, recorded = whole
    animation = result.report["animation"]
    assert result.failure is None and result.status in ("converged", "frame_limit")
    assert animation["frames"] == FRAMES - 1 and animation["intersections_max"] == 0
    assert animation["seconds"] == pytest.approx((FRAMES - 1) / FPS)
    assert animation["lead_in"]["frames"] == LEAD and animation["lead_in"]["seconds"] == 1.0
    assert animation["lead_in"]["steps"] >= 60 and animation["steps"] >= 3 * (FRAMES - 1)
    assert recorded == list(range(FRAMES))
    assert set(frames(folder)) == {f"{n}.{k:04d}.ply" for n in ("body", "tshirt") for k in range(FRAMES)}
    (line,) = [line for line in said if "rest pose" in line]
    assert "73 degrees below the horizontal" in line and "arms at 45 degrees" in line and "1 s lead" in line
    assert not any("seams of sleeves jam" in line for line in said)


def test_frame_0_is_the_first_of_the_clip(path: Path, whole: Whole) -> None:
    """The body is where the clip has it, and the shirt is on it, with sleeves around arms that hang."""
    clip, _ = load_dress_form(AvatarFile(path=path), {})
    assert clip.motion is not None
    for frame in range(FRAMES):
        body = read_own_ply(whole[0] / "frames" / f"body.{frame:04d}.ply").positions
        assert np.abs(body - clip.motion.frames[frame]).max() < 2e-3
    shirt = read_own_ply(whole[0] / "frames" / "tshirt.0000.ply").positions
    arms = np.abs(shirt[:, 0] - 3.0)
    # Sleeves on arms of the mannequin as built reach 0.43 m to the side.
    assert 0.2 < arms.max() < 0.38 and abs(shirt[:, 0].mean() - 3.0) < 0.02


def test_usd_begins_with_the_clip(whole: Whole) -> None:
    usd = pytest.importorskip("pxr.Usd", reason="USD is not installed: pip install 'toile[usd]'")
    stage = usd.Stage.Open(str(whole[0] / "dressed.usdc"))
    assert stage.GetStartTimeCode() == 0 and stage.GetEndTimeCode() == FRAMES - 1


def test_a_run_broken_off_in_its_lead_in_goes_on_to_the_same_bytes(
    scene: Scene, whole: Whole, tmp_path: Path
) -> None:
    stopped = LEAD - 4

    def stop(state: ProgressState) -> bool:
        return not (state.max_frames == LEAD + FRAMES - 1 and state.frame == stopped)

    broken = dress(scene, tmp_path, stop)
    assert broken.status == "cancelled" and not frames(tmp_path)
    assert broken.report["animation"]["frames"] == 0
    said: list[str] = []
    resume(tmp_path, say=said.append)
    assert f"resuming after frame {stopped} of the lead-in" in said
    assert frames(tmp_path) == frames(whole[0])
    assert (tmp_path / "dressed.glb").read_bytes() == (whole[0] / "dressed.glb").read_bytes()


def lead_of(file: AvatarFile, *, sewn: bool = True) -> int:
    """Frames that lead into a file's clip."""
    avatar, form = load_dress_form(file, {})
    led, _, why = led_in(file, avatar, form, sewn)
    assert led.motion is not None and (why is None) == (led is avatar)
    return led.motion.lead


def test_off_and_mesh_garments_keep_the_first_frame(path: Path) -> None:
    assert lead_of(AvatarFile(path=path, lead_in="off")) == 0
    assert lead_of(AvatarFile(path=path), sewn=False) == 0


def test_off_says_that_sleeves_may_jam(scene: Scene, path: Path) -> None:
    said: list[str] = []
    off = replace(scene, avatar=AvatarFile(path=path, lead_in="off"))
    result = dress(off, say=said.append, progress=lambda state: False)
    assert result.status == "cancelled" and not any("rest pose" in line for line in said)
    assert any("73 degrees below the horizontal in its first frame" in line for line in said)


def test_a_lead_in_is_as_long_as_asked(path: Path) -> None:
    assert lead_of(AvatarFile(path=path, lead_in=0.5), sewn=False) == 12
    assert lead_of(AvatarFile(path=path, lead_in=2, fps=30.0)) == 60


def test_arms_that_are_apart_need_none(tmp_path: Path) -> None:
    glb = skinned_mannequin(down=10.0, frames=3, at=(0.0, 0.0, 0.0))
    assert lead_of(AvatarFile(path=glb.write(tmp_path / "apart.glb"))) == 0


def test_the_pose_of_rest_with_arms_apart_is_taken(tmp_path: Path) -> None:
    """Nodes hang without animation too, as some exporters leave them; the skin was bound with arms apart."""
    glb = skinned_mannequin(down=28.0, frames=3, at=(0.0, 0.0, 0.0), own=28.0)
    file = AvatarFile(path=glb.write(tmp_path / "a.glb"))
    avatar, form = load_dress_form(file, {})
    _, rest, why = led_in(file, avatar, form, True)
    assert why is not None and np.degrees(rest.measurements.arm_angle) == pytest.approx(45.0, abs=1.0)


def test_a_pose_in_which_the_body_has_another_size_is_none(tmp_path: Path) -> None:
    """Only the clip takes the body to its size, as where its root is scaled from centimetres by keys."""
    glb = skinned_mannequin(down=28.0, frames=3, at=(0.0, 0.0, 0.0))
    glb.json["nodes"][2]["scale"] = [0.01, 0.01, 0.01]
    glb.animate(2, "scale", [0.0, 0.1], np.ones((2, 3)))
    file = AvatarFile(path=glb.write(tmp_path / "a.glb"))
    _, _, why = led_in(file, *load_dress_form(file, {}), True)
    assert why is not None and "with its arms opened" in why


def test_without_a_skeleton_the_arms_are_opened(tmp_path: Path) -> None:
    """The lead-in ends where the clip begins, and is as long as asked."""
    file = AvatarFile(path=hanging_rigid(tmp_path))
    avatar, form = load_dress_form(file, {})
    led, rest, why = led_in(file, avatar, form, True)
    assert why is not None and "with its arms opened" in why and led.motion is not None
    assert led.motion.lead == LEAD and avatar.motion is not None
    assert np.array_equal(led.motion.frames[LEAD:], avatar.motion.frames)
    assert np.degrees(rest.measurements.arm_angle) < 50.0
    step = np.linalg.norm(np.diff(led.motion.frames[: LEAD + 1], axis=0), axis=2).max()
    assert step < 0.06
    assert lead_of(AvatarFile(path=file.path, lead_in=0.5)) == 12
    assert lead_of(AvatarFile(path=file.path, lead_in="off")) == 0


def test_a_body_that_is_one_surface_with_its_arms_keeps_its_first_frame(tmp_path: Path) -> None:
    assert lead_of(AvatarFile(path=armless(tmp_path))) == 0


def armless(folder: Path) -> Path:
    """A body whose arms are gone, but for shoulders: it cannot be measured, and there is nothing to open."""
    body = mannequin()
    vertices = body.vertices.copy()
    vertices[:, 0] = np.clip(vertices[:, 0], -0.18, 0.18)
    np.savez(folder / "armless.npz", vertices=[vertices, vertices + 0.01], faces=body.faces, fps=FPS)
    return folder / "armless.npz"


def hanging_rigid(folder: Path) -> Path:
    """A body without skeleton whose arms hang: frames of the skinned one."""
    glb = skinned_mannequin(down=28.0, frames=3, at=(0.0, 0.0, 0.0))
    avatar, _ = load_dress_form(AvatarFile(path=glb.write(folder / "skinned.glb")), {})
    assert avatar.motion is not None
    np.savez(folder / "rigid.npz", vertices=avatar.motion.frames, faces=avatar.faces, fps=FPS)
    return folder / "rigid.npz"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda path: AvatarFile(path=armless(path.parent), lead_in=1.0), "lead_in needs a skeleton"),
        (lambda path: AvatarFile(path=path, lead_in="on"), "lead_in must be 'off' or lie between 0 and 60 s"),
        (lambda path: AvatarFile(path=path, lead_in=0.0), "lead_in must be 'off' or lie between"),
        (lambda path: AvatarFile(path=path, lead_in=float("nan")), "lead_in must be 'off' or lie between"),
        (
            lambda path: AvatarFile(path=path, lead_in=1.0, time=0.0),
            "with time the body stands; leave one out",
        ),
    ],
)
def test_what_cannot_be_led_is_named(make: Callable[[Path], AvatarFile], message: str, path: Path) -> None:
    file = make(path)
    with pytest.raises(InputError, match=message) as caught:
        led_in(file, *load_dress_form(file, {}), True)
    assert caught.value.field == "lead_in" and caught.value.file == file.path


def test_scene_files_and_options_say_it(
    path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for value, expected in (("0.5", 0.5), ('"off"', "off")):
        text = f'[avatar]\nfile = "a.glb"\nlead_in = {value}\n[[garment]]\nsource = "tshirt"\n'
        (tmp_path / "scene.toml").write_text(text)
        avatar = load_scene(tmp_path / "scene.toml").avatar
        assert isinstance(avatar, AvatarFile) and avatar.lead_in == expected
    arguments = ["dress", "--avatar", str(path), "--garment", "tshirt", "-o", str(tmp_path / "out")]
    assert main([*arguments, "--lead-in", "90"]) == 2
    assert "hanging.glb: lead_in must be 'off' or lie between 0 and 60 s, got 90" in capsys.readouterr().err
    assert main([*arguments, "--lead-in", "soon"]) == 2
    assert "'soon' is neither a number of seconds nor off" in capsys.readouterr().err


def test_columns_of_jobs_say_it(tmp_path: Path) -> None:
    jobs = tmp_path / "jobs.csv"
    jobs.write_text("name,avatar,garment,lead_in\na,a.glb,tshirt,0.5\nb,a.glb,tshirt,off\nc,a.glb,tshirt,\n")
    avatars = [job.scene.avatar for job in JobsFile(jobs, {}) if isinstance(job, Job)]
    assert [avatar.lead_in for avatar in avatars if isinstance(avatar, AvatarFile)] == [0.5, "off", None]


def test_a_body_that_stands_still_has_none(tmp_path: Path) -> None:
    body = mannequin()
    glb = Glb()
    glb.node(mesh=glb.mesh(body.vertices, body.faces))
    path = glb.write(tmp_path / "still.glb")
    with pytest.raises(InputError, match="lead_in is for an avatar that moves"):
        load_dress_form(AvatarFile(path=path, lead_in=1.0), {})
    assert load_dress_form(AvatarFile(path=path, lead_in="off"), {})[0].motion is None


def test_jumps_are_named_by_frames_of_the_clip() -> None:
    body = mannequin()
    places = np.zeros((5, 1, 3))
    places[3:, 0, 2] = 3.0
    for lead, name in ((2, "after frame 0: "), (4, "after frame 2 of the lead-in: ")):
        motion = VertexMotion(frames=body.vertices[None] + places, fps=24.0, lead=lead)
        jump = jump_of(replace(body, motion=motion))
        assert jump is not None and name in jump and "rest pose" not in jump


def test_arms_of_a_body_that_stands_are_opened_and_closed(tmp_path: Path) -> None:
    """Sleeves are sewn around open arms; shirt and body are then as the file has the body, in its room."""
    glb = skinned_mannequin(down=28.0, frames=2, at=(0.0, 0.0, 0.0))
    clip, _ = load_dress_form(AvatarFile(path=glb.write(tmp_path / "skinned.glb")), {})
    body = replace(clip, motion=None)
    path = tmp_path / "still.ply"
    path.write_bytes(ply_bytes(np.add(body.vertices, (2.0, 0.0, 1.0)), body.faces))
    said: list[str] = []
    scene = Scene(
        garments=[Garment("tshirt")], avatar=AvatarFile(path=path), quality="preview", edge_length=0.045,
        remesh=False,
    )  # fmt: skip
    result = dress(scene, say=said.append)
    assert result.failure is None and result.status == "converged", result.failure
    assert result.report["intersections"] == {"avatar": 0, "self": 0, "worst_frame": 0}
    (line,) = [line for line in said if "with its arms opened" in line]
    assert "73 degrees below the horizontal" in line and "close again in 1 s" in line
    away = np.linalg.norm(result.avatar.vertices - body.vertices - (2.0, 0.0, 1.0), axis=1)
    assert away.max() < 0.02 and np.median(away) < 1e-6
    (shirt,) = result.garments
    assert 0.2 < np.abs(shirt.positions[:, 0] - 2.0).max() < 0.38
