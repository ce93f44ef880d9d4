"""Animated glTF: what nodes, skins and morph targets do to vertices, and what is wrong with files."""

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation, Slerp

from tests.dressing.files.gltf_writer import CORNERS, FACES, Glb
from toile.dressing.body.animated_avatar import is_animated, load_animated_avatar
from toile.dressing.body.mannequin import mannequin
from toile.dressing.files.gltf.animated_gltf import read_animated_gltf
from toile.dressing.run.scene import AvatarFile
from toile.dressing.run.scene_avatar import load_scene_avatar
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

FPS = 10.0


def frames_of(glb: Glb, tmp_path: Path, name: str = "a.glb", fps: float = FPS) -> Float:
    """Vertices over time, in the order of the mesh's own vertices."""
    return read_animated_gltf(glb.write(tmp_path / name), fps).frames.astype(np.float64)


def moving(way: str | None = "LINEAR") -> Glb:
    """A tetrahedron that moves a metre along x within 0.4 s."""
    glb = Glb()
    node = glb.node(mesh=glb.mesh())
    glb.animate(node, "translation", [0.0, 0.4], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], way)
    return glb


@pytest.mark.parametrize("dtype", ["<f4", "<i2"])
def test_a_node_turns_as_slerp_says(dtype: str, tmp_path: Path) -> None:
    """Keys of either sign: the shorter way is taken, from the first key to the last."""
    keys, times = Rotation.random(4, random_state=1), np.array([0.5, 0.9, 1.2, 2.0])
    quaternions = keys.as_quat() * np.array([1.0, -1.0, 1.0, -1.0])[:, None]
    glb = Glb()
    node = glb.node(mesh=glb.mesh())
    stored = quaternions if dtype == "<f4" else np.round(quaternions * 32767.0)
    glb.animate(node, "rotation", times, stored, dtype=dtype)
    found = frames_of(glb, tmp_path)
    turns = Slerp(times, keys)(np.clip(0.5 + np.arange(16) / FPS, 0.5, 2.0))
    expected = np.array([turn.apply(CORNERS) for turn in turns])
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() < (1e-6 if dtype == "<f4" else 1e-4)


def test_children_move_with_their_parents(tmp_path: Path) -> None:
    """Two levels of nodes with turns, shifts and scales, one in a matrix; only the outer moves."""
    turn, inner = Rotation.from_euler("xyz", [20, 30, 40], degrees=True), Rotation.from_euler("y", 0.7)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = inner.as_matrix() @ np.diag([1.0, 2.0, 0.5]), (0.1, 0.2, 0.3)
    glb = Glb()
    leaf = glb.node(root=False, mesh=glb.mesh(), translation=[0.0, 1.0, 0.0], scale=[1.0, 1.0, 3.0])
    middle = glb.node(root=False, children=[leaf], matrix=matrix.T.ravel().tolist())
    root = glb.node(children=[middle], rotation=turn.as_quat().tolist(), translation=[5.0, 0.0, 0.0])
    glb.animate(root, "scale", [0.0, 1.0], [[1.0, 1.0, 1.0], [2.0, 1.0, 3.0]])
    found = frames_of(glb, tmp_path)
    assert len(found) == 11
    local = CORNERS * np.array([1.0, 1.0, 3.0]) + np.array([0.0, 1.0, 0.0])
    local = local @ matrix[:3, :3].T + matrix[:3, 3]
    for k, frame in enumerate(found):
        scale = np.array([1.0 + 0.1 * k, 1.0, 1.0 + 0.2 * k])
        assert np.abs(frame - (turn.apply(local * scale) + np.array([5.0, 0.0, 0.0]))).max() < 1e-6


def test_a_mirrored_node_keeps_its_faces_outward(tmp_path: Path) -> None:
    glb = Glb()
    node = glb.node(mesh=glb.mesh(), scale=[-1.0, 1.0, 1.0])
    glb.animate(node, "translation", [0.0, 0.2], [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    read = read_animated_gltf(glb.write(tmp_path / "a.glb"), FPS)
    a, b, c = read.frames[0][read.surface.faces].swapaxes(0, 1)
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() > 0.0


def test_step_holds_a_value_until_the_next_key(tmp_path: Path) -> None:
    """Keys lie on frames in single precision, on either side of the frame's true time."""
    times = np.arange(7) / 24.0
    glb = Glb()
    node = glb.node(mesh=glb.mesh())
    glb.animate(node, "translation", times, np.outer(np.arange(7), [1.0, 0.0, 0.0]), "STEP")
    assert frames_of(glb, tmp_path, fps=24.0)[:, 0, 0] == pytest.approx(np.arange(7))
    assert frames_of(glb, tmp_path, fps=48.0)[:, 0, 0] == pytest.approx(np.arange(13) // 2)


def test_cubic_splines_follow_their_tangents(tmp_path: Path) -> None:
    """A cubic with slopes at two keys is met exactly; slopes are per second."""
    polynomial = np.polynomial.Polynomial([0.3, -1.0, 2.0, 0.5])
    slope = polynomial.deriv()
    times = np.array([1.0, 1.8, 3.0])
    keys = np.zeros((len(times), 3, 3))
    keys[:, 0, 1], keys[:, 1, 1], keys[:, 2, 1] = slope(times), polynomial(times), slope(times)
    glb = Glb()
    node = glb.node(mesh=glb.mesh())
    glb.animate(node, "translation", times, keys.reshape(-1, 3), "CUBICSPLINE")
    found = frames_of(glb, tmp_path)
    assert found[:, 0, 1] == pytest.approx(polynomial(1.0 + np.arange(21) / FPS), abs=1e-5)


def test_cubic_rotations_stay_rotations(tmp_path: Path) -> None:
    quaternions = Rotation.from_euler("z", [[0.0], [90.0]], degrees=True).as_quat()
    keys = np.zeros((2, 3, 4))
    keys[:, 1] = quaternions
    glb = Glb()
    node = glb.node(mesh=glb.mesh())
    glb.animate(node, "rotation", [0.0, 1.0], keys.reshape(-1, 4), "CUBICSPLINE")
    found = frames_of(glb, tmp_path)
    assert np.linalg.norm(found[:, 1:], axis=2) == pytest.approx(1.0, abs=1e-6)
    # Without slopes the middle is the normalised mean: half way.
    half = np.sqrt(0.5)
    assert found[5, 1] == pytest.approx([half, half, 0.0], abs=1e-6)


def skinned(joints: npt.ArrayLike, weights: npt.ArrayLike, dtype: str = "<f4") -> tuple[Glb, Float]:
    """Two joints, the second a child that turns about z, bound half a metre up; its angles over time."""
    glb = Glb()
    attributes = {
        "JOINTS_0": glb.numbers(joints, "<u1"),
        "WEIGHTS_0": glb.numbers(weights, dtype, normalized=dtype != "<f4"),
    }
    mesh = glb.mesh(attributes=attributes)
    tip = glb.node(root=False, translation=[0.0, 0.5, 0.0])
    base = glb.node(children=[tip])
    bind = np.stack([np.eye(4), np.eye(4)])
    bind[1, 1, 3] = -0.5
    skin = glb.add("skins", joints=[base, tip], inverseBindMatrices=glb.numbers(bind.swapaxes(1, 2)))
    # The place of a skinned mesh's own node does not count.
    glb.node(mesh=mesh, skin=skin, translation=[7.0, 7.0, 7.0])
    turns = Rotation.from_euler("z", [[0.0], [1.2]])
    glb.animate(tip, "rotation", [0.0, 1.0], turns.as_quat())
    glb.animate(base, "translation", [0.0, 1.0], [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0]], None)
    return glb, np.linspace(0.0, 1.2, 11)


@pytest.mark.parametrize("dtype", ["<f4", "<u1"])
def test_skinned_vertices_blend_their_joints(dtype: str, tmp_path: Path) -> None:
    """Weights as fractions or bytes; they need not add up to one, and joints of no weight do not count."""
    share = np.array([[4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 3.0, 0.0], [0.0, 2.0, 0.0]])
    weights = np.hstack([share, np.zeros((4, 1))]) * (1.0 if dtype == "<f4" else 50.0)
    joints = np.array([[0, 1, 9, 0], [0, 1, 0, 0], [0, 1, 0, 9], [0, 1, 0, 0]])
    glb, angles = skinned(joints, weights, dtype)
    found = frames_of(glb, tmp_path)
    second, joint = share[:, 1] / share.sum(axis=1), np.array([0.0, 0.5, 0.0])
    for k, angle in enumerate(angles):
        turned = joint + Rotation.from_euler("z", angle).apply(CORNERS - joint)
        expected = CORNERS + second[:, None] * (turned - CORNERS) + np.array([0.0, 0.0, 0.2 * k])
        assert np.abs(found[k] - expected).max() < 1e-6


def morphed(way: str = "LINEAR", weights: npt.ArrayLike = (0.0, 1.0, 1.0, 0.5)) -> tuple[Glb, Float]:
    """Two morph targets, the second sparse, their weights at 0 and 0.4 s; and their displacements."""
    generator = np.random.default_rng(2)
    moves = generator.normal(size=(2, 4, 3))
    moves[1, [0, 2]] = 0.0
    glb = Glb()
    indices, values = glb.numbers([1, 3], "<u2"), glb.numbers(moves[1, [1, 3]])
    sparse = {
        "count": 2,
        "indices": {"bufferView": indices, "componentType": 5123},
        "values": {"bufferView": values},
    }
    second = glb.add("accessors", componentType=5126, count=4, type="VEC3", sparse=sparse)
    targets = [{"POSITION": glb.numbers(moves[0])}, {"POSITION": second}]
    node = glb.node(mesh=glb.mesh(targets=targets))
    glb.animate(node, "weights", [0.0, 0.4], weights, way)
    return glb, moves


def test_morph_targets_add_up(tmp_path: Path) -> None:
    glb, moves = morphed()
    found = frames_of(glb, tmp_path)
    for k, frame in enumerate(found):
        expected = CORNERS + 0.25 * k * moves[0] + (1.0 - 0.125 * k) * moves[1]
        assert np.abs(frame - expected).max() < 1e-6


def test_cubic_morph_weights_come_in_threes(tmp_path: Path) -> None:
    keys = np.zeros((2, 3, 2))
    keys[1, 1] = 1.0
    glb, moves = morphed("CUBICSPLINE", keys.ravel())
    found = frames_of(glb, tmp_path)
    for k, frame in enumerate(found):
        s = 0.25 * k
        expected = CORNERS + s * s * (3.0 - 2.0 * s) * (moves[0] + moves[1])
        assert np.abs(frame - expected).max() < 1e-6


def test_weights_at_rest_hold_where_no_key_moves_them(tmp_path: Path) -> None:
    glb, moves = morphed()
    glb.json["meshes"][0]["weights"] = [0.25, 0.0]
    del glb.json["animations"]
    glb.animate(0, "translation", [0.0, 0.4], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    found = frames_of(glb, tmp_path)
    assert np.abs(found[0] - CORNERS - 0.25 * moves[0]).max() < 1e-6


@pytest.mark.parametrize("name", ["b.gltf", "c.gltf"])
def test_buffers_lie_in_the_json_or_beside_it(name: str, tmp_path: Path) -> None:
    """All meshes of the scene in order, rows with a stride; nodes outside the scene are left out."""
    glb = moving()
    rows = np.zeros((4, 5))
    rows[:, :3] = CORNERS + 10.0
    strided = glb.numbers(rows[:, :3])
    view = glb.add("bufferViews", buffer=0, byteOffset=len(glb.data), byteLength=rows.size * 4, byteStride=20)
    glb.data += rows.astype("<f4").tobytes()
    glb.json["accessors"][strided]["bufferView"] = view
    indices = glb.numbers(FACES.ravel(), "<u4")
    mesh = glb.add("meshes", primitives=[{"attributes": {"POSITION": strided}, "indices": indices}])
    glb.node(mesh=mesh)
    glb.node(root=False, mesh=mesh)
    if name == "c.gltf":
        glb.json["uri"] = "vertices%20of%20c.bin"
        (tmp_path / "vertices of c.bin").write_bytes(glb.data)
    read = read_animated_gltf(glb.write(tmp_path / name), FPS)
    assert read.frames.shape == (5, 8, 3) and len(read.surface.faces) == 8
    assert np.abs(read.frames[-1, :4] - CORNERS - [1.0, 0.0, 0.0]).max() < 1e-6
    assert np.abs(read.frames[:, 4:] - CORNERS - 10.0).max() < 1e-6
    assert read.surface.faces.max() == 7 and read.note == 'The first animation ("walk") of 0.4 s was read.'


def test_an_animated_body_is_read_as_an_avatar(tmp_path: Path) -> None:
    """The mannequin walks on in centimetres, beside a point cloud and vertices without faces."""
    body = mannequin()
    glb = Glb()
    points = np.vstack([body.vertices, [[9.0, 9.0, 9.0]]])
    mesh = glb.mesh(points, body.faces)
    glb.json["meshes"][mesh]["primitives"].append({"attributes": {"POSITION": 0}, "mode": 0})
    node = glb.node(mesh=mesh)
    glb.animate(node, "translation", [0.0, 0.5], [[0.0, 0.0, 0.0], [0.0, 0.01, 0.2]])
    glb.add("animations", name="jump", channels=[], samplers=[])
    path = glb.write(tmp_path / "walk.glb")
    avatar = load_scene_avatar(AvatarFile(path=path))
    assert avatar.name == "walk" and avatar.up_axis == "y" and avatar.metres_per_unit == 1.0
    assert avatar.motion is not None and avatar.motion.fps == 24.0
    assert len(avatar.motion.frames) == 13
    moved = avatar.motion.frames - avatar.vertices
    assert np.abs(moved[-1] - np.array([0.0, 0.01, 0.2])).max() < 1e-6
    assert np.abs(moved[6] - np.array([0.0, 0.005, 0.1])).max() < 1e-6
    assert any('animation ("walk") of 0.5 s was read, 1 more not: what' in note for note in avatar.notes)
    assert any("13 frames at 24 per second (assumed" in note for note in avatar.notes)
    finer = load_animated_avatar(path, fps=60.0)
    assert finer.motion is not None and finer.motion.frames.shape[0] == 31
    assert finer.motion.seconds == pytest.approx(0.5)


def test_a_body_without_animation_and_a_broken_file_stand_still(tmp_path: Path) -> None:
    """They go the way of all still bodies, which says what is wrong."""
    glb = Glb()
    body = mannequin()
    glb.node(mesh=glb.mesh(body.vertices, body.faces))
    still = glb.write(tmp_path / "still.glb")
    assert not is_animated(still) and not is_animated(glb.write(tmp_path / "still.gltf"))
    assert load_scene_avatar(AvatarFile(path=still)).motion is None
    whole = moving().write(tmp_path / "whole.glb")
    assert is_animated(whole) and is_animated(moving().write(tmp_path / "whole.gltf"))
    content = whole.read_bytes()
    for name, data in {
        "empty.glb": b"", "head.glb": content[:14], "half.glb": content[:200], "no.gltf": b'{"animations": [',
        "list.gltf": b'["animations"]', "deep.gltf": b'"animations"' + b"[" * 100_000,
        "long.glb": content[:12] + b"\xff\xff\xff\xff" + content[16:],
    }.items():  # fmt: skip
        (tmp_path / name).write_bytes(data)
        assert not is_animated(tmp_path / name)
    assert not is_animated(tmp_path / "gone.glb")


def edit(place: str, value: Any) -> Callable[[Glb], None]:
    """Change one entry of the JSON, such as accessors.0.count; None removes it."""

    def change(glb: Glb) -> None:
        *way, last = [int(part) if part.isdigit() else part for part in place.split(".")]
        entry: Any = glb.json
        for part in way:
            entry = entry[part]
        if value is None:
            del entry[last]
        else:
            entry[last] = value

    return change


def with_nan(glb: Glb) -> None:
    glb.data[:4] = struct.pack("<f", np.nan)


def resting(glb: Glb) -> None:
    glb.data[-24:] = bytes(24)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (edit("accessors.0.count", 5), r"accessors\[0\] reads 5 rows of 12 bytes, 12 apart, from byte 0"),
        (edit("accessors.0.count", -1), r"accessors\[0\]\.count must be a whole number, is -1"),
        (edit("accessors.0.bufferView", 99), r"bufferViews\[99\], which does not exist"),
        (edit("accessors.0.componentType", 7), r"accessors\[0\]\.componentType 7 is unknown"),
        (edit("accessors.0.type", "VEC4"), r"accessors\[0\] must be VEC3, is VEC4"),
        (edit("bufferViews.0.byteLength", 10**6), r"bufferViews\[0\] reads bytes 0 to 1000000 of a buffer"),
        (edit("buffers", [{"byteLength": 10**6}]), r"buffers\[0\] is cut off"),
        (
            edit("buffers", [{"byteLength": 9, "uri": "gone.bin"}]),
            r"gone\.bin: No such file.*; put it beside",
        ),
        (edit("buffers", [{"byteLength": 9, "uri": "data:;base64,A"}]), r"data: URI cannot be read"),
        (edit("extensionsRequired", ["KHR_draco_mesh_compression"]), "export it without Draco compression"),
        (edit("extensionsRequired", ["EXT_meshopt_compression"]), "export it without meshopt compression"),
        (edit("asset.version", "1.0"), "is glTF 1.0; export it as glTF 2.0"),
        (edit("meshes.0.primitives.0.mode", 1), "holds no triangles"),
        (edit("meshes.0.primitives.0.indices", 0), r"accessors\[0\] must be SCALAR"),
        (edit("meshes.0.primitives", None), "is not valid glTF .*primitives"),
        (edit("nodes.0.matrix", np.eye(4).ravel().tolist()), r"nodes\[0\] is animated but has a matrix"),
        (edit("nodes.0.children", [0]), "its nodes are each other's children"),
        (edit("nodes.0.rotation", [0, 0, 0, 0]), r"nodes\[0\]\.rotation is of length zero"),
        (edit("animations.0.channels.0.target.node", 5), r"nodes\[5\], which does not exist"),
        (edit("animations.0.channels", []), "moves neither nodes nor morph targets; export it without"),
        (edit("animations.0.samplers.0.interpolation", "SMOOTH"), "unknown interpolation 'SMOOTH'"),
        (edit("animations.0.samplers.0.interpolation", "CUBICSPLINE"), "2 keys, but 2 values"),
        (edit("accessors.3.count", 1), "1 keys, but 2 values|2 keys, but 1 values"),
        (with_nan, r"accessors\[0\] holds NaN"),
        (resting, r'the first animation \("walk"\) moves no vertex; export it without animation'),
    ],
)
def test_what_is_wrong_is_named(change: Callable[[Glb], None], message: str, tmp_path: Path) -> None:
    glb = moving()
    change(glb)
    with pytest.raises(InputError, match=message) as error:
        load_animated_avatar(glb.write(tmp_path / "bad.glb"))
    assert "bad.glb" in str(error.value) and "\n" not in str(error.value)


def test_one_key_and_too_short_a_motion_are_named(tmp_path: Path) -> None:
    glb = Glb()
    node = glb.node(mesh=glb.mesh())
    glb.animate(node, "translation", [0.3], [[1.0, 0.0, 0.0]])
    with pytest.raises(InputError, match=r"has only one key and thus no motion; export it without anim"):
        load_animated_avatar(glb.write(tmp_path / "pose.glb"))
    with pytest.raises(InputError, match=r"lasts 0\.4 s, less than a frame at 2 per second; give more"):
        load_animated_avatar(moving().write(tmp_path / "short.glb"), fps=2.0)
    glb = moving()
    glb.animate(0, "scale", [2.0, 1.0], [[1.0, 1.0, 1.0]] * 2)
    with pytest.raises(InputError, match=r"channels\[1\]: the times of its keys do not rise"):
        load_animated_avatar(glb.write(tmp_path / "back.glb"))
    with pytest.raises(InputError, match="fps must be greater than zero, got -1"):
        load_animated_avatar(moving().write(tmp_path / "fps.glb"), fps=-1.0)


@pytest.mark.parametrize(
    ("joints", "weights", "message"),
    [
        (np.full((4, 4), 2.0), np.ones((4, 4)), r"JOINTS reach 2, but skins\[0\] has 2 joints"),
        (np.zeros((4, 4)), np.zeros((4, 4)), "vertex 0 has no joint"),
        (np.zeros((3, 4)), np.ones((3, 4)), "not as many as its vertices"),
    ],
)
def test_broken_skins_are_named(joints: Float, weights: Float, message: str, tmp_path: Path) -> None:
    glb, _ = skinned(joints, weights)
    with pytest.raises(InputError, match=message):
        load_animated_avatar(glb.write(tmp_path / "skin.glb"))


def test_broken_morph_targets_are_named(tmp_path: Path) -> None:
    glb, _ = morphed(weights=[0.0, 1.0])
    with pytest.raises(InputError, match="has 2 morph targets, but 1 weights"):
        load_animated_avatar(glb.write(tmp_path / "morph.glb"))
    glb, _ = morphed()
    glb.json["accessors"][2]["sparse"]["indices"]["componentType"] = 5121
    glb.json["accessors"][2]["count"] = 1
    with pytest.raises(InputError, match=r"accessors\[2\]\.sparse\.indices reach 1, but count is 1|as many"):
        load_animated_avatar(glb.write(tmp_path / "sparse.glb"))
