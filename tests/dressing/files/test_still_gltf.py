"""glTF at rest and at a time: what a viewer shows of poses, morphs, instances, strips and packed numbers."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.dressing.files.gltf_writer import CORNERS, FACES, Glb
from toile.dressing.body.avatar import load_avatar
from toile.dressing.body.mannequin import mannequin
from toile.dressing.files.gltf.still_gltf import read_still_gltf
from toile.dressing.files.read_surface import read_surface
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.dressing.run.scene import AvatarFile
from toile.dressing.run.scene_avatar import load_scene_avatar
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError


def points_of(glb: Glb, tmp_path: Path, name: str = "a.glb") -> Float:
    """Vertices of what a body and a garment both read."""
    return read_surface(glb.write(tmp_path / name), "the body").surface.positions


def area(glb: Glb, tmp_path: Path) -> float:
    surface = read_surface(glb.write(tmp_path / "a.glb"), "the body").surface
    a, b, c = surface.positions[surface.faces].swapaxes(0, 1)
    return 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def bent(scale: float = 1.0) -> tuple[Glb, Float]:
    """A tetrahedron on two bones, the second turned, below an armature of a scale; where its vertices are.

    The mesh lies below the armature too, as Blender writes it: its own place counts for nothing.
    """
    turn = Rotation.from_euler("x", 40.0, degrees=True)
    glb = Glb()
    attributes = {
        "JOINTS_0": glb.numbers(np.tile([0, 1, 0, 0], (4, 1)), "<u1"),
        "WEIGHTS_0": glb.numbers([[1.0, 0, 0, 0], [1.0, 0, 0, 0], [0.5, 0.5, 0, 0], [0.0, 1.0, 0, 0]]),
    }
    mesh = glb.mesh(CORNERS * scale, attributes=attributes)
    tip = glb.node(root=False, translation=[0.0, 0.5, 0.0], rotation=turn.as_quat().tolist())
    base = glb.node(root=False, children=[tip])
    bind = np.tile(np.diag([1.0 / scale, 1.0 / scale, 1.0 / scale, 1.0]), (2, 1, 1))
    bind[1, 1, 3] = -0.5
    skin = glb.add("skins", joints=[base, tip], inverseBindMatrices=glb.numbers(bind.swapaxes(1, 2)))
    skinned = glb.node(root=False, mesh=mesh, skin=skin)
    glb.node(scale=[scale] * 3, children=[skinned, base])
    joint = np.array([0.0, 0.5, 0.0])
    share = np.array([0.0, 0.0, 0.5, 1.0])[:, None]
    return glb, scale * (CORNERS + share * (joint + turn.apply(CORNERS - joint) - CORNERS))


@pytest.mark.parametrize("scale", [1.0, 0.5, 0.01])
def test_bones_pose_the_body_and_an_armatures_scale_counts_once(scale: float, tmp_path: Path) -> None:
    glb, expected = bent(scale)
    assert np.abs(points_of(glb, tmp_path) - expected).max() < 1e-6 * scale


def test_morph_weights_at_rest_count_of_the_node_before_the_mesh(tmp_path: Path) -> None:
    moves = np.random.default_rng(3).normal(size=(2, 4, 3))
    for own, weights in ((None, [1.0, 0.25]), ([0.5, -0.5], [0.5, -0.5])):
        glb = Glb()
        mesh = glb.mesh(targets=[{"POSITION": glb.numbers(move)} for move in moves])
        glb.json["meshes"][mesh]["weights"] = [1.0, 0.25]
        glb.node(mesh=mesh)
        if own is not None:
            glb.json["nodes"][0]["weights"] = own
        expected = CORNERS + np.einsum("m,mvi->vi", weights, moves)
        assert np.abs(points_of(glb, tmp_path) - expected).max() < 1e-6


@pytest.mark.parametrize("has_base", [True, False])
def test_sparse_numbers_replace_those_below(has_base: bool, tmp_path: Path) -> None:
    glb = Glb()
    mesh = glb.mesh(CORNERS if has_base else np.zeros((4, 3)))
    accessor = glb.json["accessors"][0]
    rows = [1, 2, 3] if not has_base else [2]
    values = CORNERS[rows] + (0.0, 0.5, 0.0)
    indices, replaced = glb.numbers(rows, "<u1"), glb.numbers(values)
    accessor["sparse"] = {
        "count": len(rows),
        "indices": {"bufferView": indices, "componentType": 5121},
        "values": {"bufferView": replaced},
    }
    if not has_base:
        del accessor["bufferView"]
    glb.node(mesh=mesh)
    expected = CORNERS.copy()
    expected[rows] = values
    assert np.abs(points_of(glb, tmp_path) - expected).max() < 1e-6


@pytest.mark.parametrize(("dtype", "most"), [("<i2", 32767), ("<u2", 65535), ("<i1", 127), ("<u1", 255)])
@pytest.mark.parametrize("normalized", [True, False])
def test_quantised_positions_are_scaled_by_their_node(
    dtype: str, most: int, normalized: bool, tmp_path: Path
) -> None:
    glb = Glb()
    packed = np.round(CORNERS * most).astype(int)
    scale = 1.7 if normalized else 1.7 / most
    glb.node(mesh=glb.mesh(), scale=[scale] * 3, translation=[0.1, 0.2, 0.3])
    glb.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = glb.numbers(
        packed, dtype, normalized=normalized
    )
    glb.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    assert np.abs(points_of(glb, tmp_path) - 1.7 * CORNERS - (0.1, 0.2, 0.3)).max() < 1e-6


def test_strips_and_fans_are_triangles_of_one_side(tmp_path: Path) -> None:
    """A wall of 4 x 1 as a strip and a half disc as a fan; a doubled corner of a strip has no area."""
    wall = np.array([[x, y, 0.0] for x in range(5) for y in range(2)])
    angles = np.linspace(0.0, np.pi, 9)
    fan = np.vstack([[0.0, 0.0, 0.0], np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles])])
    for points, corners, mode, expected in (
        (wall, [0, 0, *range(10)], 5, 4.0),
        (fan, range(10), 6, 4.0 * np.sin(np.pi / 8)),
    ):
        glb = Glb()
        glb.node(mesh=glb.mesh(points, list(corners), mode=mode))
        assert area(glb, tmp_path) == pytest.approx(expected)
        surface = read_surface(tmp_path / "a.glb", "the body").surface
        a, b, c = surface.positions[surface.faces].swapaxes(0, 1)
        normals = np.cross(b - a, c - a)[:, 2]
        assert (normals > 0.0).all() or (normals < 0.0).all()


def test_instances_stand_where_their_attributes_say(tmp_path: Path) -> None:
    turn = Rotation.from_euler("yx", [[0.0, 30.0], [90.0, 0.0]], degrees=True)
    shift, scale = np.array([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]), np.array([[1.0, 1.0, 1.0], [1.0, 3.0, 1.0]])
    glb = Glb()
    attributes = {
        "TRANSLATION": glb.numbers(shift), "ROTATION": glb.numbers(turn.as_quat()),
        "SCALE": glb.numbers(scale),
    }  # fmt: skip
    glb.node(
        mesh=glb.mesh(), translation=[0.0, 0.0, 5.0],
        extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}},
    )  # fmt: skip
    glb.json["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
    expected = [turn[k].apply(CORNERS * scale[k]) + shift[k] + (0.0, 0.0, 5.0) for k in range(2)]
    found = points_of(glb, tmp_path)
    assert found.shape == (8, 3) and np.abs(found - np.concatenate(expected)).max() < 1e-6
    # Instances that are not as many in every attribute are named.
    glb.json["accessors"][attributes["SCALE"]]["count"] = 1
    with pytest.raises(InputError, match=r"a\.glb: nodes\[0\]: its instances are not as many"):
        points_of(glb, tmp_path)


def test_nodes_that_are_hidden_or_of_another_scene_are_left_out(tmp_path: Path) -> None:
    glb = Glb()
    mesh = glb.mesh()
    glb.node(mesh=mesh)
    child = glb.node(root=False, mesh=mesh)
    glb.node(children=[child], extensions={"KHR_node_visibility": {"visible": False}})
    glb.node(root=False, mesh=mesh)
    assert len(points_of(glb, tmp_path)) == 4


def materials() -> Glb:
    """A body of four materials, the primitives of one mesh with vertices in common, and a second object."""
    body = mannequin()
    parts = np.array_split(body.faces, 4)
    glb = Glb()
    positions = glb.numbers(body.vertices)
    for name in ("skin", "hair", "skin"):
        glb.add("materials", name=name)
    primitives = [
        {"attributes": {"POSITION": positions}, "indices": glb.numbers(part.ravel(), "<u4"), "material": k}
        for k, part in enumerate(parts[:3])
    ]
    primitives.append(
        {"attributes": {"POSITION": positions}, "indices": glb.numbers(parts[3].ravel(), "<u4")}
    )
    glb.node(mesh=glb.add("meshes", primitives=primitives), name="eve")
    glb.node(mesh=glb.mesh(CORNERS * 0.1 + (0.0, 2.1, 0.0)))
    return glb


def test_names_and_order_come_from_the_file_and_are_those_of_every_run(tmp_path: Path) -> None:
    path = materials().write(tmp_path / "eve.glb")
    surface = read_surface(path, "the garment").surface
    assert surface.panel_names == ("eve_skin", "eve_hair", "eve_skin_2", "eve", "object")
    assert np.all(np.diff(surface.panel) >= 0)
    code = (
        "import hashlib, sys; from toile.dressing.body.avatar import load_avatar; "
        "a = load_avatar(sys.argv[1]); "
        "print(hashlib.sha256(a.vertices.tobytes() + a.faces.tobytes()).hexdigest())"
    )
    runs = {
        subprocess.run(
            [sys.executable, "-c", code, str(path)], env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True, text=True, check=True,
        ).stdout
        for seed in ("1", "2")
    }  # fmt: skip
    assert len(runs) == 1


def test_a_clean_body_of_several_materials_is_one_closed_body(tmp_path: Path) -> None:
    avatar = load_avatar(materials().write(tmp_path / "eve.glb"), units="m")
    own = mannequin()
    lower = avatar.vertices[avatar.vertices[:, 1] < 2.0]
    assert len(lower) == len(own.vertices)
    assert np.abs(lower.max(axis=0) - own.vertices.max(axis=0)).max() < 1e-6


def test_texture_of_a_garment_runs_upwards(tmp_path: Path) -> None:
    """In glTF v runs down from the upper edge of the picture; warp follows v either way."""
    glb = Glb()
    corners = np.array([[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 2.0, 0.0]])
    uv = glb.numbers(np.column_stack([corners[:, 0], 2.0 - corners[:, 1]]))
    glb.node(mesh=glb.mesh(corners, [0, 1, 2, 0, 2, 3], attributes={"TEXCOORD_0": uv}))
    mesh = read_mesh_garment(glb.write(tmp_path / "cloth.glb"))
    assert np.abs(np.sort(mesh.uv, axis=0) - np.sort(corners[:, :2] - (0.0, 1.0), axis=0)).max() < 1e-6
    y = mesh.positions[mesh.faces][..., 1]
    assert np.abs(np.abs(mesh.rest_corners[..., 0]) - np.abs(y - y[:, :1])).max() < 1e-6


def compressed(extension: str) -> Callable[[Glb], None]:
    """Leave the numbers to a decoder, with the extension required or not."""

    def change(glb: Glb) -> None:
        glb.json["extensionsUsed"] = [extension]
        if "draco" in extension:
            for accessor in glb.json["accessors"]:
                del accessor["bufferView"]
            glb.json["meshes"][0]["primitives"][0]["extensions"] = {extension: {"bufferView": 0}}
        else:
            glb.json["buffers"] = [{"byteLength": 8}, {"byteLength": 10**6, "extensions": {extension: {}}}]
            for view in glb.json["bufferViews"]:
                view["extensions"] = {extension: {"buffer": 0}}
                view["buffer"] = 1

    return change


@pytest.mark.parametrize(
    ("extension", "name"),
    [
        ("KHR_draco_mesh_compression", "Draco"),
        ("EXT_meshopt_compression", "meshopt"),
        ("KHR_meshopt_compression", "meshopt"),
    ],
)
@pytest.mark.parametrize("is_required", [True, False])
def test_compression_is_named_with_the_remedy(
    extension: str, name: str, is_required: bool, tmp_path: Path
) -> None:
    glb = Glb()
    glb.node(mesh=glb.mesh())
    compressed(extension)(glb)
    if is_required:
        glb.json["extensionsRequired"] = [extension]
    path = glb.write(tmp_path / "packed.glb")
    for read in (load_avatar, read_mesh_garment):
        with pytest.raises(InputError, match=f"packed.glb: needs {extension}.* export it without {name}"):
            read(path)


def walking() -> Glb:
    """The mannequin with two animations: it moves along x, or up."""
    body = mannequin()
    glb = Glb()
    node = glb.node(mesh=glb.mesh(body.vertices, body.faces))
    glb.animate(node, "translation", [1.0, 2.0], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    sampler = {"input": glb.numbers([0.0, 1.0]), "output": glb.numbers([[0.0, 0.0, 0.0], [0.0, 0.5, 0.0]])}
    channel = {"sampler": 0, "target": {"node": node, "path": "translation"}}
    glb.add("animations", name="jump", channels=[channel], samplers=[sampler])
    return glb


def test_a_time_makes_a_body_stand_still_and_a_clip_picks_the_animation(tmp_path: Path) -> None:
    path = walking().write(tmp_path / "eve.glb")
    still = mannequin().vertices.min(axis=0)
    for time, clip, shift in (
        (1.5, None, (0.5, 0.0, 0.0)), (9.0, "walk", (1.0, 0.0, 0.0)), (0.5, "jump", (0.0, 0.25, 0.0)),
    ):  # fmt: skip
        avatar = load_scene_avatar(AvatarFile(path=path, time=time, clip=clip))
        assert avatar.motion is None
        assert np.abs(avatar.vertices.min(axis=0) - still - shift).max() < 1e-6
        assert any(f"was read at {time:g} s" in note for note in avatar.notes)
    moving = load_scene_avatar(AvatarFile(path=path, clip="jump"))
    assert moving.motion is not None and len(moving.motion.frames) == 25
    assert np.ptp(moving.motion.frames[:, 0, 1]) == pytest.approx(0.5)
    # A body at rest is what the nodes say, whatever animations there are.
    assert np.abs(load_avatar(path).vertices.min(axis=0) - still).max() < 1e-6


@pytest.mark.parametrize(
    ("given", "message", "field"),
    [
        ({"clip": "jmp"}, "did you mean 'jump'", "avatar.clip"),
        ({"time": np.nan}, "time must be finite", "avatar.time"),
    ],
)
def test_clips_and_times_that_are_not_there(
    given: dict[str, float | str], message: str, field: str, tmp_path: Path
) -> None:
    path = walking().write(tmp_path / "eve.glb")
    with pytest.raises(InputError, match=message) as caught:
        load_scene_avatar(AvatarFile(path=path, **given))  # type: ignore[arg-type]
    assert caught.value.field == field and caught.value.file == path


def test_time_and_clip_are_for_what_moves(tmp_path: Path) -> None:
    glb = Glb()
    glb.node(mesh=glb.mesh())
    path = glb.write(tmp_path / "still.glb")
    with pytest.raises(InputError, match=r"still\.glb: time is for an avatar that moves"):
        load_scene_avatar(AvatarFile(path=path, time=0.0))
    with pytest.raises(InputError, match=r"no clip 'walk': it holds no animation"):
        read_still_gltf(path, time=0.0, clip="walk")


def test_a_mirrored_piece_looks_outward(tmp_path: Path) -> None:
    glb = Glb()
    glb.node(mesh=glb.mesh(), scale=[1.0, -2.0, 1.0])
    surface = read_surface(glb.write(tmp_path / "a.glb"), "the body").surface
    a, b, c = surface.positions[surface.faces].swapaxes(0, 1)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0 == pytest.approx(2.0 / 6.0)
    assert len(surface.faces) == len(FACES)
