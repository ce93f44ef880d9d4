"""VTU, legacy VTK, XDMF, Abaqus and Gmsh files as surfaces, read by meshio.

Polygons are split into triangles, volume cells give their surface, and cells without area are left out.
"""

import io
import re
import warnings
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.files.corner_surface import MeshFile, Surface, node_attributes
from toile.dressing.files.volume_skin import CELL_FACES, Cells, Polygons, cell_faces, skin, without
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

FORMATS = (".vtu", ".vtk", ".xdmf", ".inp", ".msh")
"""File extensions that meshio reads for us."""
CORNERS = {"triangle": 3, "quad": 4, "tetra": 4, "pyramid": 5, "wedge": 6, "hexahedron": 8}
"""Corners of cells; curved ones list further nodes behind them."""
WITHOUT_AREA = ("vertex", "line", "empty")
TEXTURE = ("uv", "tcoords", "texcoords", "texture coordinates")
"""Names, in lower case, of point data that are texture coordinates."""
PHYSICAL, PANEL = "gmsh:physical", "panel"
"""Cell data that group faces: Gmsh's and our own."""


def read_mesh_file(path: Path, what: str, shape: Float | None = None) -> MeshFile:
    """Return the surface of a file of one of FORMATS.

    Groups of cells become panels: Gmsh's physical surfaces, Abaqus' element sets, or cell data called
    "panel". Point data called "uv" are texture coordinates. Faces are numbered as the file's cells, from 0.

    Parameters
    ----------
    path
        The file.
    what
        What it holds, for messages: "the body", say.
    shape
        Positions by which polygons are split, or None for the file's own; see `Surface.from_polygons`.

    Raises
    ------
    InputError
        If the file cannot be read, or holds no surface or cells that have no meaning here.
    """
    mesh, notes = _read(path, what)
    points = np.asarray(mesh.points, dtype=np.float64)
    if points.ndim == 2 and points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    if points.ndim != 2 or points.shape[1] != 3 or not len(points):
        raise InputError(f"{path}: holds no points in space; export {what} again")
    polygons = _polygons(path, mesh.cells, len(points), what, notes)
    corners = [corner for part in polygons for corner in part.corners.tolist()]
    if not corners:
        raise InputError(
            f"{path}: holds no surface (points and lines only, or nothing); export {what} as a surface mesh"
        )
    cell = np.concatenate([part.cell for part in polygons])
    uv = _texture(mesh.point_data, len(points))
    panel, names = _panels(mesh, cell)
    surface = Surface.from_polygons(
        positions=np.ascontiguousarray(points),
        corners=corners,
        uv=uv,
        uv_corners=corners if len(uv) else [[-1] * len(corner) for corner in corners],
        panel=panel,
        shape=shape,
    )
    surface = _without_collapsed(surface, np.array([len(corner) for corner in corners]))
    surface = replace(
        surface, file_face=cell[surface.file_face].astype(np.int32),
        attributes=node_attributes(mesh.point_data, len(points)),
    )  # fmt: skip
    return MeshFile(surface.with_panel_names(names), tuple(notes))


def _read(path: Path, what: str) -> tuple[Any, list[str]]:
    """Return meshio's mesh and what meshio said."""
    import meshio

    readers: dict[str, Callable[[str], Any]] = {
        ".vtu": meshio.vtu.read, ".vtk": meshio.vtk.read, ".xdmf": meshio.xdmf.read,
        ".inp": meshio.abaqus.read, ".msh": meshio.gmsh.read,
    }  # fmt: skip
    kind = path.suffix.lower()
    said = io.StringIO()
    try:
        # Readers are called by name: meshio.read prints its errors and ends the process.
        with redirect_stdout(said), redirect_stderr(said), warnings.catch_warnings():
            # Numbers that end too early are an error, not a shorter list.
            warnings.filterwarnings("error", message="string or file could not be read")
            mesh = readers[kind](str(path))
    except ModuleNotFoundError as error:
        raise InputError(
            f"{path}: {kind} files need {error.name} (pip install 'toile[xdmf]'); or export {what} as .vtu"
        ) from None
    except (Exception, SystemExit) as error:  # meshio raises whatever its parsers stumble over
        reason = " ".join(str(error).split())
        if not isinstance(error, meshio.ReadError):
            reason = f"{type(error).__name__} {reason}"
        reason = reason.strip() or "not what it says"
        raise InputError(f"{path}: cannot be read as {kind} ({reason}); export {what} again") from error
    text = " ".join(said.getvalue().split())
    return mesh, [text] if text else []


def _polygons(path: Path, blocks: list[Any], count: int, what: str, notes: list[str]) -> list[Polygons]:
    """Return the faces of all cells that have area; what was left out is added to the notes."""
    flat: list[Polygons] = []
    solid: list[Polygons] = []
    left_out: dict[str, int] = {}
    curved: set[str] = set()
    start = 0
    for block in blocks:
        found = re.match(r"[a-z]+", block.type)
        kind = found.group() if found else ""
        cell = np.arange(start, start + len(block.data), dtype=np.int64)
        start += len(block.data)
        if not len(cell):
            continue
        if kind in WITHOUT_AREA:
            left_out[kind] = left_out.get(kind, 0) + len(cell)
            continue
        if kind not in ("polygon", "pixel", *CORNERS):
            raise InputError(
                f"{path}: holds cells of kind '{block.type}', which are not read; export {what} as triangles"
            )
        nodes: Cells = np.asarray(block.data, dtype=np.int64)
        outside = np.flatnonzero(((nodes < 0) | (nodes >= count)).any(axis=1))
        if len(outside):
            raise InputError(
                f"{path}: cell {cell[outside[0]]} refers to a point that does not exist; export {what} again"
            )
        if nodes.shape[1] > CORNERS.get(kind, nodes.shape[1]):
            curved.add(block.type)
        if kind == "pixel":
            nodes = nodes[:, [0, 1, 3, 2]]
        corners = nodes[:, : CORNERS.get(kind, nodes.shape[1])]
        if kind in CELL_FACES:
            solid += cell_faces(kind, corners, cell)
        else:
            flat.append(Polygons(corners, cell))
    if left_out:
        listed = ", ".join(f"{number} of kind {kind}" for kind, number in sorted(left_out.items()))
        notes.append(f"Cells without area were left out: {listed}.")
    if curved:
        notes.append(f"Curved cells were read by their corners: {', '.join(sorted(curved))}.")
    if solid:
        notes.append("Volume cells were read by their surface.")
    return [*(without(part, solid) for part in flat), *skin(solid)]


def _texture(point_data: dict[str, Any], count: int) -> Float:
    """Return texture coordinates of points, shape (n, 2), or none, (0, 2)."""
    for name, values in point_data.items():
        array = np.asarray(values)
        if (
            name.lower() in TEXTURE
            and array.ndim == 2
            and array.shape[0] == count
            and array.shape[1] in (2, 3)
        ):
            uv = np.ascontiguousarray(array[:, :2], dtype=np.float64)
            if np.isfinite(uv).all():
                return uv
    return np.empty((0, 2))


def _panels(mesh: Any, cell: Cells) -> tuple[Int, tuple[str, ...]]:
    """Return the panel of every polygon, `cell` (n,) of which are the cells, and the names of the panels."""
    sizes = [len(block.data) for block in mesh.cells]
    names = {
        int(tag[0]): str(name) for name, tag in mesh.field_data.items() if np.size(tag) == 2 and tag[1] == 2
    }
    for key in (PHYSICAL, PANEL):
        blocks = mesh.cell_data.get(key)
        if blocks is None or (key == PHYSICAL and not names):
            continue
        values = np.concatenate([np.asarray(block).ravel() for block in blocks])
        if len(values) == sum(sizes) and np.array_equal(values, np.rint(values)):
            break
    else:
        values, names = _sets(mesh.cell_sets, sizes)
        key = ""
    used, panel = np.unique(values[cell].astype(np.int64), return_inverse=True)
    known = {} if key == PANEL else names
    fallback = "panel_{}" if len(used) > 1 else ""
    return panel.reshape(-1).astype(np.int32), tuple(
        known.get(number, fallback.format(number)) for number in used.tolist()
    )


def _sets(cell_sets: dict[str, Any], sizes: list[int]) -> tuple[Cells, dict[int, str]]:
    """Return the smallest set that every cell lies in, shape (n,), 0 for none, and the sets' names.

    A set of all elements, which most files have, thus does not hide the others.
    """
    starts = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    members: list[tuple[str, Cells]] = []
    for name, parts in cell_sets.items():
        if name.startswith("gmsh:"):
            continue
        rows: list[Cells] = []
        for block, part in enumerate(parts[: len(sizes)]):
            inside = np.asarray([] if part is None else part)
            if inside.ndim == 1 and inside.dtype.kind in "iuf":
                inside = inside.astype(np.int64)
                rows.append(starts[block] + inside[(inside >= 0) & (inside < sizes[block])])
        held = np.concatenate([np.empty(0, np.int64), *rows])
        if len(held):
            members.append((str(name), held))
    owner = np.zeros(int(starts[-1]), dtype=np.int64)
    order = sorted(range(len(members)), key=lambda index: -len(members[index][1]))
    for index in order:
        owner[members[index][1]] = index + 1
    return owner, {index + 1: name for index, (name, _) in enumerate(members)}


def _without_collapsed(surface: Surface, sizes: Cells) -> Surface:
    """Return the surface without triangles of larger polygons that repeat a node.

    Solvers write triangles as quads with a doubled corner. `sizes` (n,) are the corners of every polygon.
    """
    a, b, c = surface.faces.T
    kept = (sizes[surface.file_face] == 3) | ((a != b) & (b != c) & (c != a))
    return surface.with_faces(kept)
