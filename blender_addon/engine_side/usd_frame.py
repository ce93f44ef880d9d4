"""One frame of a garment as a USDC file that Blender's Mesh Sequence Cache reads completely."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from pxr import Sdf, Usd, UsdGeom, Vt

from toile.dressing.files.writers.atomic import replacing
from toile.geometry.arrays import Float, Int

PRIM = "/garment"
"""Path of the mesh in the file."""
DOMAINS = {"POINT": "vertex", "FACE": "uniform", "CORNER": "faceVarying"}
"""Blender's domains of attributes, and what USD calls them."""


class Primvar(NamedTuple):
    """Values of an attribute: its name, domain and type in Blender, one row per element."""

    name: str
    domain: str
    kind: str
    values: npt.NDArray[Any]


def write_usd_frame(
    path: Path, points: Float, faces: Int, velocities: Float | None, primvars: Sequence[Primvar]
) -> None:
    """Write a mesh of points (n, 3), Z up, and triangles (t, 3); velocities (n, 3) are per second."""
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    prim = UsdGeom.Mesh.Define(stage, PRIM)
    stage.SetDefaultPrim(prim.GetPrim())
    prim.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    prim.CreatePointsAttr(_vectors(points))
    prim.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(faces), 3, np.int32)))
    prim.CreateFaceVertexIndicesAttr(_whole(faces.ravel()))
    if velocities is not None:
        prim.CreateVelocitiesAttr(_vectors(velocities))
    interface = UsdGeom.PrimvarsAPI(prim)
    order = []
    for primvar in primvars:
        kind, values = _typed(primvar)
        made = interface.CreatePrimvar(primvar.name, kind, DOMAINS[primvar.domain])
        made.Set(values)
        order.append(made.GetName())
    # Blender makes the first UV map that it reads the active one.
    prim.GetPrim().SetPropertyOrder(order)
    with replacing(path) as temporary:
        stage.Export(str(temporary))


def _typed(primvar: Primvar) -> tuple[Any, Any]:
    """Return the USD type and the values of an attribute."""
    names, values = Sdf.ValueTypeNames, primvar.values
    if primvar.kind == "FLOAT":
        return names.FloatArray, Vt.FloatArray.FromNumpy(_single(values))
    if primvar.kind == "INT":
        return names.IntArray, _whole(values)
    if primvar.kind == "BOOLEAN":
        return names.BoolArray, Vt.BoolArray(values.astype(bool).tolist())
    if primvar.kind == "FLOAT2":
        return names.TexCoord2fArray, Vt.Vec2fArray.FromNumpy(_single(values))
    if primvar.kind == "FLOAT_VECTOR":
        return names.Float3Array, _vectors(values)
    if primvar.kind == "QUATERNION":
        return names.QuatfArray, Vt.QuatfArray.FromNumpy(_single(np.roll(values, -1, axis=1)))
    return names.Color4fArray, Vt.Vec4fArray.FromNumpy(_single(values))


def _single(values: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    return np.ascontiguousarray(values, np.float32)


def _vectors(values: npt.NDArray[Any]) -> Any:
    return Vt.Vec3fArray.FromNumpy(_single(values))


def _whole(values: npt.NDArray[Any]) -> Any:
    return Vt.IntArray.FromNumpy(np.ascontiguousarray(values, np.int32))
