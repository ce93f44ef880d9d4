"""Avatars that move: .npz files and folders of meshes, and what is wrong with them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from toile.dressing.body.animated_avatar import load_animated_avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.dressing.run.scene import AvatarFile
from toile.dressing.run.scene_avatar import load_scene_avatar
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError


@pytest.fixture(scope="module")
def walk() -> tuple[Float, Int]:
    """The mannequin, two steps forward: vertices (3, v, 3) and faces."""
    body = mannequin()
    ahead = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.1], [0.0, 0.01, 0.2]])
    return body.vertices[None] + ahead[:, None, :], body.faces


def test_an_npz_gives_the_first_frame_and_the_motion(walk: tuple[Float, Int], tmp_path: Path) -> None:
    vertices, faces = walk
    np.savez(tmp_path / "walk.npz", vertices=vertices.astype(np.float32), faces=faces, fps=30.0)
    avatar = load_animated_avatar(tmp_path / "walk.npz")
    assert avatar.motion is not None and avatar.motion.fps == 30.0
    assert avatar.motion.frames.shape == vertices.shape
    assert np.abs(avatar.motion.frames - vertices).max() < 1e-6
    assert np.abs(avatar.vertices - vertices[0]).max() < 1e-6
    assert any("3 frames at 30 per second" in note for note in avatar.notes)


def test_units_and_up_axis_hold_for_all_frames(walk: tuple[Float, Int], tmp_path: Path) -> None:
    vertices, faces = walk
    turned = 100.0 * vertices[:, :, [0, 2, 1]] * np.array([1.0, -1.0, 1.0])
    np.savez(tmp_path / "blender.npz", positions=turned, faces=faces)
    avatar = load_animated_avatar(tmp_path / "blender.npz", fps=12.0)
    assert avatar.up_axis == "z" and avatar.metres_per_unit == 0.01
    assert avatar.motion is not None and avatar.motion.fps == 12.0
    assert np.abs(avatar.motion.frames - vertices).max() < 1e-5


def test_a_folder_is_read_in_the_order_of_its_numbers(walk: tuple[Float, Int], tmp_path: Path) -> None:
    vertices, faces = walk
    for number, frame in zip((2, 9, 10), vertices, strict=True):
        trimesh.Trimesh(frame, faces, process=False).export(tmp_path / f"body{number}.ply")
    avatar = load_scene_avatar(AvatarFile(path=tmp_path))
    assert avatar.motion is not None and avatar.motion.fps == 24.0
    assert np.abs(avatar.motion.frames - vertices).max() < 1e-5
    assert any("assumed" in note for note in avatar.notes)


def test_a_hole_is_closed_and_its_patch_moves_along(walk: tuple[Float, Int], tmp_path: Path) -> None:
    vertices, faces = walk
    top = vertices[0][:, 1] > vertices[0][:, 1].max() - 0.01
    open_faces = faces[~top[faces].any(axis=1)]
    used, renumbered = np.unique(open_faces, return_inverse=True)
    np.savez(tmp_path / "open.npz", vertices=vertices[:, used], faces=renumbered.reshape(-1, 3))
    avatar = load_animated_avatar(tmp_path / "open.npz")
    assert avatar.motion is not None
    moved = avatar.motion.frames[2] - avatar.motion.frames[0]
    assert np.abs(moved - np.array([0.0, 0.01, 0.2])).max() < 1e-5


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"vertices": None}, "needs arrays `vertices`"),
        ({"faces": None}, "needs arrays `vertices`"),
        ({"vertices": np.zeros((4, 2))}, r"must have the shape \(frames, vertices, 3\)"),
        ({"faces": np.zeros((2, 4), int)}, "faces must be whole numbers"),
        ({"faces": np.array([[0, 1, 10_000_000]])}, "face 0 refers to a vertex that does not exist"),
        ({"fps": 0.0}, "fps must be greater than zero"),
        ({"nan": True}, "frame 1 has NaN"),
    ],
)
def test_what_is_wrong_is_named(
    change: dict[str, Any], message: str, walk: tuple[Float, Int], tmp_path: Path
) -> None:
    content: dict[str, Any] = {"vertices": walk[0].copy(), "faces": walk[1], "fps": 30.0}
    if change.pop("nan", False):
        content["vertices"][1, 3] = np.nan
    content = {name: value for name, value in (content | change).items() if value is not None}
    np.savez(tmp_path / "bad.npz", **content)
    with pytest.raises(InputError, match=message) as error:
        load_animated_avatar(tmp_path / "bad.npz")
    assert "bad.npz" in str(error.value)


def test_a_file_that_is_no_npz_and_an_empty_folder_are_named(tmp_path: Path) -> None:
    (tmp_path / "text.npz").write_text("no")
    with pytest.raises(InputError, match=r"text\.npz: cannot be read"):
        load_animated_avatar(tmp_path / "text.npz")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="holds no mesh files"):
        load_animated_avatar(tmp_path / "empty")
    with pytest.raises(InputError, match="not found"):
        load_animated_avatar(tmp_path / "nowhere.npz")


def test_frames_of_other_faces_are_named(walk: tuple[Float, Int], tmp_path: Path) -> None:
    vertices, faces = walk
    trimesh.Trimesh(vertices[0], faces, process=False).export(tmp_path / "a1.ply")
    trimesh.Trimesh(vertices[1], faces[::-1], process=False).export(tmp_path / "a2.ply")
    with pytest.raises(InputError, match=r"a2\.ply: its faces differ from those of a1\.ply"):
        load_animated_avatar(tmp_path)


def test_fps_of_a_still_body_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="fps is for an avatar that moves"):
        load_scene_avatar(AvatarFile(path=tmp_path / "body.obj", fps=24.0))


def shells(frames: int = 5) -> tuple[Float, Int]:
    """A body of a trunk and two arms that overlap it; the arms rise: vertices (k, v, 3) and faces."""
    body, found = mannequin(), measure(mannequin())
    x = body.vertices[:, 0]
    places: list[Float] = []
    faces: list[Int] = []
    for sign, own in ((0.0, np.abs(x) < 0.25), (1.0, x > 0.2), (-1.0, x < -0.2)):
        used, local = np.unique(body.faces[own[body.faces].all(axis=1)], return_inverse=True)
        offset = body.vertices[used] - np.array(found.shoulder_point) * (sign or 1.0, 1.0, 1.0)
        turned = []
        for angle in 0.06 * sign * np.arange(frames):
            c, s = np.cos(angle), np.sin(angle)
            arm = 0.98 * offset @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
            arm += np.array(found.shoulder_point) * (sign, 1.0, 1.0)
            turned.append(arm if sign else body.vertices[used])
        faces.append(local.reshape(-1, 3).astype(np.int32) + np.int32(sum(part.shape[1] for part in places)))
        places.append(np.array(turned))
    return np.concatenate(places, axis=1), np.concatenate(faces)


def test_shells_that_overlap_at_first_grow_no_webs(tmp_path: Path) -> None:
    """United in the first frame, vertices where they meet would be drawn along by both."""
    vertices, faces = shells()
    np.savez(tmp_path / "shells.npz", vertices=vertices, faces=faces, fps=24.0)
    avatar = load_animated_avatar(tmp_path / "shells.npz")
    assert avatar.motion is not None and avatar.solid is not None
    assert any("3 closed parts move apart from each other" in note for note in avatar.notes)
    sides = avatar.faces[:, [0, 1]]
    frames = avatar.motion.frames
    lengths = [np.linalg.norm(frame[sides[:, 0]] - frame[sides[:, 1]], axis=1) for frame in frames]
    assert np.abs(lengths[-1] / lengths[0] - 1.0).max() < 1e-5
    # It is measured as one body.
    assert DressForm(avatar).measurements.chest == pytest.approx(measure(mannequin()).chest, abs=0.02)


def test_eyes_in_a_moving_head_are_left_out(walk: tuple[Float, Int], tmp_path: Path) -> None:
    vertices, faces = walk
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.012)
    eye = np.asarray(ball.vertices) + np.array([0.0, 1.6, 0.0]) + (vertices - vertices[0])[:, :1]
    everything = np.concatenate([vertices, eye], axis=1)
    both = np.concatenate([faces, np.asarray(ball.faces, np.int32) + np.int32(vertices.shape[1])])
    np.savez(tmp_path / "eye.npz", vertices=everything, faces=both)
    avatar = load_animated_avatar(tmp_path / "eye.npz")
    assert len(avatar.vertices) == vertices.shape[1]
    assert any("1 closed parts inside others (eyes, teeth) were left out" in note for note in avatar.notes)


@pytest.mark.parametrize("names", [("verts", "faces"), ("v", "f"), ("vertices", "triangles")])
def test_an_npz_of_one_frame_is_a_body_that_stands_still(names: tuple[str, str], tmp_path: Path) -> None:
    body = mannequin()
    for vertices in (body.vertices, body.vertices[None]):
        np.savez(tmp_path / "still.npz", **dict(zip(names, (vertices, body.faces), strict=True)))  # type: ignore[arg-type]
        avatar = load_scene_avatar(AvatarFile(path=tmp_path / "still.npz"))
        assert avatar.motion is None and np.abs(avatar.vertices - body.vertices).max() < 1e-12
        with pytest.raises(InputError, match=r"still\.npz: holds one frame, so it has no fps"):
            load_animated_avatar(tmp_path / "still.npz", fps=24.0)


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (("poses", "trans", "betas", "gender"), r"joint angles and shape numbers of SMPL \(AMASS\)"),
        (("v_template", "shapedirs", "f"), "is a body model"),
        (("v_posed", "pose", "transl"), "a posed frame of CAPE"),
        (("a", "b"), "has a, b"),
    ],
)
def test_arrays_of_other_programs_are_known(arrays: tuple[str, ...], message: str, tmp_path: Path) -> None:
    np.savez(tmp_path / "walk.npz", **{name: np.zeros((2, 2)) for name in arrays})  # type: ignore[arg-type]
    with pytest.raises(InputError, match=message):
        load_animated_avatar(tmp_path / "walk.npz")
