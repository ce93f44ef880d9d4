"""Reader of USD files, still or in motion: meshes that a renderer shows, skeletons and transforms applied."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from toile.dressing.files.corner_surface import Surface
from toile.dressing.files.moving_file import MovingSurface
from toile.dressing.files.on_disk import is_file
from toile.dressing.files.surface_check import check_vertex_numbers
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

if TYPE_CHECKING:
    from pxr import Usd

FORMATS = (".usd", ".usda", ".usdc", ".usdz")
"""File extensions that are read."""
UNITS = {1.0: "m", 0.1: "dm", 0.01: "cm", 0.001: "mm"}
"""Metres per unit that have a name."""
MOST_FRAMES = 100_000


def read_usd(path: Path) -> MovingSurface:
    """Return the meshes of a stage in its units, at every time code of its range if anything moves.

    Raises InputError if the file cannot be read, holds no mesh, or a mesh changes its faces.
    """
    if not is_file(path):
        raise InputError(f"{path}: avatar file not found; check the path", file=path)
    try:
        from pxr import Tf
    except ImportError:
        raise InputError(
            f"{path}: USD files need usd-core (pip install 'toile[usd]'); or export the body as .glb",
            file=path,
        ) from None
    try:
        return _read(path)
    except (Tf.ErrorException, UnicodeDecodeError) as error:
        raise InputError(
            f"{path}: cannot be read as USD ({_reason(error)}); export it again", file=path
        ) from None


def _reason(error: Exception) -> str:
    """Return the end of a message of USD in one line; it quotes the file, which may not even be text."""
    try:
        return " ".join(str(error).split())[-120:]
    except UnicodeDecodeError:
        return "it is damaged: not UTF-8"


def _read(path: Path) -> MovingSurface:
    """Return what `read_usd` does, with errors of USD's own."""
    from pxr import UsdGeom

    stage = opened_stage(path)
    meshes = shown_meshes(stage)
    if not meshes:
        raise InputError(f"{path}: holds no mesh that is shown; export the body as a mesh", file=path)
    times = frame_times(path, stage, meshes)
    points = [world_points(path, meshes, time) for time in times]
    other = next((index for index, own in enumerate(points) if len(own) != len(points[0])), None)
    if other is not None:
        raise InputError(
            f"{path}: frame {other} has {len(points[other])} points, the first {len(points[0])}; a body "
            "keeps its mesh while it moves",
            file=path,
        )
    frames = np.stack(points)
    bad = np.flatnonzero(~np.isfinite(frames).all(axis=(1, 2)))
    if len(bad):
        raise InputError(
            f"{path}: frame {bad[0]} has NaN or infinite coordinates; export it again", file=path
        )
    metres = UsdGeom.GetStageMetersPerUnit(stage) if stage.HasAuthoredMetadata("metersPerUnit") else 0.0
    axis = UsdGeom.GetStageUpAxis(stage).lower() if stage.HasAuthoredMetadata("upAxis") else None
    return MovingSurface(
        frames=frames,
        surface=_surface(path, meshes, times[0], frames[0]),
        fps=stage.GetTimeCodesPerSecond() if len(times) > 1 else None,
        units=next((name for size, name in UNITS.items() if abs(metres / size - 1.0) < 1e-6), None),
        up=axis,
        notes=(f"{len(meshes)} meshes of the stage were read.",) if len(meshes) > 1 else (),
    )


def opened_stage(path: Path, prepare: Callable[["Usd.Stage"], None] | None = None) -> "Usd.Stage":
    """Return the stage with its skeletons baked into points, after what is done to it before."""
    from pxr import Usd, UsdSkel

    stage = Usd.Stage.Open(str(path))
    if any(prim.IsA(UsdSkel.Root) for prim in stage.Traverse()):
        # The file itself must not be written to.
        stage = Usd.Stage.Open(stage.Flatten())
        if prepare is not None:
            prepare(stage)
        UsdSkel.BakeSkinning(stage.Traverse())
    return stage


def shown_meshes(stage: "Usd.Stage") -> "list[Usd.Prim]":
    """Return the meshes that a renderer shows."""
    return [prim for prim in stage.Traverse() if _is_shown(prim)]


def _is_shown(prim: "Usd.Prim") -> bool:
    """Whether a prim is a mesh with faces that a renderer shows."""
    from pxr import UsdGeom

    if not prim.IsA(UsdGeom.Mesh):
        return False
    image = UsdGeom.Imageable(prim)
    shown = image.ComputePurpose() in (UsdGeom.Tokens.default_, UsdGeom.Tokens.render)
    return bool(shown and image.ComputeVisibility() != UsdGeom.Tokens.invisible)


def frame_times(path: Path, stage: "Usd.Stage", meshes: "list[Usd.Prim]") -> list[Any]:
    """Return the time codes of the frames; one, the earliest, where nothing moves."""
    from pxr import Usd, UsdGeom

    moves = False
    for prim in meshes:
        attributes = [UsdGeom.Mesh(prim).GetPointsAttr()]
        while prim and not prim.IsPseudoRoot():
            attributes += [op.GetAttr() for op in UsdGeom.Xformable(prim).GetOrderedXformOps()]
            prim = prim.GetParent()
        moves = moves or any(attribute.GetNumTimeSamples() > 1 for attribute in attributes)
    if not moves or not stage.HasAuthoredTimeCodeRange():
        return [Usd.TimeCode.EarliestTime()]
    start, end = stage.GetStartTimeCode(), stage.GetEndTimeCode()
    if not 0.0 <= end - start < MOST_FRAMES:
        raise InputError(f"{path}: its time codes run from {start:g} to {end:g}; export it again", file=path)
    return [Usd.TimeCode(start + index) for index in range(int(end - start + 1e-6) + 1)]


def world_points(path: Path, meshes: "list[Usd.Prim]", time: Any) -> Float:
    """Return the points of all meshes in the world at a time, shape (n, 3)."""
    from pxr import UsdGeom

    places = UsdGeom.XformCache(time)
    points = []
    for prim in meshes:
        local = _rows(path, UsdGeom.Mesh(prim).GetPointsAttr(), time, np.float64, 3)
        world = np.asarray(places.GetLocalToWorldTransform(prim), np.float64)
        points.append(local @ world[:3, :3] + world[3, :3])
    return np.concatenate(points)


def _rows(path: Path, attribute: Any, time: Any, kind: type[np.generic], width: int) -> npt.NDArray[Any]:
    """Return the values of an attribute at a time, shape (n, width); files may declare it as another type."""
    try:
        return np.asarray(attribute.Get(time) or (), kind).reshape(-1, width)
    except (TypeError, ValueError):
        raise InputError(
            f"{path}: {attribute.GetPath()} is not the array of numbers that it is in meshes; "
            "export it again",
            file=path,
        ) from None


def _surface(path: Path, meshes: "list[Usd.Prim]", time: Any, positions: Float) -> Surface:
    """Return the faces of all meshes on their points; meshes are panels."""
    from pxr import UsdGeom

    corners: list[list[int]] = []
    panel: list[int] = []
    first = 0
    for number, prim in enumerate(meshes):
        mesh = UsdGeom.Mesh(prim)
        if mesh.GetFaceVertexIndicesAttr().GetNumTimeSamples() > 1 and _changes(mesh):
            raise InputError(
                f"{path}: {prim.GetName()} changes its faces; a body keeps its mesh while it moves", file=path
            )
        counts = _rows(path, mesh.GetFaceVertexCountsAttr(), time, np.int64, 1).ravel()
        indices = _rows(path, mesh.GetFaceVertexIndicesAttr(), time, np.int64, 1).ravel()
        here = len(_rows(path, mesh.GetPointsAttr(), time, np.float64, 3))
        if counts.sum() != len(indices) or (counts < 0).any():
            raise InputError(
                f"{path}: {prim.GetName()}: faces and their counts differ; export it again", file=path
            )
        check_vertex_numbers(path, indices.reshape(-1, 1), here, "export it again")
        mirrored = mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded
        for face in np.split(indices + first, np.cumsum(counts)[:-1]):
            if len(face) > 2:
                corners.append(face[::-1].tolist() if mirrored else face.tolist())
                panel.append(number)
        first += here
    surface = Surface.from_polygons(
        positions=positions, corners=corners, uv=np.empty((0, 2)),
        uv_corners=[[-1] * len(corner) for corner in corners], panel=np.array(panel, np.int32),
    )  # fmt: skip
    return surface.with_panel_names(tuple(prim.GetName() for prim in meshes))


def _changes(mesh: Any) -> bool:
    """Whether faces differ from one time sample to another."""
    attribute = mesh.GetFaceVertexIndicesAttr()
    samples: list[Int] = [np.asarray(attribute.Get(time)) for time in attribute.GetTimeSamples()]
    return any(not np.array_equal(sample, samples[0]) for sample in samples[1:])
