"""USD files say once what stays, hold together between frames, and pass the checks of USD itself."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.collide.surfaces import sheet
from toile.dressing.files.writers.ply import PlyMesh
from toile.geometry.arrays import Float, Int

pytest.importorskip("pxr", reason="USD is not installed: pip install 'toile[usd]'")

from pxr import Usd, UsdGeom, UsdShade, UsdValidation

from toile.dressing.files.writers.usd import UsdMesh, write_usd

FPS = 25.0
VELOCITY = np.array([0.5, 0.0, -1.0])


def shuffled(points: Float, faces: Int, seed: int) -> tuple[Float, Int]:
    """The same sheet, its vertices and faces in another order: equal counts, other faces."""
    random = np.random.default_rng(seed)
    order = random.permutation(len(points))
    return points[order], np.argsort(order).astype(np.int32)[faces][random.permutation(len(faces))]


def moving(shapes: Sequence[tuple[Float, Int]], velocities: bool = True) -> list[PlyMesh]:
    """A frame per shape, which moves with VELOCITY, the texture coordinates those of the sheet at rest."""
    return [
        PlyMesh(
            positions=points + VELOCITY * index / FPS, faces=faces, corner_uv=points[faces][:, :, [0, 2]],
            velocities=np.tile(VELOCITY, (len(points), 1)) if velocities else None,
        )
        for index, (points, faces) in enumerate(shapes)
    ]  # fmt: skip


SHEET = sheet(5, 0.1)
STILL = [SHEET] * 4
REMESHED = [SHEET, SHEET, shuffled(*SHEET, 1), shuffled(*SHEET, 2), shuffled(*SHEET, 2)]
COARSER = [sheet(7, 0.4 / 6), sheet(7, 0.4 / 6), SHEET, SHEET]
FILMS = {"still": STILL, "remeshed": REMESHED, "coarser": COARSER}


def written(folder: Path, frames: list[PlyMesh], name: str = "shirt") -> Any:
    path = write_usd(folder / "film.usdc", FPS, [UsdMesh(name, (0.1, 0.2, 0.3), frames)])
    return Usd.Stage.Open(str(path))


def mesh(stage: Any, name: str = "shirt") -> Any:
    return UsdGeom.Mesh(stage.GetPrimAtPath(f"/dressed/{name}"))


def triangles(prim: Any, time: Any) -> Float:
    """Corners of the triangles at a time, shape (t, 3, 3), after a check that all arrays belong together."""
    points = np.array(prim.GetPointsAttr().Get(time))
    counts = np.array(prim.GetFaceVertexCountsAttr().Get(time))
    corners = np.array(prim.GetFaceVertexIndicesAttr().Get(time))
    assert (counts == 3).all() and len(corners) == counts.sum()
    assert corners.min() >= 0 and corners.max() < len(points)
    assert len(prim.GetNormalsAttr().Get(time)) == len(points)
    assert len(prim.GetVelocitiesAttr().Get(time)) == len(points)
    assert len(UsdGeom.PrimvarsAPI(prim).GetPrimvar("st").Get(time)) == len(corners)
    low, high = np.array(prim.GetExtentAttr().Get(time))
    assert np.allclose(low, points.min(axis=0), atol=1e-6)
    assert np.allclose(high, points.max(axis=0), atol=1e-6)
    return np.asarray(points[corners].reshape(-1, 3, 3), np.float64)


def area(corners: Float) -> float:
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(0.5 * np.linalg.norm(normals, axis=1).sum())


@pytest.mark.parametrize("name", FILMS)
def test_usd_itself_finds_no_fault(name: str, tmp_path: Path) -> None:
    stage = written(tmp_path, moving(FILMS[name]))
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) > 20
    errors = UsdValidation.ValidationContext(validators).Validate(stage)
    assert [error.GetErrorAsString() for error in errors] == []


@pytest.mark.parametrize("name", FILMS)
def test_the_mesh_holds_together_at_every_time(name: str, tmp_path: Path) -> None:
    """Also between frames: the area stays, and the sheet is where its velocity has brought it."""
    shapes = FILMS[name]
    stage = written(tmp_path, moving(shapes))
    prim = mesh(stage)
    assert np.array_equal(triangles(prim, Usd.TimeCode.Default()), triangles(prim, 0))
    for time in np.linspace(0.0, len(shapes) - 1, 8 * (len(shapes) - 1) + 1):
        corners = triangles(prim, time)
        points, faces = shapes[int(time)]
        assert np.allclose(corners, points[faces] + VELOCITY * time / FPS, atol=1e-6), time
        assert abs(area(corners) - 0.16) < 1e-6
        assert np.allclose(np.array(prim.GetNormalsAttr().Get(time)), (0.0, 1.0, 0.0), atol=1e-6)


def test_what_stays_is_written_once(tmp_path: Path) -> None:
    stage = written(tmp_path, moving(STILL))
    prim = mesh(stage)
    uv = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
    assert uv.GetInterpolation() == UsdGeom.Tokens.faceVarying
    for attribute in (prim.GetFaceVertexCountsAttr(), prim.GetFaceVertexIndicesAttr(), uv.GetAttr()):
        assert attribute.GetTimeSamples() == [] and attribute.Get() is not None
    assert prim.GetPointsAttr().GetTimeSamples() == [0.0, 1.0, 2.0, 3.0]


def test_faces_have_samples_where_they_change(tmp_path: Path) -> None:
    stage = written(tmp_path, moving(REMESHED))
    prim = mesh(stage)
    assert prim.GetFaceVertexIndicesAttr().GetTimeSamples() == [0.0, 2.0, 3.0]
    step = Usd.TimeCode.SafeStep()
    samples = [0.0, 1.0, 2.0 - step, 2.0, 3.0 - step, 3.0, 4.0]
    for attribute in (prim.GetPointsAttr(), prim.GetNormalsAttr(), prim.GetVelocitiesAttr()):
        assert attribute.GetTimeSamples() == samples


@pytest.mark.parametrize("given", [True, False])
def test_velocities_are_those_of_the_frames(given: bool, tmp_path: Path) -> None:
    """Given, or from the neighbours of a mesh that stays."""
    stage = written(tmp_path, moving(STILL, given))
    prim = mesh(stage)
    for time in range(len(STILL)):
        assert np.allclose(np.array(prim.GetVelocitiesAttr().Get(time)), VELOCITY, atol=1e-5)


def test_material_is_bound(tmp_path: Path) -> None:
    stage = written(tmp_path, moving(STILL))
    material, _ = UsdShade.MaterialBindingAPI(mesh(stage).GetPrim()).ComputeBoundMaterial()
    shader = material.ComputeSurfaceSource()[0]
    assert shader.GetIdAttr().Get() == "UsdPreviewSurface"
    assert np.allclose(shader.GetInput("diffuseColor").Get(), (0.1, 0.2, 0.3))


def test_names_that_usd_does_not_allow_or_that_meet(tmp_path: Path) -> None:
    """A name that begins with a digit, three that become the same, one that is taken."""
    names = ["3d shirt", "a-b", "a.b", "a_b", "Looks"]
    path = write_usd(
        tmp_path / "film.usdc", FPS, [UsdMesh(name, (1.0, 1.0, 1.0), moving(STILL)) for name in names]
    )
    stage = Usd.Stage.Open(str(path))
    found = [prim.GetName() for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    assert found == ["_d_shirt", "a_b", "a_b_2", "a_b_3", "Looks_2"]
