"""Garments as arrays in .npz files, for programs that have more to say than mesh files can hold."""

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from toile.dressing.files.corner_surface import Surface
from toile.dressing.files.npz_file import npz_arrays
from toile.dressing.files.surface_check import check_vertex_numbers, checked_surface
from toile.dressing.files.surface_mend import Birth, mended_surface
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.mesh_garment import garment_from_surface
from toile.dressing.pattern.garmentcode_roles import edge_role
from toile.dressing.pattern.roles import EdgeRole
from toile.engine.cloth.origin import Origin
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import connected_vertices
from toile.geometry.errors import InputError

HELD = "held_"
"""Begins the names of arrays of labelled vertices, such as held_lower_interface; labels are GarmentCode's."""
FIELD = "field_"
"""Begins the names of arrays of numbers per vertex, such as field_stiff, from which fields may be painted."""
PIN_STIFFNESS = 1000.0
"""Stiffness per area of pins of weight 1 that give way [N/m^3], unless the file has another.

The weight of poplin, 1.2 N/m^2, moves one of weight 0.5 by 2.4 mm.
"""
STIFFEST = 1e6
"""Largest such stiffness [N/m^3]: contact is twice as stiff."""
PLANE = 1e-3
"""How far vertices of a piece may lie from a plane for it to count as flat fabric [m]."""
SHAPES = {
    "vertices": (None, 3), "faces": (None, 3), "uv": (None, 2), "uv_faces": (None, 3), "panel": (None,),
    "polygon": (None,),
    "pins": (None,), "pin_stiffness": (), "stitches": (None, 2), "motion": (None, None, 3), "fps": (),
}  # fmt: skip

WHOLE: dict[str, tuple[str | None, str | None]] = {
    "faces": (None, "vertices"), "uv_faces": ("faces", "uv"), "panel": ("faces", None),
    "polygon": ("faces", None), "stitches": (None, "vertices"),
}  # fmt: skip
"""Arrays of whole numbers: the array that has as many rows, and the one whose rows they number."""


def read_npz_garment(path: Path, *, name: str, edge_length: float | None = None) -> GarmentMesh:
    """Return the garment of an .npz file [m], Y up.

    Parameters
    ----------
    path
        The file. It holds `vertices` (n, 3) and `faces` (t, 3), and perhaps: `uv` (p, 2) and `uv_faces`
        (t, 3), texture vertices of one vertex each, the corners that results refer to (else they are the
        vertices); `panel` (t,), a number for every face, the lines between which stay; `polygon` (t,), the
        number of every face in the program it comes from; `pins` (n,), weights from 0 to 1: vertices of
        weight 1 are held in place, others drawn to theirs by `pin_stiffness` [N/m^3] times their weight and
        their area; `stitches` (s, 2), pairs of vertices to be sewn together; `held_LABEL`, numbers of
        vertices on an edge of that label; `field_NAME` (n,), numbers from which fields are painted; `motion`
        (k, n, 3) and `fps`, where pins go while the avatar moves.
    name
        Name of the garment.
    edge_length
        Edges much longer than this [m] are split; None keeps the triangles. Midpoints of sewn edges are sewn
        to each other where both edges are split alike.

    Raises
    ------
    InputError
        If an array is missing or of another shape, and as for `read_mesh_garment`.
    """
    held = _read(path)
    vertices, faces = held["vertices"].astype(np.float64), held["faces"].astype(np.int32)
    check_vertex_numbers(path, faces, len(vertices), "export the garment again")
    uv = held.get("uv", np.zeros((len(vertices), 2))).astype(np.float64)
    uv_faces = held.get("uv_faces", faces).astype(np.int32)
    corner_vertex = np.zeros(len(uv), np.int32)
    corner_vertex[uv_faces] = faces
    piece = connected_vertices(faces, len(vertices))[faces[:, 0]]
    own = held.get("panel", np.zeros(len(faces))).astype(np.int32)
    used, panel = np.unique(np.stack([piece, own], axis=1), axis=0, return_inverse=True)
    surface = Surface(
        positions=vertices, faces=faces, uv=uv, uv_faces=uv_faces, panel=panel.ravel().astype(np.int32),
        panel_names=tuple(f"piece {number}" for number in range(len(used))),
        file_face=held.get("polygon", np.arange(len(faces))).astype(np.int32),
    )  # fmt: skip
    surface, notes, births = mended_surface(surface)
    if not len(surface.faces):
        raise InputError(f"{path}: no face has an area; export the garment again", file=path, field="faces")
    mesh = garment_from_surface(checked_surface(path, surface), name=name, edge_length=edge_length)
    assert mesh.origin is not None
    origin = _of_the_file(mesh.origin, births) if births else mesh.origin
    pins = _pins(path, held)
    labels = {
        key.removeprefix(HELD): _whole(origin, np.isin(corner_vertex, held[key]))
        for key in held
        if key.startswith(HELD)
    }
    mesh = replace(
        mesh,
        notes=notes,
        origin=origin,
        pinned=_whole(origin, pins[corner_vertex] == 1.0),
        pull=_pull(path, held, pins, origin, corner_vertex),
        held=labels,
        edges=_by_role(labels),
        motion=_motion(path, held, corner_vertex),
        attributes={
            key.removeprefix(FIELD): origin.at_vertices(held[key].astype(np.float64)[corner_vertex])
            for key in held
            if key.startswith(FIELD)
        },
    )
    stitches = held.get("stitches", np.empty((0, 2))).astype(np.int32)
    return _sewn(path, mesh, stitches, corner_vertex) if len(stitches) else mesh


def _of_the_file(origin: Origin, births: list[Birth]) -> Origin:
    """Return an origin by the corners of the file, from one with corners born in mending after these."""
    count = int(origin.first[-1]) - len(births)
    rows = [{corner: 1.0} for corner in range(count)]
    for a, b, share in births:
        row = {corner: (1.0 - share) * weight for corner, weight in rows[a].items()}
        for corner, weight in rows[b].items():
            row[corner] = row.get(corner, 0.0) + share * weight
        rows.append(row)
    entries = [(number, corner, weight) for number, row in enumerate(rows) for corner, weight in row.items()]
    rows_of, corners, weights = np.array(entries, np.float64).reshape(-1, 3).T
    place = (rows_of.astype(np.int64), corners.astype(np.int64))
    own = csr_array((weights, place), shape=(len(rows), count))
    return replace(origin, weights=csr_array(origin.weights @ own), first=np.array([0, count], np.int32))


def _by_role(labels: dict[str, Int]) -> dict[EdgeRole, Int]:
    """Return the vertices on edges by the roles that their labels have."""
    found: dict[EdgeRole, list[Int]] = {}
    for label, vertices in labels.items():
        role = edge_role(label)
        if role is not None:
            found.setdefault(role, []).append(vertices)
    return {role: np.unique(np.concatenate(vertices)) for role, vertices in found.items()}


def _read(path: Path) -> dict[str, Any]:
    """Return the arrays of the file, their shapes checked."""
    held = npz_arrays(path, "the garment")
    for name in ("vertices", "faces"):
        if name not in held:
            raise InputError(
                f"{path}: lacks the array `{name}`; it has {', '.join(sorted(held)) or 'none'}",
                file=path,
                field=name,
            )
    if ("uv" in held) != ("uv_faces" in held):
        raise InputError(
            f"{path}: `uv` and `uv_faces` belong together; give both or none", file=path, field="uv"
        )
    for name, array in held.items():
        wanted = (None,) if name.startswith((HELD, FIELD)) else SHAPES.get(name)
        if wanted is None:
            raise InputError(
                f"{path}: unknown array `{name}`; known are {', '.join(SHAPES)}, {HELD}LABEL and {FIELD}NAME",
                file=path,
                field=name,
            )
        fits = len(wanted) == array.ndim and all(
            want in (None, have) for want, have in zip(wanted, array.shape, strict=True)
        )
        if not fits or array.dtype.kind not in "biuf":
            raise InputError(
                f"{path}: `{name}` must hold numbers of shape {wanted}, has {array.shape}",
                file=path,
                field=name,
            )
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            raise InputError(
                f"{path}: `{name}` has NaN or infinite values; export the garment again",
                file=path,
                field=name,
            )
    for name, array in held.items():
        if name.startswith(FIELD) and len(array) != len(held["vertices"]):
            raise InputError(
                f"{path}: `{name}` has {len(array)} rows, but `vertices` has {len(held['vertices'])}",
                file=path,
                field=name,
            )
    if not len(held["faces"]):
        raise InputError(
            f"{path}: the mesh has no faces; export the garment as a surface mesh", file=path, field="faces"
        )
    for name in held:
        if name in WHOLE or name.startswith(HELD):
            held[name] = _whole_numbers(path, name, held)
    fps = held.get("fps")
    if fps is not None and not 0.0 < float(fps) < np.inf:
        raise InputError(f"{path}: fps must be greater than zero, got {fps}", file=path, field="fps")
    return held


def _whole_numbers(path: Path, name: str, held: dict[str, Any]) -> Any:
    """Return an array as whole numbers. Raises InputError if some are not, or name rows that do not exist."""
    array = held[name]
    if array.dtype.kind == "f" and not np.array_equal(array, np.rint(array)):
        raise InputError(f"{path}: `{name}` must hold whole numbers", file=path, field=name)
    rows, of = WHOLE.get(name, (None, "vertices"))
    if rows is not None and len(array) != len(held[rows]):
        raise InputError(
            f"{path}: `{name}` has {len(array)} rows, but `{rows}` has {len(held[rows])}",
            file=path,
            field=name,
        )
    if name == "faces":
        # Named by the face, with the other kinds of meshes.
        return array.astype(np.int64)
    most = np.iinfo(np.int32).max if of is None else len(held[of])
    if array.size and not (array.min() >= 0 and array.max() < most):
        what = "too large a number" if of is None else f"a row of `{of}` that does not exist"
        raise InputError(f"{path}: `{name}` has a negative number, or {what}", file=path, field=name)
    return array.astype(np.int64)


def _pins(path: Path, held: dict[str, Any]) -> Float:
    """Return the weight of every vertex as a pin, shape (n,)."""
    count = len(held["vertices"])
    pins = held.get("pins", np.zeros(count)).astype(np.float64)
    if len(pins) != count or ((pins < 0.0) | (pins > 1.0)).any():
        raise InputError(
            f"{path}: `pins` must hold a weight between 0 and 1 for every vertex", file=path, field="pins"
        )
    return np.asarray(pins)


def _pull(path: Path, held: dict[str, Any], pins: Float, origin: Origin, corner_vertex: Int) -> Float | None:
    """Return how hard material vertices are drawn to their places [N/m^3], shape (m,); None if none is."""
    stiffness = float(held.get("pin_stiffness", PIN_STIFFNESS))
    if not 0.0 <= stiffness <= STIFFEST:
        raise InputError(
            f"{path}: `pin_stiffness` must lie between 0 and {STIFFEST:g} N/m^3",
            file=path,
            field="pin_stiffness",
        )
    gives = (pins > 0.0) & (pins < 1.0)
    if not gives.any() or not stiffness:
        return None
    # Weights fall off towards vertices that are fixed or free, but nothing draws between those two.
    faces = held["faces"]
    near = np.zeros(len(pins), bool)
    near[faces[gives[faces].any(axis=1)].ravel()] = True
    return stiffness * origin.at_vertices(np.where(near, pins, 0.0)[corner_vertex])


def _motion(path: Path, held: dict[str, Any], corner_vertex: Int) -> VertexMotion | None:
    """Return where the corners go, or None."""
    if "motion" not in held:
        return None
    if "fps" not in held or held["motion"].shape[1] != len(held["vertices"]) or len(held["motion"]) < 2:
        raise InputError(
            f"{path}: `motion` needs `fps`, at least two frames, and a place for every vertex",
            file=path,
            field="motion",
        )
    return VertexMotion(frames=held["motion"].astype(np.float32)[:, corner_vertex], fps=float(held["fps"]))


def _whole(origin: Origin, marked: Bool) -> Int:
    """Return the material vertices that lie between marked corners only."""
    share = origin.at_vertices(marked.astype(np.float64))
    return np.flatnonzero(share > 1.0 - 1e-9).astype(np.int32)


def _sewn(path: Path, mesh: GarmentMesh, stitches: Int, corner_vertex: Int) -> GarmentMesh:
    """Return the garment with pairs of the file's vertices stitched, and what lies between them alike."""
    assert mesh.origin is not None
    weights = mesh.origin.weights
    at_vertex: dict[int, int] = {}
    on_edge: dict[tuple[int, int], dict[float, int]] = {}
    for number in range(len(mesh.positions)):
        row = slice(weights.indptr[number], weights.indptr[number + 1])
        corners, shares = corner_vertex[weights.indices[row]].tolist(), weights.data[row].tolist()
        if len(corners) == 1:
            at_vertex.setdefault(corners[0], number)
        elif len(corners) == 2:
            (a, share), (b, _) = sorted(zip(corners, shares, strict=True))
            on_edge.setdefault((a, b), {}).setdefault(round(share, 6), number)
    partners: dict[int, list[int]] = {}
    for a, b in stitches.tolist():
        if a not in at_vertex or b not in at_vertex:
            raise InputError(f"{path}: a sewing edge ends at vertex {a if a not in at_vertex else b}, "
                             "which has no face; remove it", file=path, field="stitches")  # fmt: skip
        partners.setdefault(a, []).append(b)
        partners.setdefault(b, []).append(a)
    pairs = [(at_vertex[a], at_vertex[b]) for a, b in stitches.tolist()]
    for (a, b), middles in on_edge.items():
        for c, d in product(partners.get(a, ()), partners.get(b, ())):
            other = on_edge.get((min(c, d), max(c, d)), {})
            for share, number in middles.items():
                across = other.get(share if c < d else round(1.0 - share, 6))
                if across is not None and number < across:
                    pairs.append((number, across))
    new = np.array(sorted(set(pairs)), np.int32)
    panel = np.zeros(len(mesh.positions), np.int32)
    panel[mesh.faces] = mesh.panel[:, None]
    sides, seam = np.unique(np.sort(panel[new], axis=1), axis=0, return_inverse=True)
    first = len(mesh.seam_names)
    names = tuple(f"{mesh.panel_names[a]} - {mesh.panel_names[b]}" for a, b in sides.tolist())
    return replace(
        mesh,
        stitches=np.concatenate([mesh.stitches, new]).astype(np.int32),
        seam=np.concatenate([mesh.seam, seam.ravel() + first]).astype(np.int32),
        seam_names=(*mesh.seam_names, *names),
        flat=all(_is_plane(mesh.positions[mesh.faces[mesh.panel == k].ravel()])
                 for k in range(len(mesh.panel_names))),
    )  # fmt: skip


def _is_plane(points: Float) -> bool:
    """Whether points, shape (n, 3), lie in a plane."""
    away = points - points.mean(axis=0)
    normal = np.linalg.svd(away.T @ away)[0][:, 2]
    return bool(np.abs(away @ normal).max() < PLANE)
