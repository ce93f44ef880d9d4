"""A 3-D mesh as a garment: the mesh is its own rest shape."""

from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.avatar_units import METRES_PER_UNIT, upright
from toile.dressing.body.place import ROOM, Place
from toile.dressing.files.corner_surface import Surface
from toile.dressing.files.meshio_file import FORMATS as MESHIO_FORMATS
from toile.dressing.files.on_disk import is_file
from toile.dressing.files.read_surface import read_surface
from toile.dressing.files.suggestion import unknown_name
from toile.dressing.files.surface_check import checked_surface, crowded_faces
from toile.dressing.files.surface_mend import mended_surface, named
from toile.dressing.garment.double_walls import as_layers
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.mesh_subdivision import subdivide
from toile.dressing.garment.trims import without_trims
from toile.engine.cloth.fields.paintings import VertexPainting
from toile.engine.cloth.origin import Origin
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError, about
from toile.geometry.normals import area_normals
from toile.remesh.adapt.transfer import descent

FORMATS = (".obj", ".ply", ".glb", ".gltf", ".npz", *MESHIO_FORMATS)
"""File extensions of mesh garments."""
FITS = 1.6
"""Misfit up to which the avatar's own units and axes are not doubted: 0.1 to 2.5 times its size."""
FARTHEST = 1e6
"""Vertices farther from the origin are none of a garment [m]."""
SPLIT_ABOVE = 1.4
"""An edge is split when longer than this many edge lengths: halves are then not below 0.7."""


def read_mesh_garment(
    path: str | Path,
    *,
    name: str | None = None,
    units: str | None = None,
    up: str | None = None,
    avatar: Avatar | None = None,
    place: Place = ROOM,
    edge_length: float | None = None,
    walls: int = 1,
    attributes: Collection[str] = (),
) -> GarmentMesh:
    """Return the garment of a mesh file of one of FORMATS, or of arrays in an .npz file.

    Doubled faces, faces without area and gaps between borders are mended, small shells (buttons) become
    rigid trims, and a mesh with thickness becomes one layer; notes say so.

    Parameters
    ----------
    path
        The file. Groups (OBJ), objects and materials (GLB, as it stands at rest) and groups of cells (see
        `read_mesh_file`) become panels. For .npz see `read_npz_garment`: it says more about a garment than
        meshes can, in metres and with Y up.
    name
        Name of the garment; None takes the file's.
    units, up
        "m", "dm", "cm" or "mm", and "y" or "z"; None tries the avatar's own first and takes what puts the
        garment on it.
    avatar
        The body the garment is made for, in its own frame; only used to recognise units and axes.
    place
        Where that body stands in the room of the garment's file: the garment comes with it.
    edge_length
        Edges much longer than this [m] are split; None keeps the file's triangles.
    walls
        How many layers the two walls of a mesh with thickness are: 1 or 2.
    attributes
        Names of the attributes of its vertices that are asked for.

    Raises
    ------
    InputError
        If the file is missing, unreadable, empty, or has NaN coordinates or a surface with one side; faces
        are named by their number in the file, from 0.
    """
    path = Path(path)
    if path.suffix.lower() not in FORMATS:
        raise InputError(
            f"{path}: unknown garment format '{path.suffix}'; use .json, {', '.join(FORMATS)}", file=path
        )
    if path.suffix.lower() == ".npz":
        if not is_file(path):
            raise InputError(f"{path}: garment file not found; check the path", file=path)
        from toile.dressing.garment.npz_garment import read_npz_garment

        garment = read_npz_garment(path, name=name or path.stem, edge_length=edge_length)
        return moved_in(garment, place)
    surface, notes = read_surface(path, "the garment")
    if not len(surface.faces):
        raise InputError(f"{path}: the mesh has no faces; export the garment as a surface mesh", file=path)
    bad = np.flatnonzero(~np.isfinite(surface.positions).all(axis=1))
    if len(bad):
        raise InputError(
            f"{path}: {len(bad)} vertices are not finite (first: {bad[0]}); repair the mesh", file=path
        )
    metres = _in_metres(path, surface.positions, units, up, avatar, place)
    _check_size(path, metres)
    read = surface = replace(surface, positions=metres)
    surface, mended, _ = mended_surface(surface)
    if not len(surface.faces):
        raise InputError(f"{path}: no face has an area; export the garment again", file=path)
    surface, trims, with_trims = without_trims(surface)
    surface = checked_surface(path, surface)
    surface, thickness, walled = as_layers(surface, walls)
    if walled:
        surface = checked_surface(path, surface)
    sewn_on = crowded_faces(surface.faces)
    joined = (f"{named(sewn_on)} sewn on: more than two meet at an edge",) if len(sewn_on) else ()
    with about(file=path):
        garment = garment_from_surface(surface, name=name or path.stem, edge_length=edge_length)
    return replace(
        garment, trims=trims, thickness=thickness, notes=(*notes, *mended, *with_trims, *walled, *joined),
        attributes=_attributes_at(garment.positions, read, attributes),
    )  # fmt: skip


def _attributes_at(points: Float, read: Surface, names: Collection[str]) -> dict[str, Float]:
    """Return attributes of a surface as it was read [m] at points on it, (n, 3), by their names.

    Raises InputError if it has none of a name.
    """
    found: dict[str, Float] = {}
    for name in names:
        if name not in read.attributes:
            known = list(read.attributes) or ["none in this file"]
            raise InputError(unknown_name("attribute", name, known), field="attribute")
        painting = VertexPainting(points=read.positions, faces=read.faces, values=read.attributes[name])
        found[name] = painting.at(points)
    return found


def _check_size(path: Path, metres: Float) -> None:
    """Raise InputError if a vertex lies beyond reason: squares of its coordinates would overflow."""
    far = np.flatnonzero((np.abs(metres) > FARTHEST).any(axis=1))
    if len(far):
        raise InputError(
            f"{path}: vertex {far[0]} lies {np.abs(metres[far[0]]).max():.3g} m from the origin; repair the "
            "mesh, or check its units",
            file=path,
        )


def moved_in(garment: GarmentMesh, place: Place) -> GarmentMesh:
    """Return a garment that is in the room of its file in the frame of the body that stands there."""
    if place.is_own:
        return garment
    return replace(garment, positions=place.inward(garment.positions), motion=place.moved_in(garment.motion))


def garment_from_surface(surface: Surface, *, name: str, edge_length: float | None = None) -> GarmentMesh:
    """Return the garment whose rest shape is a checked surface [m], refined to an edge length [m].

    Raises InputError if that takes more triangles than any garment has.
    """
    has_uv = len(surface.uv) > 0 and bool((surface.uv_faces >= 0).all())
    uv_faces = surface.uv_faces if has_uv else surface.faces
    span = int(uv_faces.max()) + 1
    keys, corner = np.unique(surface.faces.astype(np.int64) * span + uv_faces, return_inverse=True)
    node = (keys // span).astype(np.int32)
    uv = surface.uv[keys % span] if has_uv else np.zeros((len(keys), 2))
    faces = corner.reshape(-1, 3).astype(np.int32)
    positions, panel, face = surface.positions, surface.panel, surface.file_face
    births: list[Int] = []
    if edge_length is not None:
        try:
            positions, uv, node, faces, parent, births = subdivide(
                positions, uv, node, faces, longest=SPLIT_ABOVE * edge_length
            )
        except InputError as error:
            raise error.at(f"garment '{name}'", garment=name) from None
        panel, face = panel[parent], face[parent]
    corners = positions[node[faces]]
    stitches = _same_node_pairs(node)
    return GarmentMesh(
        name=name,
        positions=np.ascontiguousarray(positions[node]),
        uv=np.ascontiguousarray(uv),
        faces=faces,
        panel=np.ascontiguousarray(panel, dtype=np.int32),
        panel_names=surface.panel_names,
        rest_corners=flattened(corners, warp_directions(corners, uv[faces] if has_uv else None)),
        stitches=stitches,
        seam=np.zeros(len(stitches), dtype=np.int32),
        seam_names=("texture seams",) if len(stitches) else (),
        flat=False,
        minimum_angle=minimum_angle(corners),
        origin=_origin(keys % span, len(surface.uv), births, face) if has_uv else None,
    )


def _origin(corner: npt.NDArray[np.int64], count: int, births: list[Int], face: Int) -> Origin:
    """Return what material vertices come from: the first from a corner of `count` each, then `births`."""
    own = csr_array((np.ones(len(corner)), (np.arange(len(corner)), corner)), shape=(len(corner), count))
    total = len(corner) + sum(map(len, births))
    return Origin(
        weights=csr_array(descent(births, len(corner), np.ones(total, bool)) @ own), face=face,
        first=np.array([0, count], np.int32),
    )  # fmt: skip


def warp_directions(corners: Float, uv: Float | None) -> Float:
    """Warp direction in each face, unit vectors of shape (t, 3).

    Lines of constant u are warp threads: the direction is dX/dv. Without texture coordinates, or where they
    are degenerate, it is the vertical projected into the face (in horizontal faces, the front direction).
    """
    normals = area_normals(corners)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    along = np.array((0.0, 1.0, 0.0)) - normals * normals[:, 1:2]
    horizontal = np.linalg.norm(along, axis=1) < 0.1
    along[horizontal] = (np.array((0.0, 0.0, 1.0)) - normals * normals[:, 2:3])[horizontal]
    if uv is not None:
        edges = corners[:, 1:] - corners[:, :1]
        d = uv[:, 1:] - uv[:, :1]
        area = d[:, 0, 0] * d[:, 1, 1] - d[:, 0, 1] * d[:, 1, 0]
        tangent = np.sign(area)[:, None] * (d[:, 0, :1] * edges[:, 1] - d[:, 1, :1] * edges[:, 0])
        size = np.linalg.norm(tangent, axis=1)
        good = size > 1e-9 * np.abs(edges).max() * max(float(np.abs(d).max()), 1e-30)
        along[good] = tangent[good]
    return np.asarray(along / np.linalg.norm(along, axis=1, keepdims=True))


def flattened(corners: Float, warp: Float) -> Float:
    """Each face laid flat, corner 0 at the origin and the warp along axis 0, shape (t, 3, 2)."""
    edges = corners[:, 1:] - corners[:, :1]
    normals = np.cross(edges[:, 0], edges[:, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    weft = np.cross(normals, warp)
    flat = np.zeros((len(corners), 3, 2))
    flat[:, 1:, 0] = np.einsum("tij,tj->ti", edges, warp)
    flat[:, 1:, 1] = np.einsum("tij,tj->ti", edges, weft)
    return flat


def minimum_angle(corners: Float) -> float:
    """Return the smallest angle of any triangle [degrees]."""
    sides = np.roll(corners, -1, axis=1) - corners
    sides /= np.linalg.norm(sides, axis=2, keepdims=True)
    cosine = -np.einsum("tij,tij->ti", sides, np.roll(sides, 1, axis=1))
    return float(np.degrees(np.arccos(np.clip(cosine.max(), -1.0, 1.0))))


def _same_node_pairs(node: Int) -> Int:
    """Pairs of material vertices that are one node, shape (s, 2): the first with each of the others."""
    order = np.argsort(node, kind="stable")
    _, first = np.unique(node[order], return_index=True)
    leader = order[first][node]
    other = np.flatnonzero(leader != np.arange(len(node)))
    return np.column_stack([leader[other], other]).astype(np.int32)


def _in_metres(
    path: Path, positions: Float, units: str | None, up: str | None, avatar: Avatar | None, place: Place
) -> Float:
    """Positions [m], in the body's frame, in the first unit and axis that put the garment on the avatar."""
    if units is not None and units not in METRES_PER_UNIT:
        raise InputError(
            f"{path}: unknown unit '{units}'; give one of {', '.join(METRES_PER_UNIT)}",
            file=path,
            field="units",
        )
    if up is not None and up not in ("y", "z"):
        raise InputError(f"{path}: unknown up axis '{up}'; give y or z", file=path, field="up")
    own = (avatar.metres_per_unit, avatar.up_axis) if avatar else (1.0, "y")
    every = [own, *((scale, axis) for axis in ("y", "z") for scale in METRES_PER_UNIT.values())]
    placed = [
        place.inward(upright(positions, axis) * scale)
        for scale, axis in every
        if (units is None or scale == METRES_PER_UNIT[units]) and (up is None or axis == up)
    ]
    if avatar is None or _misfit(placed[0], avatar.vertices) < FITS:
        return placed[0]
    best = min(placed, key=lambda candidate: _misfit(candidate, avatar.vertices))
    # What fits in no unit stays as it is: shrunk until it lies within the body, it would not be missed.
    return best if _misfit(best, avatar.vertices) < FITS else placed[0]


def _misfit(garment: Float, body: Float) -> float:
    """How badly a garment fits a body: 0 if centred within its box and about half its size."""
    low, high = body.min(axis=0), body.max(axis=0)
    centre = 0.5 * (garment.min(axis=0) + garment.max(axis=0))
    outside = np.maximum(np.maximum(low - centre, centre - high), 0.0)
    size = float(np.linalg.norm(high - low))
    ratio = max(float(np.linalg.norm(np.ptp(garment, axis=0))), 1e-12) / size
    return float(abs(np.log(ratio / 0.5)) + 5.0 * np.linalg.norm(outside) / size)
