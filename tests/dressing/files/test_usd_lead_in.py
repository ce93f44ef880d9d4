"""A lead-in to a motion in USD: from the rest pose of its skeleton to its first frame."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.dressing.files.skinned_mannequin import PLACES, joint_weights
from toile.dressing.body.mannequin import mannequin
from toile.dressing.files.usd_file import read_usd
from toile.dressing.run.lead_in import led_in
from toile.dressing.run.scene import AvatarFile
from toile.dressing.run.scene_avatar import load_dress_form
from toile.geometry.arrays import Float

pxr = pytest.importorskip("pxr")
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt  # noqa: E402

from toile.dressing.files.leading.usd_lead_in import has_usd_skeleton, read_usd_lead_in  # noqa: E402

BODY = mannequin()
COUNT = 4
JOINTS = ["hips", "hips/left", "hips/right"]


def quaternion(degrees: float) -> "Gf.Quatf":
    x, y, z, w = Rotation.from_euler("z", degrees, degrees=True).as_quat().tolist()
    return Gf.Quatf(w, x, y, z)


def local_rest(hang: float) -> "list[Gf.Matrix4d]":
    """Transforms by the parents, arms `hang` degrees below those of the mannequin."""
    matrices = []
    for place, turn in zip((PLACES[0], *(PLACES[1:] - PLACES[0])), (0.0, -hang, hang), strict=True):
        matrix = Gf.Matrix4d(1.0)
        matrix.SetRotate(quaternion(turn))
        matrix.SetTranslateOnly(Gf.Vec3d(*place.tolist()))
        matrices.append(matrix)
    return matrices


def skinned(folder: Path, *, rest_hang: float = 0.0, start: int = 10) -> Path:
    """The mannequin in centimetres on a joint for its trunk and one for each arm; arms hang in the clip."""
    path = folder / "hanging.usda"
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetTimeCodesPerSecond(24.0)
    stage.SetStartTimeCode(start)
    stage.SetEndTimeCode(start + 2)
    UsdSkel.Root.Define(stage, "/root")
    skeleton = UsdSkel.Skeleton.Define(stage, "/root/skeleton")
    skeleton.CreateJointsAttr(JOINTS)
    bind = [Gf.Matrix4d(1.0).SetTranslate(Gf.Vec3d(*place.tolist())) for place in PLACES]
    skeleton.CreateBindTransformsAttr(bind)
    skeleton.CreateRestTransformsAttr(local_rest(rest_hang))
    animation = UsdSkel.Animation.Define(stage, "/root/walk")
    # Joints in another order than the skeleton's.
    animation.CreateJointsAttr([JOINTS[2], JOINTS[0], JOINTS[1]])
    animation.CreateScalesAttr([Gf.Vec3h(1.0)] * 3)
    animation.CreateTranslationsAttr()
    animation.CreateRotationsAttr()
    left, right = (Gf.Vec3f(*(place - PLACES[0]).tolist()) for place in PLACES[1:])
    for code in range(3):
        hips = Gf.Vec3f(2.0, float(PLACES[0, 1]), 1.0 + 0.02 * code)
        animation.GetTranslationsAttr().Set([right, hips, left], start + code)
        down = 28.0 - code
        animation.GetRotationsAttr().Set([quaternion(down), Gf.Quatf(1.0), quaternion(-down)], start + code)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets(
        [Sdf.Path("/root/walk")]
    )
    mesh = UsdGeom.Mesh.Define(stage, "/root/skin")
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(BODY.vertices.astype(np.float32)))
    mesh.CreateFaceVertexCountsAttr([3] * len(BODY.faces))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(BODY.faces.ravel()))
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([Sdf.Path("/root/skeleton")])
    weights = joint_weights(BODY.vertices)
    count = len(BODY.vertices)
    binding.CreateJointIndicesPrimvar(False, 3).Set([0, 1, 2] * count)
    binding.CreateJointWeightsPrimvar(False, 3).Set(weights.ravel().tolist())
    stage.GetRootLayer().Save()
    return path


def away(frame: Float, pose: Float) -> float:
    """How far a body is from a pose that is moved along the floor [m]."""
    shift = frame - pose
    return float(np.abs(shift - shift.mean(axis=0) * (1.0, 0.0, 1.0)).max())


def test_it_goes_from_the_rest_pose_to_the_first_frame(tmp_path: Path) -> None:
    path = skinned(tmp_path)
    before = path.read_bytes()
    moving = read_usd(path)
    own, bound = read_usd_lead_in(path, COUNT, 1)
    assert path.read_bytes() == before and own.shape == (COUNT, *moving.frames[0].shape)
    assert np.allclose(own, bound, atol=1e-5)
    # The body as it was modelled, standing where the clip begins.
    assert away(own[0], BODY.vertices) < 1e-3
    middle = own.mean(axis=1)[:, [0, 2]] - moving.frames[0].mean(axis=0)[[0, 2]]
    assert np.abs(middle).max() < 1e-5 and np.abs(own[:, :, 1].min(axis=1)).max() < 1e-5
    # Shares of the way of the arms: 0, 5/32, 1/2, 27/32.
    arm = np.abs(BODY.vertices[:, 0]) > 0.4
    drop = (own[0] - own)[:, arm, 1].mean(axis=1) / (own[0] - moving.frames[0])[arm, 1].mean()
    angle = np.radians(45.0 + 28.0 * np.array([0.0, 5.0 / 32.0, 0.5, 27.0 / 32.0, 1.0]))
    height = np.sin(angle) - np.sin(angle[0])
    assert drop == pytest.approx(height[:4] / height[4], abs=0.01)


def test_a_skeleton_that_rests_with_hanging_arms_was_bound_with_them_apart(tmp_path: Path) -> None:
    own, bound = read_usd_lead_in(skinned(tmp_path, rest_hang=28.0), COUNT, 1)
    assert away(bound[0], BODY.vertices) < 1e-3 < 0.1 < away(own[0], BODY.vertices)


def test_garments_are_sewn_there(tmp_path: Path) -> None:
    file = AvatarFile(path=skinned(tmp_path))
    avatar, form = load_dress_form(file, {})
    led, rest, why = led_in(file, avatar, form, True)
    assert why is not None and "in its rest pose (arms at 45 degrees)" in why
    assert avatar.motion is not None and led.motion is not None and led.motion.lead == 24
    assert np.allclose(led.motion.frames[24:], avatar.motion.frames, atol=1e-6)
    assert np.degrees(rest.measurements.arm_angle) == pytest.approx(45.0, abs=1.0)


def test_files_without_skeletons_have_none(tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "a.usda"))
    UsdGeom.Sphere.Define(stage, "/ball")
    stage.GetRootLayer().Save()
    assert not has_usd_skeleton(tmp_path / "a.usda") and not has_usd_skeleton(tmp_path / "a.npz")
    assert has_usd_skeleton(skinned(tmp_path))
