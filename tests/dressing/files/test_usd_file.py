"""Bodies and motions in USD files: units, axes, transforms, skeletons, hidden and changing meshes."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from toile.dressing.body.mannequin import mannequin
from toile.dressing.files.usd_file import read_usd
from toile.dressing.run.scene import AvatarFile
from toile.dressing.run.scene_avatar import load_scene_avatar
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

pxr = pytest.importorskip("pxr")
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt  # noqa: E402

BODY = mannequin()


def add_mesh(stage: Any, place: str, points: Float, faces: Any) -> Any:
    """Define a mesh of triangles."""
    mesh = UsdGeom.Mesh.Define(stage, place)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(points, np.float32)))
    mesh.CreateFaceVertexCountsAttr([3] * len(faces))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.ascontiguousarray(faces, np.int32).ravel()))
    return mesh


@pytest.mark.parametrize("extension", ["usda", "usdc"])
def test_a_still_body_in_centimetres_z_up(extension: str, tmp_path: Path) -> None:
    path = tmp_path / f"body.{extension}"
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    x, y, z = 100.0 * BODY.vertices.T
    group = UsdGeom.Xform.Define(stage, "/group")
    group.AddTranslateOp().Set(Gf.Vec3d(300.0, 0.0, 0.0))
    mesh = add_mesh(stage, "/group/skin", np.column_stack([x, -z, y]), BODY.faces[:, ::-1])
    mesh.CreateOrientationAttr(UsdGeom.Tokens.leftHanded)
    hidden = add_mesh(stage, "/proxy", BODY.vertices + 9.0, BODY.faces)
    hidden.CreatePurposeAttr(UsdGeom.Tokens.proxy)
    stage.GetRootLayer().Save()
    avatar = load_scene_avatar(AvatarFile(path=path))
    assert avatar.motion is None and avatar.metres_per_unit == 0.01 and avatar.up_axis == "z"
    assert np.abs(avatar.vertices - BODY.vertices - (3.0, 0.0, 0.0)).max() < 1e-5
    assert np.array_equal(avatar.faces, BODY.faces)
    assert not any("turned outward" in note for note in avatar.notes)


def test_points_and_transforms_that_move_are_a_motion(tmp_path: Path) -> None:
    path = tmp_path / "walk.usda"
    stage = Usd.Stage.CreateNew(str(path))
    stage.SetTimeCodesPerSecond(30.0)
    stage.SetStartTimeCode(10)
    stage.SetEndTimeCode(13)
    mesh = add_mesh(stage, "/skin", BODY.vertices, BODY.faces)
    step = mesh.AddTranslateOp()
    for code in (10, 13):
        step.Set(Gf.Vec3d(0.0, 0.0, 0.1 * (code - 10)), code)
    stage.GetRootLayer().Save()
    avatar = load_scene_avatar(AvatarFile(path=path))
    assert avatar.motion is not None and avatar.motion.fps == 30.0 and len(avatar.motion.frames) == 4
    moved = avatar.motion.frames - BODY.vertices
    assert np.abs(moved - np.array([0.0, 0.0, 0.1]) * np.arange(4)[:, None, None]).max() < 1e-5


def test_a_skeleton_carries_its_skin(tmp_path: Path) -> None:
    """One joint goes up by 0.5 over two frames; the file stays as it is."""
    path = tmp_path / "skin.usda"
    stage = Usd.Stage.CreateNew(str(path))
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(2)
    UsdSkel.Root.Define(stage, "/root")
    skeleton = UsdSkel.Skeleton.Define(stage, "/root/skeleton")
    skeleton.CreateJointsAttr(["hip"])
    skeleton.CreateBindTransformsAttr([Gf.Matrix4d(1.0)])
    skeleton.CreateRestTransformsAttr([Gf.Matrix4d(1.0)])
    animation = UsdSkel.Animation.Define(stage, "/root/walk")
    animation.CreateJointsAttr(["hip"])
    animation.CreateRotationsAttr([Gf.Quatf(1.0)])
    animation.CreateScalesAttr([Gf.Vec3h(1.0)])
    animation.CreateTranslationsAttr()
    for code in (0, 2):
        animation.GetTranslationsAttr().Set([Gf.Vec3f(0.0, 0.25 * code, 0.0)], code)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets(
        [Sdf.Path("/root/walk")]
    )
    mesh = add_mesh(stage, "/root/skin", BODY.vertices, BODY.faces)
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([Sdf.Path("/root/skeleton")])
    binding.CreateJointIndicesPrimvar(False, 1).Set([0] * len(BODY.vertices))
    binding.CreateJointWeightsPrimvar(False, 1).Set([1.0] * len(BODY.vertices))
    stage.GetRootLayer().Save()
    before = path.read_bytes()
    moving = read_usd(path)
    assert len(moving.frames) == 3
    assert np.abs(moving.frames - BODY.vertices - [[[0, 0, 0]], [[0, 0.25, 0]], [[0, 0.5, 0]]]).max() < 1e-5
    assert path.read_bytes() == before


def test_what_is_wrong_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.usda: avatar file not found"):
        read_usd(tmp_path / "none.usda")
    (tmp_path / "bad.usda").write_text("no")
    with pytest.raises(InputError, match=r"bad\.usda: cannot be read as USD"):
        read_usd(tmp_path / "bad.usda")
    (tmp_path / "damaged.usda").write_bytes(b'#usda 1.0\ndef Mesh "\xff" { }}')
    with pytest.raises(InputError, match=r"damaged\.usda: cannot be read as USD \(it is damaged"):
        read_usd(tmp_path / "damaged.usda")
    (tmp_path / "text.usda").write_text('#usda 1.0\ndef Mesh "m"\n{\n    string points = "many"\n}\n')
    with pytest.raises(InputError, match=r"text\.usda: /m\.points is not the array of numbers"):
        read_usd(tmp_path / "text.usda")
    empty = Usd.Stage.CreateNew(str(tmp_path / "empty.usda"))
    empty.GetRootLayer().Save()
    with pytest.raises(InputError, match=r"empty\.usda: holds no mesh that is shown"):
        read_usd(tmp_path / "empty.usda")
    stage = Usd.Stage.CreateNew(str(tmp_path / "grows.usda"))
    mesh = add_mesh(stage, "/skin", BODY.vertices, BODY.faces)
    for code, faces in ((0, BODY.faces), (1, BODY.faces[::-1])):
        mesh.GetFaceVertexIndicesAttr().Set(Vt.IntArray.FromNumpy(np.ascontiguousarray(faces).ravel()), code)
    stage.GetRootLayer().Save()
    with pytest.raises(InputError, match=r"grows\.usda: skin changes its faces"):
        read_usd(tmp_path / "grows.usda")


def test_points_that_change_their_number_are_refused(tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "grows.usda"))
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(1)
    mesh = add_mesh(stage, "/skin", BODY.vertices, BODY.faces)
    for code, count in ((0, len(BODY.vertices)), (1, len(BODY.vertices) + 1)):
        points = np.resize(BODY.vertices, (count, 3)).astype(np.float32)
        mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(points), code)
    stage.GetRootLayer().Save()
    with pytest.raises(InputError, match=r"frame 1 has \d+ points, the first \d+"):
        read_usd(tmp_path / "grows.usda")


def test_a_vrm_is_read_as_the_glb_that_it_is(tmp_path: Path) -> None:
    from tests.dressing.files.gltf_writer import Glb

    glb = Glb()
    glb.node(mesh=glb.mesh(BODY.vertices * (-1.0, 1.0, -1.0), BODY.faces))
    glb.write(tmp_path / "girl.glb").rename(tmp_path / "girl.vrm")
    avatar = load_scene_avatar(AvatarFile(path=tmp_path / "girl.vrm"))
    assert avatar.front == 180.0 and len(avatar.faces) == len(BODY.faces)
