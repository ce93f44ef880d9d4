"""USD: meshes over time that Blender, Houdini and usdview open.

What never changes is written once. Faces and texture coordinates have time samples only where remeshing
changes them; points, normals, velocities and extents have one per frame. Just before faces change the mesh of
the frame before has another sample, moved by its velocities: USD interpolates between samples of equal
length, which would draw vertices of one mesh to those of another.
"""

import errno
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from pxr import Gf, Kind, Sdf, Tf, Usd, UsdGeom, UsdShade, Vt

from toile.dressing.files.writers.atomic import replacing
from toile.dressing.files.writers.ply import PlyMesh
from toile.geometry.arrays import Float
from toile.geometry.normals import drawn_normals

ROOT = "/dressed"
ROUGHNESS = 0.8
"""Of skin and cloth, which hardly shine."""


class UsdMesh(NamedTuple):
    """One mesh over time: its name, linear colour and a PlyMesh per frame, in metres.

    Frames without velocities get them from their neighbours, if faces stay the same.
    """

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
    root = UsdGeom.Xform.Define(stage, ROOT)
    Usd.ModelAPI(root.GetPrim()).SetKind(Kind.Tokens.component)
    stage.SetDefaultPrim(root.GetPrim())
    materials = UsdGeom.Scope.Define(stage, f"{ROOT}/Looks").GetPath()
    taken = {"Looks"}
    last = 0
    for mesh in meshes:
        name = _free_name(mesh.name, taken)
        prim = _mesh_prim(stage, name, mesh.colour, materials)
        last = max(last, _Track(prim).write(mesh.frames, fps))
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(last)
    with replacing(path) as temporary:
        try:
            written = stage.Export(str(temporary))
        except Tf.ErrorException as error:
            # Of writing, the library tells no kinds of errors apart.
            raise OSError(
                errno.ENOSPC, f"USD could not write it ({' '.join(str(error).split())[:120]})"
            ) from None
        if not written:
            raise OSError(errno.ENOSPC, "USD could not write it")
    return path


def _free_name(name: str, taken: set[str]) -> str:
    """Return a name that USD allows and no mesh has yet, and note it."""
    valid = Tf.MakeValidIdentifier(name)
    number = 2
    free = valid
    while free in taken:
        free, number = f"{valid}_{number}", number + 1
    taken.add(free)
    return str(free)


def _mesh_prim(stage: Any, name: str, colour: tuple[float, float, float], materials: Any) -> Any:
    """Define a mesh with what does not change, and its material."""
    prim = UsdGeom.Mesh.Define(stage, f"{ROOT}/{name}")
    prim.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    prim.CreateDoubleSidedAttr(True)
    prim.CreateDisplayColorAttr([Gf.Vec3f(*colour)])
    prim.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
    material = UsdShade.Material.Define(stage, materials.AppendChild(name))
    shader = UsdShade.Shader.Define(stage, material.GetPath().AppendChild("Surface"))
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*colour))
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(ROUGHNESS)
    surface = shader.CreateOutput("surface", Sdf.ValueTypeNames.Token)
    material.CreateSurfaceOutput().ConnectToSource(surface)
    UsdShade.MaterialBindingAPI.Apply(prim.GetPrim()).Bind(material)
    return prim


class _Track:
    """The attributes of a mesh prim that may change over time."""

    def __init__(self, prim: Any) -> None:
        self._points = prim.CreatePointsAttr()
        self._normals = prim.CreateNormalsAttr()
        self._velocities = prim.CreateVelocitiesAttr()
        self._extent = prim.CreateExtentAttr()
        self._counts = prim.CreateFaceVertexCountsAttr()
        self._corners = prim.CreateFaceVertexIndicesAttr()
        self._primvars = UsdGeom.PrimvarsAPI(prim)
        self._first: PlyMesh | None = None
        self._changes = False

    def write(self, frames: Iterable[PlyMesh], fps: float) -> int:
        """Write frames at time codes from 0 on; return the last."""
        before: PlyMesh | None = None
        here: PlyMesh | None = None
        index = -1
        for following in frames:
            if here is not None:
                here = self._with_velocities(before, here, following, fps)
                self._frame(before, here, index, fps)
            before, here, index = here, following, index + 1
        if here is not None:
            self._frame(before, self._with_velocities(before, here, None, fps), index, fps)
        return max(index, 0)

    def _with_velocities(
        self, before: PlyMesh | None, here: PlyMesh, following: PlyMesh | None, fps: float
    ) -> PlyMesh:
        """Return a frame with the mean velocity between the neighbours whose faces are the same."""
        if here.velocities is not None:
            return here
        near = [frame for frame in (before, here, following) if frame is not None and _same(frame, here)]
        spans = max(len(near) - 1, 1)
        return here._replace(velocities=(near[-1].positions - near[0].positions) * (fps / spans))

    def _frame(self, before: PlyMesh | None, here: PlyMesh, index: int, fps: float) -> None:
        """Write a frame at its time code, and what it ends just before."""
        if self._first is None or before is None:
            self._first = here
            self._shape(here, Usd.TimeCode.Default())
            self._faces(here, Usd.TimeCode.Default())
        elif not _same(before, here):
            if not self._changes:
                self._faces(self._first, 0)
                self._changes = True
            step = Usd.TimeCode.SafeStep()
            moved = before.positions
            if before.velocities is not None:
                moved = moved + before.velocities * ((1.0 - step) / fps)
            self._shape(before._replace(positions=moved), index - step)
            self._faces(here, index)
        self._shape(here, index)

    def _shape(self, frame: PlyMesh, time: Any) -> None:
        points = _single(frame.positions)
        self._points.Set(_vectors(points), time)
        self._normals.Set(_vectors(drawn_normals(frame.positions, frame.faces)), time)
        self._extent.Set(_vectors(np.stack([points.min(axis=0), points.max(axis=0)])), time)
        if frame.velocities is not None:
            self._velocities.Set(_vectors(frame.velocities), time)

    def _faces(self, frame: PlyMesh, time: Any) -> None:
        self._counts.Set(Vt.IntArray.FromNumpy(np.full(len(frame.faces), 3, np.int32)), time)
        self._corners.Set(Vt.IntArray.FromNumpy(np.ascontiguousarray(frame.faces.ravel(), np.int32)), time)
        if frame.corner_uv is not None:
            uv = self._primvars.CreatePrimvar(
                "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.faceVarying
            )
            uv.Set(Vt.Vec2fArray.FromNumpy(_single(frame.corner_uv.reshape(-1, 2))), time)


def _same(one: PlyMesh, other: PlyMesh) -> bool:
    """Whether two frames have the same faces and texture coordinates."""
    if one.positions.shape != other.positions.shape or not np.array_equal(one.faces, other.faces):
        return False
    if one.corner_uv is None or other.corner_uv is None:
        return one.corner_uv is other.corner_uv
    return np.array_equal(one.corner_uv, other.corner_uv)


def _single(values: Float) -> npt.NDArray[np.float32]:
    return np.ascontiguousarray(values, np.float32)


def _vectors(values: npt.NDArray[Any]) -> Any:
    return Vt.Vec3fArray.FromNumpy(_single(values))
