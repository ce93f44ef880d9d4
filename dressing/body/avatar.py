"""The body that garments are put on: one watertight surface in metres, Y up."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from toile.dressing.body.avatar_repair import repaired_surface
from toile.dressing.body.avatar_units import METRES_PER_UNIT, recognise_frame, upright
from toile.dressing.files.corner_surface import Surface
from toile.dressing.files.read_surface import FORMATS, GLTF, read_surface
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError, about


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
        The file: OBJ, PLY, STL, GLB, GLTF, VTU, VTK, XDMF, Abaqus .inp or Gmsh .msh. Of glTF it is the pose
        at rest: bones, morph weights and instances count as a viewer shows them.
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
    is_gltf = extension in GLTF
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


def read_triangles(path: Path, shape: Float | None = None) -> tuple[Float, Int, tuple[str, ...]]:
    """Vertices (v, 3) in file units, without unused ones, and faces (f, 3) of everything in a file; notes.

    `shape` are all positions by which polygons are split, see `read_surface`.
    """
    surface, notes = read_surface(path, "the body", shape)
    return *used_triangles(path, surface), notes


def used_triangles(path: Path, surface: Surface) -> tuple[Float, Int]:
    """Vertices (v, 3) of a surface that faces use, and faces (f, 3).

    Raises InputError if there are none or some are not finite.
    """
    if not len(surface.faces):
        raise InputError(
            f"{path}: holds no triangles (an empty mesh or a point cloud); export the body as a surface mesh",
            file=path,
        )
    used, renumbered = np.unique(surface.faces, return_inverse=True)
    vertices = np.ascontiguousarray(surface.positions[used])
    bad_rows = np.flatnonzero(~np.isfinite(vertices).all(axis=1))
    if len(bad_rows):
        raise InputError(
            f"{path}: {len(bad_rows)} vertices have NaN or infinite coordinates (first: vertex "
            f"{used[bad_rows[0]]}); clean the mesh and export it again",
            file=path,
        )
    return vertices, np.ascontiguousarray(renumbered.reshape(-1, 3), dtype=np.int32)
