"""Reads the surface of a mesh file of any kind, the same for bodies and garments."""

from pathlib import Path

import numpy as np

from toile.dressing.files.corner_surface import MeshFile, Surface, triangle_surface
from toile.dressing.files.gltf.still_gltf import read_still_gltf
from toile.dressing.files.meshio_file import FORMATS as MESHIO_FORMATS
from toile.dressing.files.meshio_file import read_mesh_file
from toile.dressing.files.on_disk import is_file
from toile.dressing.files.read_obj import read_obj
from toile.dressing.files.read_ply import read_ply
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

GLTF = (".glb", ".gltf", ".vrm")
FORMATS = (".obj", ".ply", ".stl", *GLTF, *MESHIO_FORMATS)
"""File extensions that are read."""


def read_surface(path: Path, what: str, shape: Float | None = None) -> MeshFile:
    """Return the surface of a file of one of FORMATS in the file's units, glTF at rest, and notes.

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
        If the file is missing or cannot be read.
    """
    if not is_file(path):
        kind = {"the body": "avatar", "the obstacle": "obstacle"}.get(what, "garment")
        raise InputError(f"{path}: {kind} file not found; check the path", file=path)
    if not path.stat().st_size:
        raise InputError(f"{path}: the file is empty; export {what} again: it has no faces", file=path)
    extension = path.suffix.lower()
    if extension in MESHIO_FORMATS:
        return read_mesh_file(path, what, shape)
    if extension in GLTF:
        return read_still_gltf(path)
    if extension == ".stl":
        surface = _read_stl(path, what)
    else:
        surface = (read_obj if extension == ".obj" else read_ply)(path, shape)
    return MeshFile(surface, ())


def _read_stl(path: Path, what: str) -> Surface:
    """Return the triangles of an STL file, no two of which share a vertex."""
    import trimesh

    try:
        mesh = trimesh.load_mesh(path, process=False)
        faces = np.asarray(mesh.faces, dtype=np.int32).reshape(-1, 3)
        positions = np.asarray(mesh.vertices, dtype=np.float64).reshape(-1, 3)
    except Exception as error:  # trimesh raises whatever its parsers stumble over
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(
            f"{path}: cannot be read as a mesh ({reason}); export {what} again", file=path
        ) from error
    return triangle_surface(positions, faces)
