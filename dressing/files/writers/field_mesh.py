"""Garments with fields on them: VTU, legacy VTK, XDMF, Gmsh and Abaqus, written by meshio.

Fields live on a point per material vertex, since a seam has several pattern coordinates; the points of a seam
lie at the same place. Abaqus files hold no fields: their points are the nodes, sewn together.
"""

import io
import re
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.files.writers.atomic import replacing
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

FORMATS = ("vtu", "vtk", "xdmf", "msh", "inp")
"""Formats, which are also the file extensions."""
FILM_FORMATS = ("glb", "mdd")
"""Formats of films: all meshes in one animated file, vertices of a garment over time."""


@dataclass(frozen=True, kw_only=True)
class FieldMesh:
    """A surface with fields.

    Attributes
    ----------
    positions
        Nodes in the file's units, shape (n, 3).
    faces
        Triangles into positions, shape (t, 3).
    uv
        Pattern coordinates of material vertices [m], shape (m, 2), or None.
    uv_faces
        The same triangles into material vertices, shape (t, 3).
    panel, panel_names
        Panel of every face, shape (t,), and the panels' names.
    strain
        Strain along warp and weft of every face, shape (t, 2), or None.
    """

    positions: Float
    faces: Int
    uv: Float | None
    uv_faces: Int
    panel: Int
    panel_names: Sequence[str]
    strain: Float | None


def checked_formats(formats: Sequence[str]) -> tuple[str, ...]:
    """Return the formats, each once. Raises InputError for one that is unknown or lacks its library."""
    for name in formats:
        if name not in (*FORMATS, *FILM_FORMATS):
            raise InputError(f"formats: {unknown_name('format', str(name), (*FORMATS, *FILM_FORMATS))}")
        if name == "xdmf" and find_spec("h5py") is None:
            raise InputError("formats: xdmf needs h5py (pip install 'toile[xdmf]'); or take vtu")
    return tuple(dict.fromkeys(formats))


def write_field_mesh(path: Path, mesh: FieldMesh) -> Path:
    """Write a file of the format that its extension, one of FORMATS, says; return its path.

    Point data: `uv`, pattern coordinates [m] with a third component of 0, and `node`, which is the same for
    points that are sewn together. Cell data: `panel`, `strain_warp` and `strain_weft`. Gmsh files name the
    panels as physical surfaces, Abaqus files as element sets.
    """
    import meshio

    writers: dict[str, Callable[[Path, Any], None]] = {
        ".vtu": meshio.vtu.write,
        ".vtk": meshio.vtk.write,
        ".xdmf": lambda file, content: meshio.xdmf.write(file, content, data_format="XML"),
        ".msh": lambda file, content: meshio.gmsh.write(file, content, fmt_version="2.2"),
        ".inp": _write_abaqus,
    }
    content = _with_sets(mesh) if path.suffix == ".inp" else _with_fields(mesh, path.suffix == ".msh")
    with replacing(path) as temporary, redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        writers[path.suffix](temporary, content)
    return path


def _with_fields(mesh: FieldMesh, gmsh: bool) -> Any:
    """Return meshio's mesh with a point per material vertex."""
    import meshio

    count = int(mesh.uv_faces.max()) + 1 if mesh.uv is None else len(mesh.uv)
    node = np.zeros(count, dtype=np.int32)
    node[mesh.uv_faces] = mesh.faces
    point_data: dict[str, Any] = {"node": node}
    if mesh.uv is not None:
        point_data["uv"] = np.column_stack([mesh.uv, np.zeros(count)])
    cell_data: dict[str, list[Any]] = {"panel": [np.asarray(mesh.panel, np.int32)]}
    if mesh.strain is not None:
        for name, values in zip(("strain_warp", "strain_weft"), mesh.strain.T, strict=True):
            cell_data[name] = [np.ascontiguousarray(values)]
    names = {}
    if gmsh:
        cell_data["gmsh:physical"] = cell_data["gmsh:geometrical"] = [np.asarray(mesh.panel + 1, np.int32)]
        quoted = [name.replace('"', "'") for name in mesh.panel_names]
        names = {name: np.array([index + 1, 2]) for index, name in enumerate(quoted)}
    return meshio.Mesh(
        np.ascontiguousarray(mesh.positions[node]), [("triangle", np.asarray(mesh.uv_faces, np.int32))],
        point_data=point_data, cell_data=cell_data, field_data=names,
    )  # fmt: skip


def _with_sets(mesh: FieldMesh) -> Any:
    """Return meshio's mesh of the nodes, with a set of cells per panel."""
    import meshio

    sets: dict[str, list[Any]] = {}
    for index, name in enumerate(mesh.panel_names):
        # Names of sets are letters, digits and underscores, and begin with a letter.
        plain = re.sub(r"\W", "_", name, flags=re.ASCII)
        plain = plain if plain[:1].isalpha() else f"panel_{plain}"
        own = np.flatnonzero(mesh.panel == index)
        if len(own):
            sets[plain if plain not in sets else f"{plain}_{index}"] = [own]
    cells = [("triangle", np.asarray(mesh.faces, np.int32))]
    return meshio.Mesh(np.asarray(mesh.positions), cells, cell_sets=sets)


def _write_abaqus(file: Path, content: Any) -> None:
    """Write an Abaqus file of shell elements: meshio would make the triangles rigid facets."""
    import meshio

    meshio.abaqus.write(file, content)
    file.write_bytes(file.read_bytes().replace(b"TYPE=R3D3", b"TYPE=S3"))
