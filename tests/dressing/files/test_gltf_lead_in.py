"""What leads from a pose of rest into a clip: poses computed by hand, and where the body stands."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.dressing.files.gltf_writer import CORNERS, Glb
from tests.dressing.files.skinned_mannequin import FPS, skinned_mannequin
from toile.dressing.files.gltf.animated_gltf import read_animated_gltf
from toile.dressing.files.gltf.gltf_clip import read_clip
from toile.dressing.files.gltf.gltf_file import GltfFile
from toile.dressing.files.gltf.gltf_lead_in import has_skeleton, joint_channels, read_lead_in
from toile.dressing.files.gltf.gltf_scene import GltfScene, matrices
from toile.dressing.files.gltf.rest_pose import bind_pose, own_pose, parts_of
from toile.dressing.files.leading.standing import eased, standing
from toile.geometry.arrays import Float

Y = 1


def quaternion(axis: str, degrees: float) -> Float:
    return np.asarray(Rotation.from_euler(axis, degrees, degrees=True).as_quat())


def test_shares_of_the_way_ease_in_and_out() -> None:
    assert eased(4) == pytest.approx([0.0, 5.0 / 32.0, 0.5, 27.0 / 32.0])


def test_joints_go_by_angles_and_the_rest_along_lines(tmp_path: Path) -> None:
    """A quarter of the way to a turn by 80 degrees is one by 20; places and scales go along lines."""
    glb = Glb()
    tip = glb.node(root=False, translation=[0.0, 1.0, 0.0], mesh=glb.mesh())
    base = glb.node(children=[tip], rotation=quaternion("y", 10.0).tolist())
    glb.animate(base, "rotation", [2.0, 3.0], [-quaternion("y", 90.0), quaternion("y", 0.0)])
    glb.animate(tip, "translation", [2.0, 3.0], [[4.0, 1.0, 0.0], [9.0, 9.0, 9.0]])
    glb.animate(tip, "scale", [2.0, 3.0], [[3.0, 1.0, 1.0], [1.0, 1.0, 1.0]])
    file = GltfFile(glb.write(tmp_path / "a.glb"))
    channels = joint_channels(file, read_clip(file, None), own_pose(file))
    world = GltfScene(file, np.array([0.0, 0.25, 1.0]), channels).world[tip]
    for k, (angle, x, scale) in enumerate([(10.0, 0.0, 1.0), (30.0, 1.0, 1.5), (90.0, 4.0, 3.0)]):
        turn = Rotation.from_euler("y", angle, degrees=True).as_matrix()
        assert np.abs(world[k, :3, :3] - turn @ np.diag([scale, 1.0, 1.0])).max() < 1e-6
        assert np.abs(world[k, :3, 3] - turn @ (x, 1.0, 0.0)).max() < 1e-6


def test_morph_weights_go_along_lines(tmp_path: Path) -> None:
    glb = Glb()
    mesh = glb.mesh(targets=[{"POSITION": glb.numbers(np.ones((4, 3)))}])
    node = glb.node(mesh=mesh, weights=[0.2])
    glb.animate(node, "weights", [0.0, 1.0], [0.6, 0.0])
    file = GltfFile(glb.write(tmp_path / "a.glb"))
    channels = joint_channels(file, read_clip(file, None), own_pose(file))
    assert channels[node, "weights"].at(np.array([0.0, 0.5, 1.0]))[:, 0] == pytest.approx([0.2, 0.4, 0.6])


def test_a_transform_comes_apart_and_together() -> None:
    for scale in ([1.0, 2.0, 3.0], [-1.0, 2.0, 0.5]):
        parts = {
            "translation": np.array([1.0, 2.0, 3.0]), "rotation": quaternion("x", 130.0),
            "scale": np.array(scale),
        }  # fmt: skip
        matrix = matrices(*(part[None] for part in parts.values()))[0]
        again = matrices(*(part[None] for part in parts_of(matrix).values()))[0]
        assert np.abs(again - matrix).max() < 1e-12


def test_the_pose_of_binding_comes_from_the_inverse_bind_matrices(tmp_path: Path) -> None:
    """Nodes that hang are put where they were bound; the topmost joint stays."""
    glb = skinned_mannequin(down=30.0, frames=3, at=(0.0, 0.0, 0.0), own=25.0)
    file = GltfFile(glb.write(tmp_path / "a.glb"))
    own, bound = own_pose(file), bind_pose(file)
    assert bound is not None
    assert own[0, "rotation"] == pytest.approx(quaternion("z", -25.0))
    assert bound[0, "rotation"] == pytest.approx([0.0, 0.0, 0.0, 1.0], abs=1e-6)
    assert bound[0, "translation"] == pytest.approx([0.18, 0.32, 0.0], abs=1e-6)
    assert bound[2, "translation"] == pytest.approx([0.0, 1.0, 0.0], abs=1e-6)


def test_skins_that_share_joints_are_bound_together(tmp_path: Path) -> None:
    """Hair on an arm that hangs by its node, in a skin of its own: it goes where the body has the arm."""
    glb = skinned_mannequin(down=30.0, frames=3, at=(0.0, 0.0, 0.0), own=25.0)
    strand = glb.node(root=False, translation=[0.1, 0.0, 0.0])
    glb.json["nodes"][0]["children"] = [strand]
    bind = np.tile(np.eye(4), (2, 1, 1))
    bind[:, :3, 3] = [[-0.18, -1.32, 0.0], [-0.28, -1.32, 0.0]]
    hair = {"joints": [0, strand], "inverseBindMatrices": glb.numbers(bind.swapaxes(1, 2))}
    glb.json["skins"].insert(0, hair)
    glb.json["nodes"][3]["skin"] = 1
    bound = bind_pose(GltfFile(glb.write(tmp_path / "a.glb")))
    assert bound is not None
    assert bound[0, "rotation"] == pytest.approx([0.0, 0.0, 0.0, 1.0], abs=1e-6)
    assert bound[strand, "translation"] == pytest.approx([0.1, 0.0, 0.0], abs=1e-6)


def test_without_a_skin_no_pose_of_binding_is_known(tmp_path: Path) -> None:
    glb = Glb()
    glb.animate(glb.node(mesh=glb.mesh()), "scale", [0.0, 1.0], [[1.0, 1.0, 1.0], [2.0, 2.0, 2.0]])
    path = glb.write(tmp_path / "a.glb")
    assert bind_pose(GltfFile(path)) is None and not has_skeleton(path)


def test_frames_are_put_where_the_last_stands_and_faces() -> None:
    last = CORNERS + np.array([5.0, 2.0, -3.0])
    turned = Rotation.from_euler("y", 130.0, degrees=True).apply(CORNERS) + np.array([-40.0, 0.3, 7.0])
    found = standing(np.stack([turned, last]), Y)
    assert np.abs(found[0] - last).max() < 1e-12 and np.array_equal(found[1], last)


@pytest.mark.parametrize("facing", [0.0, 140.0])
def test_the_body_stays_where_its_clip_begins(facing: float, tmp_path: Path) -> None:
    """Far from where its skeleton rests, on a hill, turned: feet and trunk rest there, only the arms move."""
    glb = skinned_mannequin(down=30.0, frames=3, at=(120.0, 14.0, -80.0), facing=facing)
    path = glb.write(tmp_path / "a.glb")
    clip = read_animated_gltf(path, FPS).frames
    for lead in read_lead_in(path, None, 12, Y):
        assert lead.shape == (12, *clip.shape[1:])
        ways = np.abs(np.diff(np.concatenate([lead, clip[:1]]), axis=0)).max(axis=(1, 2))
        # An arm of 0.7 m turns by 30 degrees in half a second, at most 1.5 times as fast as on average.
        assert ways.max() < 1.5 * 0.75 * np.radians(30.0) / 12 * 1.1
        assert ways[0] < 0.3 * ways.max() and ways[-1] < 0.3 * ways.max()
        feet = clip[0, :, Y] < 14.1
        assert np.abs(lead[:, feet] - clip[0, feet]).max() < 0.02
        assert lead[:, :, Y].min() == pytest.approx(14.0, abs=1e-4)


def test_each_pose_of_rest_leads_into_the_clip(tmp_path: Path) -> None:
    """The first frames are the mannequin with its arms as the nodes have them, and as it was bound."""
    glb = skinned_mannequin(down=30.0, frames=3, at=(0.0, 0.0, 0.0), own=25.0)
    own, bound = read_lead_in(glb.write(tmp_path / "a.glb"), None, 6, Y)
    assert np.ptp(bound[0, :, 0]) == pytest.approx(1.368, abs=2e-3)
    assert np.ptp(own[0, :, 0]) < 0.85 * np.ptp(bound[0, :, 0])
