"""The body that garments are put on: one watertight surface in metres, Y up."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import trimesh

from toile.dressing.body.avatar_repair import repaired_surface
from toile.dressing.body.avatar_units import METRES_PER_UNIT, recognise_frame, upright
from toile.dressing.files.meshio_file import FORMATS as MESHIO_FORMATS
from toile.dressing.files.meshio_file import read_mesh_file
from toile.dressing.files.surface_check import check_vertex_numbers
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError, about

FORMATS = (".obj", ".ply", ".stl", ".glb", ".gltf", *MESHIO_FORMATS)
"""File extensions that can hold an avatar."""


@dataclass(frozen=True, kw_only=True)
class Avatar:
    """A body as one watertight, outward-oriented collision surface.

    Attributes
    ----------
    name
        Name of the body, used for output files and nodes.
    vertices
        Positions [m], Y up, shape (v, 3); horizontally and vertically where the file has them.
    faces
        Triangles, counter-clockwise seen from outside, shape (f, 3).
    metres_per_unit
        Length of one unit of the source file [m].
    up_axis
        Axis of the source file that points up.
    notes
        What was recognised and repaired, one sentence each.
    motion
        How it moves from there, or None.
    """

    name: str
    vertices: Float
    faces: Int
    metres_per_unit: float = 1.0
    up_axis: Literal["y", "z"] = "y"
    notes: tuple[str, ...] = ()
    motion: VertexMotion | None = None

    def to_source(self, positions: npt.ArrayLike) -> Float:
        """Positions in the source file's own units and axes, from positions [m], Y up, shape (n, 3)."""
        metres = np.asarray(positions, dtype=np.float64)
        turned = metres if self.up_axis == "y" else metres[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
        return np.ascontiguousarray(turned / self.metres_per_unit)


def load_avatar(path: str | Path, *, units: str | None = None, up: str | None = None) -> Avatar:
    """Read a body from a file of one of FORMATS and repair it into one collision surface.

    Parameters
    ----------
    path
        The file: OBJ, PLY, STL, GLB, GLTF, VTU, VTK, XDMF, Abaqus .inp or Gmsh .msh.
    units
        "m", "dm", "cm" or "mm"; None recognises the unit from the size of the body.
    up
        "y" or "z"; None recognises it from the shape. A Z-up body that faces -Y (Blender's front view)
        comes out facing +Z: (x, y, z) becomes (x, z, -y).

    Raises
    ------
    InputError
        If the file is missing, of an unknown kind, holds no finite triangle mesh, is not the size of a
        body in any unit, or cannot be closed into a solid.
    """
    path = Path(path)
    with about(file=path):
        return _loaded(path, units, up)


def _loaded(path: Path, units: str | None, up: str | None) -> Avatar:
    """Return the avatar of a file."""
    extension = path.suffix.lower()
    checked_frame_words(path.name, units, up)
    if extension not in FORMATS:
        raise InputError(
            f"{path}: unknown avatar format {extension or '(no extension)'!r}; "
            f"export the body as one of {', '.join(FORMATS)}",
            file=path,
        )
    vertices, faces, notes = read_triangles(path)
    is_gltf = extension in (".glb", ".gltf")
    avatar = avatar_of(path.name, path.stem, vertices, faces, units=units, up=up, is_gltf=is_gltf)
    return replace(avatar, notes=(*notes, *avatar.notes))


def checked_frame_words(file: str, units: str | None, up: str | None) -> None:
    """Raise InputError if a unit or an up axis is none that is known."""
    if units is not None and units not in METRES_PER_UNIT:
        raise InputError(
            f"{file}: unknown unit {units!r}; give one of {', '.join(METRES_PER_UNIT)}", field="units"
        )
    if up is not None and up not in ("y", "z"):
        raise InputError(f'{file}: unknown up axis {up!r}; give "y" or "z"', field="up")


def avatar_of(
    file: str, name: str, vertices: Float, faces: Int, *, units: str | None, up: str | None, is_gltf: bool
) -> Avatar:
    """Make an avatar of a file's vertices, in file units, and faces: recognise its frame and repair it."""
    frame = recognise_frame(file, vertices, units=units, up=up, is_gltf=is_gltf)
    metres = upright(vertices, frame.up_axis) * frame.metres_per_unit
    vertices, faces, repairs = repaired_surface(file, metres, faces)
    return Avatar(
        name=name,
        vertices=vertices,
        faces=faces,
        metres_per_unit=frame.metres_per_unit,
        up_axis=frame.up_axis,
        notes=(*frame.notes, *repairs),
    )


def read_triangles(path: Path) -> tuple[Float, Int, tuple[str, ...]]:
    """Vertices (v, 3) in file units, without unused ones, and faces (f, 3) of everything in a file; notes."""
    if not path.is_file():
        raise InputError(f"{path}: avatar file not found; check the path", file=path)
    if not path.stat().st_size:
        raise InputError(f"{path}: the file is empty; export the body again", file=path)
    notes: tuple[str, ...] = ()
    if path.suffix.lower() in MESHIO_FORMATS:
        surface, notes = read_mesh_file(path, "the body")
        vertices, faces = surface.positions, surface.faces
    else:
        vertices, faces = _read_with_trimesh(path)
    used, renumbered = np.unique(faces, return_inverse=True)
    vertices = np.ascontiguousarray(vertices[used])
    bad_rows = np.flatnonzero(~np.isfinite(vertices).all(axis=1))
    if len(bad_rows):
        raise InputError(
            f"{path}: {len(bad_rows)} vertices have NaN or infinite coordinates (first: vertex "
            f"{used[bad_rows[0]]}); clean the mesh and export it again",
            file=path,
        )
    return vertices, np.ascontiguousarray(renumbered.reshape(-1, 3), dtype=np.int32), notes


def _read_with_trimesh(path: Path) -> tuple[Float, Int]:
    """Vertices (v, 3) in file units and faces (f, 3) of all meshes of a scene, placed as its nodes say."""
    # skip_materials: textures are of no use here, and a missing one must not stop a drape.
    options: dict[str, Any] = {"skip_materials": True} if path.suffix.lower() == ".obj" else {}
    try:
        scene = trimesh.load_scene(path, process=False, **options)
    except Exception as error:  # trimesh raises whatever its parsers stumble over
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(
            f"{path}: cannot be read as a mesh ({reason}); export the body again", file=path
        ) from error

    corners: list[Float] = []
    triangles: list[Int] = []
    count = 0
    for node in sorted(scene.graph.nodes_geometry):
        transform, geometry_name = scene.graph[node]
        mesh = scene.geometry[geometry_name]
        if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
            continue
        local = np.asarray(mesh.vertices, dtype=np.float64)
        identity = np.array_equal(transform, np.eye(4))
        # Files without transforms keep their coordinates bit by bit.
        placed = local if identity else local @ transform[:3, :3].T + transform[:3, 3]
        face = np.asarray(mesh.faces, dtype=np.int64)
        if np.linalg.det(transform[:3, :3]) < 0.0:
            face = face[:, ::-1]
        corners.append(placed)
        triangles.append((face + count).astype(np.int32))
        count += len(placed)
    if not triangles:
        raise InputError(
            f"{path}: holds no triangles (an empty mesh or a point cloud); export the body as a surface mesh",
            file=path,
        )

    vertices, faces = np.concatenate(corners), np.concatenate(triangles)
    check_vertex_numbers(path, faces, len(vertices), "export the body again")
    return vertices, faces
