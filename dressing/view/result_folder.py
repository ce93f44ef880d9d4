"""A folder of results as a view: dressed.glb, the panels of the OBJ files, and the frames of a film."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from toile.dressing.files.gltf.gltf_file import GltfFile, checked_shape
from toile.dressing.files.palette import BODY, garment_colour
from toile.dressing.files.writers.ply import PlyMesh, read_own_ply
from toile.dressing.view.report_facts import facts_of_report
from toile.dressing.view.stretch import patterned, posed, stretched
from toile.dressing.view.view_page import view_page
from toile.dressing.view.view_part import Field, Pose, Shape, ViewPart
from toile.geometry.arrays import Int
from toile.geometry.connected import connected
from toile.geometry.errors import InputError

BODY_NAME = "body"
"""Name of the body in dressed.glb and of its frames."""
FRAMES = "frames"
FRAME = re.compile(r"(.+)\.(\d{4,})\.ply")
"""Folder and names of the frames of a film."""
UV_SCALE = 1e-5
"""Pattern coordinates of frames closer than this are one [m]."""


def folder_page(folder: Path, every: int = 1) -> str:
    """Return a page that shows a folder of results, with every so many frames of its film.

    Raises InputError if there is no dressed.glb that toile wrote.
    """
    parts = film_of_folder(folder, view_of_folder(folder), every)
    rate = frames_per_second(folder) / every
    return view_page(folder.absolute().name, parts, facts_of_folder(folder), rate)


def view_of_folder(folder: Path) -> list[ViewPart]:
    """Return the body and the garments of a folder that `toile dress` wrote, at its end.

    Raises InputError if there is no dressed.glb that toile wrote.
    """
    path = folder / "dressed.glb"
    if not path.is_file():
        raise InputError(
            f"{folder}: there is no dressed.glb in it; name a folder that toile dress wrote", file=folder
        )
    with checked_shape(path):
        return list(parts_of_glb(GltfFile(path), folder))


def parts_of_glb(file: GltfFile, folder: Path | None = None) -> Iterator[ViewPart]:
    """Yield the meshes of a dressed.glb, with the panels that OBJ files beside it have."""
    garments = 0
    for mesh in file.content["meshes"]:
        primitive = mesh["primitives"][0]
        attributes, name = primitive["attributes"], str(mesh["name"])
        positions = np.asarray(file.numbers(attributes["POSITION"], "VEC3"), np.float64)
        faces = file.numbers(primitive["indices"], "SCALAR").astype(np.int32).reshape(-1, 3)
        if name == BODY_NAME:
            yield ViewPart(name=name, kind="body", colour=BODY, poses=(Pose(Shape(faces), positions),))
            continue
        colour, garments = garment_colour(garments), garments + 1
        uv, panel, names = None, None, tuple[str, ...]()
        if "TEXCOORD_0" in attributes:
            uv = np.asarray(file.numbers(attributes["TEXCOORD_0"], "VEC2"), np.float64)
            uv[:, 1] = 1.0 - uv[:, 1]
            names, of_vertex = _panels(folder, name, len(uv))
            panel = of_vertex[faces[:, 0]]
        yield ViewPart(
            name=name, kind="garment", colour=colour, panel_names=names,
            poses=(posed(Shape(faces, uv, panel), positions, _more(file, attributes)),),
        )  # fmt: skip


def film_of_folder(folder: Path, parts: list[ViewPart], every: int = 1) -> list[ViewPart]:
    """Return the parts of a folder as its frames show them, every so many; the parts where it has none."""
    found: dict[str, list[tuple[int, Path]]] = {}
    for path in (folder / FRAMES).glob("*.ply"):
        match = FRAME.fullmatch(path.name)
        if match:
            found.setdefault(match[1], []).append((int(match[2]), path))
    if not found:
        return parts
    films = []
    for part in parts:
        stem = re.sub(r"[^\w.-]+", "_", part.name).strip("._") or "garment"
        frames = [path for _, path in sorted(found.get(stem, ()))][::every]
        films.append(part if not frames else _film(part, frames))
    return films


def frames_per_second(folder: Path) -> float:
    """Return the frame rate that a folder's report tells [1/s]; 24 where it does not."""
    try:
        report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
        return float(report["animation"]["fps"])
    except (OSError, ValueError, LookupError, TypeError):
        return 24.0


def facts_of_folder(folder: Path) -> dict[str, str]:
    """Return what the report of a folder says, in words; nothing where there is none."""
    try:
        return facts_of_report(json.loads((folder / "report.json").read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return {}


def _film(part: ViewPart, frames: list[Path]) -> ViewPart:
    """Return a part with a pose per frame, whose triangles are shared where they stay."""
    poses: list[Pose] = []
    last: PlyMesh | None = None
    rows, shape = np.empty(0, np.int32), part.poses[0].shape
    for path in frames:
        mesh = read_own_ply(path)
        if last is None or not _same(last, mesh):
            rows, shape = _drawn(mesh)
            shape, last = patterned(shape, mesh.positions[rows]), mesh
        poses.append(stretched(shape, mesh.positions[rows]))
    return ViewPart(name=part.name, kind=part.kind, colour=part.colour, poses=tuple(poses))


def _same(one: PlyMesh, other: PlyMesh) -> bool:
    """Whether two frames have the same triangles."""
    if not np.array_equal(one.faces, other.faces):
        return False
    if one.corner_uv is None or other.corner_uv is None:
        return one.corner_uv is other.corner_uv
    return bool(np.array_equal(one.corner_uv, other.corner_uv))


def _drawn(mesh: PlyMesh) -> tuple[Int, Shape]:
    """Return the node of every drawn vertex, one per place of the pattern, and the triangles of those."""
    if mesh.corner_uv is None:
        return np.arange(len(mesh.positions), dtype=np.int32), Shape(mesh.faces)
    keys = np.column_stack(
        [mesh.faces.reshape(-1, 1), np.rint(mesh.corner_uv.reshape(-1, 2) / UV_SCALE).astype(np.int64)]
    )
    kept, first, corner = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    faces = corner.reshape(-1, 3).astype(np.int32)
    uv = mesh.corner_uv.reshape(-1, 2)[first]
    return kept[:, 0].astype(np.int32), Shape(faces, uv, _pieces(faces, len(kept)))


def _pieces(faces: Int, count: int) -> Int:
    """Return the number of the connected piece of every face, shape (t,)."""
    pairs = np.concatenate([faces[:, :2], faces[:, 1:]])
    label = connected(np.ascontiguousarray(pairs), count)
    return np.unique(label[faces[:, 0]], return_inverse=True)[1].astype(np.int32)


def _panels(folder: Path | None, name: str, count: int) -> tuple[tuple[str, ...], Int]:
    """Return names of panels, and the panel of every material vertex, as the groups of an OBJ file."""
    of_vertex = np.zeros(count, np.int32)
    stem = re.sub(r"[^\w.-]+", "_", name).strip("._") or "garment"
    path = None if folder is None else folder / f"{stem}.obj"
    if path is None or not path.is_file():
        return (), of_vertex
    names: list[str] = []
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        if line.startswith("g "):
            names.append(line[2:].strip())
        elif line.startswith("f ") and "/" in line and names:
            corners = [int(corner.split("/")[1]) - 1 for corner in line.split()[1:]]
            if max(corners) >= count:
                return (), np.zeros(count, np.int32)
            of_vertex[corners] = len(names) - 1
    return tuple(names), of_vertex


def _more(file: GltfFile, attributes: dict[str, int]) -> tuple[Field, ...]:
    """Return numbers per vertex that the file names itself, as `_PRESSURE`."""
    return tuple(
        Field(
            name[1:].lower().replace("_", " "),
            "",
            np.asarray(file.numbers(place, "SCALAR"), np.float64).ravel(),
        )
        for name, place in attributes.items()
        if name.startswith("_") and file.content["accessors"][place]["type"] == "SCALAR"
    )
