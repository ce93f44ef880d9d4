"""USD: meshes over time, with time samples that Blender, Houdini and usdview open.

Points, faces and texture coordinates have a sample per frame, since remeshing changes them.
"""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

from toile.dressing.files.writers.atomic import replacing
from toile.dressing.files.writers.ply import PlyMesh


class UsdMesh(NamedTuple):
    """One mesh over time: its name, linear colour and a PlyMesh per frame, in metres."""

    name: str
    colour: tuple[float, float, float]
    frames: Iterable[PlyMesh]


def write_usd(path: Path, fps: float, meshes: Sequence[UsdMesh]) -> Path:
    """Write a .usdc file of meshes over time, frame 0 at time code 0, and return its path."""
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetTimeCodesPerSecond(fps)
    stage.SetFramesPerSecond(fps)
    root = UsdGeom.Xform.Define(stage, "/dressed")
    stage.SetDefaultPrim(root.GetPrim())
    last = 0
    for mesh in meshes:
        prim = UsdGeom.Mesh.Define(stage, f"/dressed/{mesh.name}")
        prim.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        prim.CreateDoubleSidedAttr(True)
        prim.CreateDisplayColorAttr([Gf.Vec3f(*mesh.colour)])
        uv = UsdGeom.PrimvarsAPI(prim).CreatePrimvar(
            "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.faceVarying
        )
        for index, frame in enumerate(mesh.frames):
            points = np.ascontiguousarray(frame.positions, np.float32)
            prim.CreatePointsAttr().Set(Vt.Vec3fArray.FromNumpy(points), index)
            counts = np.full(len(frame.faces), 3, np.int32)
            prim.CreateFaceVertexCountsAttr().Set(Vt.IntArray.FromNumpy(counts), index)
            corners = np.ascontiguousarray(frame.faces.ravel(), np.int32)
            prim.CreateFaceVertexIndicesAttr().Set(Vt.IntArray.FromNumpy(corners), index)
            extent = np.stack([points.min(axis=0), points.max(axis=0)])
            prim.CreateExtentAttr().Set(Vt.Vec3fArray.FromNumpy(extent), index)
            if frame.corner_uv is not None:
                flat = np.ascontiguousarray(frame.corner_uv.reshape(-1, 2), np.float32)
                uv.Set(Vt.Vec2fArray.FromNumpy(flat), index)
            last = max(last, index)
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(last)
    with replacing(path) as temporary:
        stage.Export(str(temporary))
    return path
