"""A lead-in to a motion in a USD file: from a pose of rest of its skeletons to its first frame.

Every joint goes from one to the other: rotations by spherical interpolation, the shorter way, translations,
scales and weights of blend shapes along lines; all ease in and out, as those of glTF do.
"""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from toile.dressing.files.leading.standing import eased, standing
from toile.dressing.files.usd_file import (
    FORMATS,
    frame_times,
    opened_stage,
    shown_meshes,
    world_points,
)
from toile.geometry.arrays import Float

if TYPE_CHECKING:
    from pxr import Sdf, Usd

LED = "toile_lead_in"
"""Name of the animation that is made, beside its skeleton."""
SINGULAR = 1e-30


def has_usd_skeleton(path: Path) -> bool:
    """Whether a file that has been read holds a skeleton in USD that is animated."""
    if path.suffix.lower() not in FORMATS:
        return False
    from pxr import Usd

    stage = Usd.Stage.Open(str(path))
    return any(_animation(prim) is not None for prim in stage.Traverse())


def read_usd_lead_in(path: Path, count: int, up: int) -> list[Float]:
    """Return what leads to the first frame from each pose of rest: the joints' own, that of binding.

    Parameters
    ----------
    path
        A file that `read_usd` reads.
    count
        Frames of the lead-in; the first of the motion is none of them.
    up
        Number of the axis that points up.

    Returns
    -------
    list of ndarray
        Vertices in file units, shape (count, v, 3), the same as those of `read_usd`; from the first frame on
        the body stands where the motion begins, and faces where it does.
    """
    found: list[Float] = []
    start = _start(path)
    for bound in (False, True):
        below: set[Sdf.Path] = set()
        stage = opened_stage(path, partial(_lead, bound=bound, start=start, count=count, below=below))
        meshes = shown_meshes(stage)
        frames = np.stack([world_points(path, meshes, start - count + k) for k in range(count + 1)])
        moves = np.concatenate(
            [np.full(len(world_points(path, [prim], start)), prim.GetPath() in below) for prim in meshes]
        )
        if moves.any():
            frames[:, moves] = standing(frames[:, moves], up)
            found.append(frames[:-1])
    return found


def _start(path: Path) -> float:
    """Return the time code of the first frame."""
    stage = opened_stage(path)
    return float(frame_times(path, stage, shown_meshes(stage))[0].GetValue())


def _animation(prim: "Usd.Prim") -> Any:
    """Return the query of a skeleton's animation, or None."""
    from pxr import UsdSkel

    if not prim.IsA(UsdSkel.Skeleton):
        return None
    query = UsdSkel.Cache().GetSkelQuery(UsdSkel.Skeleton(prim))
    animation = query.GetAnimQuery() if query else None
    return animation if animation and animation.GetPrim() else None


def _lead(stage: "Usd.Stage", *, bound: bool, start: float, count: int, below: "set[Sdf.Path]") -> None:
    """Give every animated skeleton of a flattened stage the way to its first pose, before its first time.

    Paths below roots of skeletons, which baking turns into others, are noted in `below`.
    """
    from pxr import Gf, Sdf, UsdSkel, Vt

    below.update(prim.GetPath() for prim in stage.Traverse() if UsdSkel.Root.Find(prim))
    shares = np.append(eased(count), 1.0)
    for prim in [prim for prim in stage.Traverse() if _animation(prim) is not None]:
        source = _animation(prim)
        query = UsdSkel.Cache().GetSkelQuery(UsdSkel.Skeleton(prim))
        first = _locals(query.ComputeJointLocalTransforms(start))
        rest = _bound(query) if bound else None
        if rest is None:
            rest = _locals(query.ComputeJointLocalTransforms(start, atRest=True))
        place = prim.GetPath().GetParentPath().AppendChild(f"{prim.GetName()}_{LED}")
        made = UsdSkel.Animation.Define(stage, place)
        made.CreateJointsAttr(query.GetJointOrder())
        attributes = [made.CreateTranslationsAttr(), made.CreateRotationsAttr(), made.CreateScalesAttr()]
        (move, turn, scale), (to_move, to_turn, to_scale) = _parts(rest), _parts(first)
        ways = [Slerp([0.0, 1.0], Rotation.from_quat(ends)) for ends in np.stack([turn, to_turn], axis=1)]
        shapes = source.GetBlendShapeOrder()
        weights = np.asarray(source.ComputeBlendShapeWeights(start) if len(shapes) else [], np.float64)
        for number, share in enumerate(shares):
            time = start - count + number
            turned = [way([share]).as_quat()[0].tolist() for way in ways]
            values = (
                Vt.Vec3fArray.FromNumpy(np.asarray((1.0 - share) * move + share * to_move, np.float32)),
                Vt.QuatfArray([Gf.Quatf(w, x, y, z) for x, y, z, w in turned]),
                Vt.Vec3hArray.FromNumpy(np.asarray((1.0 - share) * scale + share * to_scale, np.float16)),
            )
            for attribute, value in zip(attributes, values, strict=True):
                attribute.Set(value, time)
            if len(shapes):
                made.CreateBlendShapesAttr(shapes)
                made.CreateBlendShapeWeightsAttr().Set(Vt.FloatArray((share * weights).tolist()), time)
        UsdSkel.BindingAPI.Apply(prim).CreateAnimationSourceRel().SetTargets([Sdf.Path(place)])


def _locals(transforms: Any) -> Float:
    """Return matrices of USD, for columns, shape (j, 4, 4)."""
    return np.asarray(transforms, np.float64).reshape(-1, 4, 4).swapaxes(1, 2)


def _bound(query: Any) -> Float | None:
    """Return the transforms of joints by their parents as they were bound, (j, 4, 4), or None."""
    world = _locals(query.GetJointWorldBindTransforms())
    topology = query.GetTopology()
    if len(world) != len(query.GetJointOrder()) or (np.abs(np.linalg.det(world)) < SINGULAR).any():
        return None
    # Bind transforms are in the room; the topmost joints stay in the skeleton's frame as they are at rest.
    rest = _locals(query.ComputeJointLocalTransforms(0.0, atRest=True))
    parents = [topology.GetParent(number) for number in range(len(world))]
    return np.stack(
        [
            rest[number] if parent < 0 else np.linalg.solve(world[parent], world[number])
            for number, parent in enumerate(parents)
        ]
    )


def _parts(matrices: Float) -> tuple[Float, Float, Float]:
    """Return translations (j, 3), quaternions (x, y, z, w), (j, 4), and scales (j, 3) of transforms."""
    scales = np.linalg.norm(matrices[:, :3, :3], axis=1)
    scales = np.where(np.linalg.det(matrices[:, :3, :3])[:, None] < 0.0, -scales, scales)
    turns = matrices[:, :3, :3] / np.where(scales == 0.0, 1.0, scales)[:, None, :]
    return matrices[:, :3, 3], np.asarray(Rotation.from_matrix(turns).as_quat()), scales
