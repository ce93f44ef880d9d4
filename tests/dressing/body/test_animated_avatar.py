"""Avatars that move: .npz files and folders of meshes, and what is wrong with them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from toile.dressing.body.animated_avatar import load_animated_avatar
from toile.dressing.body.mannequin import mannequin
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
