"""The way from pose to pose: both ends, tubes that bend and twist as rigid bodies do, and bad input."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from toile.dressing.body.posing.posed_body import given_poses, load_posed_body, moved_poses
from toile.dressing.body.posing.way_to_pose import way_to_pose
from toile.dressing.body.reading import RECOGNISED
from toile.dressing.run.scene import AvatarFile
from toile.dressing.run.scene_avatar import load_scene_avatar
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

RINGS, AROUND, RADIUS = 60, 24, 0.08


def tube(bend: float = 0.0, twist: float = 0.0) -> tuple[Float, Int]:
    """Return a tube of length 1 whose middle bends [rad] in the plane and whose rings twist [rad]."""
    s = np.linspace(0.0, 1.0, RINGS)
    turn = np.clip((s - 0.3) / 0.4, 0.0, 1.0) * bend
    along = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    centre = np.zeros((RINGS, 2))
    centre[1:] = np.cumsum(0.5 * (along[1:] + along[:-1]), axis=0) / (RINGS - 1)
    angle = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False) + twist * s[:, None]
    off = RADIUS * np.cos(angle)
    x = centre[:, :1] - np.sin(turn)[:, None] * off
    y = centre[:, 1:] + np.cos(turn)[:, None] * off
    ring = np.arange(AROUND)
    quads = np.stack([ring, np.roll(ring, -1), ring + AROUND, np.roll(ring, -1) + AROUND], axis=1)
    quads = (quads + AROUND * np.arange(RINGS - 1)[:, None, None]).reshape(-1, 4)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [1, 3, 2]]])
    return np.stack([x, y, RADIUS * np.sin(angle)], axis=2).reshape(-1, 3), faces.astype(np.int32)


def centred(vertices: Float) -> Float:
    return np.asarray(vertices - vertices.mean(axis=0))


@pytest.mark.parametrize("degrees", [90.0, 150.0])
def test_a_bent_tube_bends_half_way_and_keeps_its_edges(degrees: float) -> None:
    start, faces = tube()
    end, _ = tube(bend=np.radians(degrees))
    way = way_to_pose(start, end, faces, np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(way[[0, 2]], [start, end], atol=1e-6)
    half, _ = tube(bend=np.radians(degrees) / 2.0)
    # The middle of the tube goes straight; straight lines between the ends would be decimetres off.
    np.testing.assert_allclose(centred(way[1]), centred(half), atol=5e-4)
    edges = np.linalg.norm(way[:, faces[:, 0]] - way[:, faces[:, 1]], axis=2)
    np.testing.assert_allclose(edges[1], 0.5 * (edges[0] + edges[2]), rtol=2e-3)


def test_a_tube_twisted_by_more_than_half_a_turn_twists_on() -> None:
    start, faces = tube()
    end, _ = tube(twist=1.5 * np.pi)
    way = way_to_pose(start, end, faces, np.array([0.5]))[0]
    half, _ = tube(twist=0.75 * np.pi)
    # Ends of the tube turn by three quarters of a turn, the other way round would be one quarter.
    assert np.linalg.norm(centred(way) - centred(half), axis=1).max() < 0.25 * RADIUS


def test_a_turned_body_turns() -> None:
    start, faces = tube(bend=0.4)
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    way = way_to_pose(start, start @ turn.T, faces, np.array([0.5]))[0]
    root = np.sqrt(0.5)
    half = np.array([[root, -root, 0.0], [root, root, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(centred(way), centred(start) @ half.T, atol=1e-6)


def body_file(path: Path, scale: float = 1.0) -> Path:
    """Write a closed body of 1.7 m, its upper half bent forwards by a share."""
    mesh = trimesh.creation.capsule(height=1.4, radius=0.15, count=[16, 16])
    vertices = np.array(mesh.vertices)[:, [1, 2, 0]]
    vertices[:, 1] -= vertices[:, 1].min()
    above = np.maximum(vertices[:, 1] - 0.9, 0.0)
    vertices[:, 2] += (1.0 - scale) * above
    trimesh.Trimesh(vertices, mesh.faces, process=False).export(path)
    return path


def test_a_body_moves_through_its_poses_and_stands(tmp_path: Path) -> None:
    start, end = body_file(tmp_path / "stand.ply"), body_file(tmp_path / "bow.ply", 0.4)
    source = AvatarFile(path=start, pose=[end, start], fps=12.0)
    avatar = load_scene_avatar(source)
    assert avatar.motion is not None
    frames = avatar.motion.frames
    assert avatar.motion.fps == 12.0
    assert len(frames) >= 2 * 12 + 6
    reach = np.ptp(frames[:, :, 2], axis=1)
    assert reach.max() > reach[0] + 0.3 and reach[-1] == pytest.approx(reach[0], abs=1e-6)
    steps = np.linalg.norm(np.diff(frames, axis=0), axis=2).max(axis=1)
    assert steps.max() < 0.06 * 1.7
    np.testing.assert_allclose(frames[-1], frames[-6], atol=1e-12)
    assert any("the body moves to 2 poses" in note for note in avatar.notes)


def test_bad_poses_are_one_line(tmp_path: Path) -> None:
    start = body_file(tmp_path / "stand.ply")
    other = tmp_path / "other.ply"
    trimesh.creation.icosphere(2).export(other)
    turned = tmp_path / "turned.ply"
    mesh = trimesh.load(start, process=False)
    trimesh.Trimesh(mesh.vertices, mesh.faces[::-1], process=False).export(turned)
    for pose, said in (
        (other, "162 vertices, and stand.ply"),
        (turned, "its faces are not those of stand.ply"),
        (tmp_path / "none.ply", "file not found"),
        (tmp_path / "pose.fbx", "pose.fbx"),
        ("clip.glb@soon", "after @ stands the time of a clip in seconds"),
    ):
        with pytest.raises(InputError, match=said):
            load_posed_body(start, [str(pose)], reading=RECOGNISED, fps=None)
    with pytest.raises(InputError, match="pose must be file names"):
        given_poses([3])
    motion = tmp_path / "walk.npz"
    np.savez(motion, vertices=np.stack([mesh.vertices] * 2), faces=mesh.faces)
    with pytest.raises(InputError, match="moves by itself, and pose is for a body that stands"):
        load_scene_avatar(AvatarFile(path=motion, pose=start))
    with pytest.raises(InputError, match="clip is for an avatar that moves"):
        load_scene_avatar(AvatarFile(path=start, pose=start, clip="walk"))


def test_files_of_poses_can_be_elsewhere() -> None:
    there = moved_poses(["sit.ply", "clip.glb@1.5"], lambda path: Path("bodies") / path)
    assert there == ("bodies/sit.ply", "bodies/clip.glb@1.5")
