"""The body that garments are put on: one watertight surface in metres, Y up."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from toile.dressing.body.avatar_parts import body_faces
from toile.dressing.body.avatar_repair import closed_parts, crossing_notes, side_by_side, united
from toile.dressing.body.avatar_units import recognise_frame, upright
from toile.dressing.body.facing import front_of_axis, recognised_facing
from toile.dressing.body.reading import Reading
from toile.dressing.files.corner_surface import Surface
from toile.dressing.files.read_surface import FORMATS, GLTF, read_surface
from toile.dressing.files.unknown_format import unknown_format
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.forces.contact_pairs import SkinPart
from toile.geometry.arrays import Float, Int
from toile.geometry.by_value import ByValue
from toile.geometry.errors import InputError, about
from toile.geometry.given_arrays import floats, indices


@dataclass(frozen=True, kw_only=True, eq=False)
class Avatar(ByValue):
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
    front
        Angle about Y from +Z towards +X that it faces [degrees].
    solid
        Vertices and faces of one surface around it at the start, where `vertices` are shells that overlap.
    placed
        Whether it is in its own frame (see `Place`) and not wherever a file has it.
    repaired
        Whether toile has closed it and turned it outward: one that is made by hand is, when it is dressed.
    obstacles
        Vertices after those of the body that belong to obstacles beside it, in their order.

    Raises InputError if an array is of a wrong shape, not finite, or names what does not exist.
    """

    name: str
    vertices: Float
    faces: Int
    metres_per_unit: float = 1.0
    up_axis: Literal["y", "z"] = "y"
    notes: tuple[str, ...] = ()
    motion: VertexMotion | None = None
    front: float = 0.0
    solid: tuple[Float, Int] | None = None
    placed: bool = False
    repaired: bool = False
    obstacles: tuple[SkinPart, ...] = ()

    def __post_init__(self) -> None:
        """Take arrays of any numeric type."""
        vertices = floats(self.vertices, f"{self.name}: vertices", (None, 3), "vertices")
        faces = indices(self.faces, f"{self.name}: faces", (None, 3), len(vertices), "faces")
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", faces)
        if self.motion is not None and self.motion.frames.shape[1:] != vertices.shape:
            raise InputError(
                f"{self.name}: the motion is of {self.motion.frames.shape[1]} vertices, the body has "
                f"{len(vertices)}",
                field="motion",
            )

    @property
    def body_count(self) -> int:
        """Number of vertices of the body, which come first."""
        return self.obstacles[0].begin if self.obstacles else len(self.vertices)

    @property
    def alone(self) -> "Avatar":
        """The body without obstacles beside it."""
        if not self.obstacles:
            return self
        count = self.body_count
        motion = self.motion
        return replace(
            self, vertices=self.vertices[:count], faces=self.faces[(self.faces < count).all(axis=1)],
            motion=None if motion is None else replace(motion, frames=motion.frames[:, :count]),
            obstacles=(),
        )  # fmt: skip

    def to_source(self, positions: npt.ArrayLike) -> Float:
        """Positions in the source file's own units and axes, from positions [m], Y up, shape (n, 3)."""
        metres = np.asarray(positions, dtype=np.float64)
        turned = metres if self.up_axis == "y" else metres[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
        return np.ascontiguousarray(turned / self.metres_per_unit)


def load_avatar(
    path: str | Path, *, units: str | None = None, up: str | None = None, front: str | None = None,
    only: Sequence[str] = (), without: Sequence[str] = (),
) -> Avatar:  # fmt: skip
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
    front
        Axis of the file that the body faces, such as "-z"; None recognises it from trunk and feet.
    only, without
        Names of the parts that are the body, and of those that are not; wildcards may be used. A floor, hair,
        lashes, helpers and second copies of faces are recognised unless `only` is given.

    Raises
    ------
    InputError
        If the file is missing, of an unknown kind, holds no finite triangle mesh, is not the size of a
        body in any unit, or cannot be closed into a solid.
    """
    path = Path(path)
    reading = Reading(units=units, up=up, front=front, only=tuple(only), without=tuple(without))
    with about(file=path):
        reading.check(path.name)
        if path.suffix.lower() not in FORMATS:
            raise InputError(f"{path}: {unknown_format(path)}", file=path)
        surface, notes = read_surface(path, "the body")
        avatar = avatar_of(path, surface, reading)
        return replace(avatar, notes=(*notes, *avatar.notes))


def avatar_of(path: Path, surface: Surface, reading: Reading) -> Avatar:
    """Make an avatar of what a file holds: find the body, recognise its frame and repair it."""
    kept, said = body_faces(path.name, surface, reading.only, reading.without)
    vertices, faces = used_triangles(path, surface.positions, surface.faces[kept])
    return repaired_avatar(path, vertices, faces, reading, said, moves=False)


def repaired_avatar(
    path: Path, vertices: Float, faces: Int, reading: Reading, said: tuple[str, ...], *, moves: bool
) -> Avatar:
    """Make an avatar of the vertices of a body in file units and its faces.

    Parameters
    ----------
    path
        Its file, for messages and the name.
    vertices, faces
        Shapes (v, 3) and (f, 3).
    reading
        What is known of it.
    said
        Notes on how it was found.
    moves
        Whether it moves: shells that overlap then stay apart.
    """
    frame = recognise_frame(
        path.name, vertices, units=reading.units, up=reading.up, is_gltf=path.suffix.lower() in GLTF
    )
    metres = upright(vertices, frame.up_axis) * frame.metres_per_unit
    parts, repairs = closed_parts(path.name, metres, faces)
    solid, union = united(path.name, parts)
    shown, shells = side_by_side(path.name, parts) if moves else (solid, union)
    front, facing = _front(path.name, solid, reading.front, frame.up_axis)
    return Avatar(
        name=path.stem,
        vertices=shown[0],
        faces=shown[1],
        metres_per_unit=frame.metres_per_unit,
        up_axis=frame.up_axis,
        front=front,
        solid=solid if len(parts) > 1 and moves else None,
        notes=(*said, *frame.notes, *facing, *repairs, *shells, *crossing_notes(*solid)),
        repaired=True,
    )


def _front(file: str, solid: tuple[Float, Int], given: str | None, up: str) -> tuple[float, tuple[str, ...]]:
    """Return the angle that a body faces [degrees], as given or recognised, and what there is to say."""
    if given is not None:
        if given[-1] == up:
            raise InputError(f"{file}: a body whose up axis is {up} does not face {given}", field="front")
        return front_of_axis(given, up), ()
    found = recognised_facing(*solid)
    if not found.degrees:
        return 0.0, ()
    words = {90.0: "+X", -90.0: "-X", 180.0: "-Z"}
    towards = words.get(
        found.degrees,
        f"{abs(found.degrees):.0f} degrees from +Z towards {'+' if found.degrees > 0.0 else '-'}X",
    )
    how = "trunk and feet" if found.sure else "its trunk alone, so front and back may be wrong: give front"
    return found.degrees, (f"The body faces {towards}, Y up (recognised from {how}).",)


def used_triangles(path: Path, positions: Float, faces: Int) -> tuple[Float, Int]:
    """Vertices (v, 3) that faces (f, 3) use, and those faces.

    Raises InputError if there are none or some are not finite.
    """
    if not len(faces):
        raise InputError(
            f"{path}: holds no triangles (an empty mesh or a point cloud); export the body as a surface mesh",
            file=path,
        )
    used, renumbered = np.unique(faces, return_inverse=True)
    vertices = np.ascontiguousarray(positions[used])
    bad_rows = np.flatnonzero(~np.isfinite(vertices).all(axis=1))
    if len(bad_rows):
        raise InputError(
            f"{path}: {len(bad_rows)} vertices have NaN or infinite coordinates (first: vertex "
            f"{used[bad_rows[0]]}); clean the mesh and export it again",
            file=path,
        )
    return vertices, np.ascontiguousarray(renumbered.reshape(-1, 3), dtype=np.int32)
