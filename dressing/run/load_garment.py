"""Loading of a garment: its mesh placed about the body, its pins found and its warp turned."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.files.suggestion import unknown_name
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.mesh_garment import FORMATS as MESH_FORMATS
from toile.dressing.garment.mesh_garment import moved_in
from toile.dressing.garment.pattern_place import moved_to_body
from toile.dressing.garment.readers import is_registered, read_garment
from toile.dressing.garment.unplaced import placed_by_seams
from toile.dressing.pattern.drafts import built_in
from toile.dressing.pattern.drawn.place import placed_pattern
from toile.dressing.pattern.drawn.read_drawn import DRAWN_FORMATS, DrawnOptions, told_or_sure
from toile.dressing.pattern.fold_table import with_folds
from toile.dressing.pattern.garmentcode import check_pattern
from toile.dressing.pattern.pattern import Pattern
from toile.dressing.pattern.seam import read_seam
from toile.dressing.pattern.sewing_edges import SewingEdges
from toile.dressing.pattern.smpl_frame import on_the_floor
from toile.dressing.pattern.twisted_seams import check_twists
from toile.dressing.run.resolved_scene import ResolvedGarment
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError, about

STILL_FPS = 24.0
"""Frames per second where there is no film."""
LARGEST_DISTANCE = 0.5
"""A garment whose box is farther than this from the avatar's cannot be meant for it [m]."""
SAME_OVERLAP = 0.85
"""A pattern that covers this share of what it covers elsewhere is where its file means it to be."""
LARGEST_PANEL_DISTANCE = 1.5
"""The same for a single panel [m]: wide skirts start with panels 0.6 m away."""


def load_garment(garment: ResolvedGarment, form: DressForm, edges: SewingEdges) -> GarmentMesh:
    """Return the garment's mesh, its warp turned as asked for. Raises InputError naming what is wrong."""
    with about(garment=garment.name):
        with about(file=garment.source if isinstance(garment.source, Path) else None):
            mesh = replace(
                _mesh_of(garment, form, edges), name=garment.name, panel_fabrics=garment.panel_fabrics
            )
            for panel in garment.panel_fabrics:
                if panel not in mesh.panel_names:
                    said = unknown_name("panel", panel, mesh.panel_names)
                    raise InputError(f"garment '{mesh.name}', panel_fabrics: {said}", field="panel_fabrics")
            _check_place(mesh, form.avatar)
        return turn_warp(mesh, garment.warp_angle)


def pinned_vertices(mesh: GarmentMesh, pins: tuple[str | int, ...]) -> Int:
    """Return the material vertices that pins name. Raises InputError for an unknown label or number."""
    found = [np.empty(0, dtype=np.int32)]
    for pin in pins:
        if isinstance(pin, str):
            if pin not in mesh.held:
                labels = list(mesh.held) or ["none in this garment"]
                raise InputError(
                    f"garment '{mesh.name}', pins: {unknown_name('label', pin, labels)}",
                    field="pins",
                    garment=mesh.name,
                )
            found.append(mesh.held[pin].astype(np.int32))
        elif not 0 <= pin < len(mesh.positions):
            raise InputError(
                f"garment '{mesh.name}', pins: vertex {pin} is not in 0..{len(mesh.positions) - 1}",
                field="pins",
                garment=mesh.name,
            )
        else:
            found.append(np.array([pin], dtype=np.int32))
    return np.unique(np.concatenate(found)).astype(np.int32)


def turn_warp(mesh: GarmentMesh, angle: float | Mapping[str, float]) -> GarmentMesh:
    """Return the garment with its warp turned by an angle [degrees], for all panels or by panel name."""
    if isinstance(angle, Mapping):
        for panel in angle:
            if panel not in mesh.panel_names:
                raise InputError(
                    f"garment '{mesh.name}', warp_angle: {unknown_name('panel', panel, mesh.panel_names)}",
                    field="warp_angle",
                )
        per_panel = np.array([float(angle.get(panel, 0.0)) for panel in mesh.panel_names])
    else:
        per_panel = np.full(len(mesh.panel_names), float(angle))
    if not per_panel.any():
        return mesh
    turn = np.radians(per_panel)[mesh.panel]
    cosine, sine = np.cos(turn)[:, None], np.sin(turn)[:, None]
    warp, weft = mesh.rest_corners[..., 0], mesh.rest_corners[..., 1]
    # The axes turn counter-clockwise, so coordinates in them turn clockwise.
    turned: Float = np.stack([cosine * warp + sine * weft, cosine * weft - sine * warp], axis=-1)
    return replace(mesh, rest_corners=np.ascontiguousarray(turned))


def _mesh_of(garment: ResolvedGarment, form: DressForm, edges: SewingEdges) -> GarmentMesh:
    """Return the mesh of a checked source."""
    from toile.dressing.garment.fields.mesh_parts import mesh_with_parts, parts_on_mesh

    source, parts, fps = garment.source, garment.parts, _fps(form)
    if isinstance(source, GarmentMesh):
        _check_foldable(garment)
        _check_pattern_coordinates(source)
        return parts_on_mesh(moved_in(source, form.place), parts, fps)
    if isinstance(source, Path) and source.suffix.lower() in MESH_FORMATS:
        from toile.dressing.garment.mesh_garment import read_mesh_garment

        _check_foldable(garment)
        read = read_mesh_garment(
            source, units=garment.units, up=garment.up, avatar=form.avatar, place=form.place,
            edge_length=edges.length, walls=garment.walls, attributes=parts.attributes,
        )  # fmt: skip
        return parts_on_mesh(read, parts, fps)
    is_drawn = (
        isinstance(source, Path) and source.suffix.lower() in DRAWN_FORMATS and not is_registered(source)
    )
    if isinstance(source, Path) and is_drawn:
        found: Pattern | GarmentMesh = _drawn_pattern(source, garment, form)
    elif isinstance(source, Path | Pattern):
        found = read_garment(source) if isinstance(source, Path) else _checked(source)
        if isinstance(found, Pattern):
            found = on_the_floor(found, form.avatar.vertices)
    else:
        found = built_in(source, form.measurements)
    if isinstance(found, GarmentMesh):
        _check_foldable(garment)
        _check_pattern_coordinates(found)
        return parts_on_mesh(moved_in(found, form.place), parts, fps)
    if isinstance(garment.seams, tuple) and not is_drawn:
        found = with_seams(found, garment.seams)
    found = with_folds(found, garment.folds)
    if isinstance(source, Path | Pattern) and not is_drawn:
        if not (form.place.is_own or form.place.turn):
            mesh = mesh_with_parts(found, parts, edges, fps)
            if _lies_in_the_room(mesh, form):
                check_twists(found)
                return replace(moved_in(mesh, form.place), notes=found.notes)
        found = moved_to_body(placed_by_seams(found, form), form)
        check_twists(found)
        if not form.place.is_own:
            note = "The pattern was placed for a body that faces +Z above the origin, and goes with this one."
            found = replace(found, notes=(*found.notes, note))
    mesh = mesh_with_parts(found, parts, edges, fps)
    return replace(mesh, notes=found.notes)


def _check_foldable(garment: ResolvedGarment) -> None:
    """Raise InputError if a mesh is to be folded."""
    if garment.folds:
        raise InputError(
            f"garment '{garment.name}': folds are lines of a pattern's panels, and a mesh has none; "
            "leave them out",
            field="folds",
        )


def _fps(form: DressForm) -> float:
    """Frames per second of the film."""
    motion = form.avatar.motion
    return STILL_FPS if motion is None else motion.fps


def _lies_in_the_room(mesh: GarmentMesh, form: DressForm) -> bool:
    """Whether a pattern's file has it around the body where that stands in its own file.

    Patterns are made for a body that faces +Z above the origin; some for one in the place of the file.
    """
    room = moved_in(mesh, form.place)
    return _overlap(room, form.avatar) >= SAME_OVERLAP * _overlap(mesh, form.avatar)


def _overlap(mesh: GarmentMesh, avatar: Avatar) -> float:
    """Volume in which the boxes of a garment and of the avatar overlap [m3]."""
    low = np.maximum(mesh.positions.min(axis=0), avatar.vertices.min(axis=0))
    high = np.minimum(mesh.positions.max(axis=0), avatar.vertices.max(axis=0))
    return float(np.maximum(high - low, 0.0).prod())


def _checked(pattern: Pattern) -> Pattern:
    """Return a pattern that was made in memory. Raises InputError if it cannot be sewn."""
    check_pattern(pattern)
    return pattern


def _drawn_pattern(source: Path, garment: ResolvedGarment, form: DressForm) -> Pattern:
    """Return a pattern that is drawn without seams, sewn as told or as is sure, placed on the body."""
    options = DrawnOptions(
        size=garment.size, units=garment.units, allowance=garment.allowance, seams=garment.seams
    )
    said = told_or_sure(source, options)
    pattern = placed_pattern(said.drawn, form.measurements, said.places, said.worn)
    check_pattern(pattern)
    return pattern


def with_seams(pattern: Pattern, texts: tuple[str, ...]) -> Pattern:
    """Return a pattern with seams added. Raises InputError if one cannot be read or sewn."""
    with about(field="seams"):
        seams = tuple(read_seam(text, f"{pattern.name}: seams") for text in texts)
        added = replace(pattern, seams=(*pattern.seams, *seams))
        check_pattern(added)
    return added


def _check_pattern_coordinates(mesh: GarmentMesh) -> None:
    """Raise InputError if the pattern coordinates of flat fabric have not the lengths of its rest shape."""
    if not mesh.flat:
        return
    sides = np.roll(mesh.uv[mesh.faces], -1, axis=1) - mesh.uv[mesh.faces]
    rest = np.roll(mesh.rest_corners, -1, axis=1) - mesh.rest_corners
    given, wanted = np.linalg.norm(sides, axis=2), np.linalg.norm(rest, axis=2)
    wrong = (np.abs(given - wanted) > 1e-6 * wanted.max()).any(axis=1)
    if wrong.any():
        raise InputError(
            f"garment '{mesh.name}': sides of face {int(wrong.argmax())} differ in uv and rest_corners; "
            "uv of flat fabric are its pattern coordinates in metres (or set flat=False)",
            np.flatnonzero(wrong),
            field="source.uv",
        )


def _check_place(mesh: GarmentMesh, avatar: Avatar) -> None:
    """Raise InputError if the garment or a panel is nowhere near the avatar, or a piece shut up in it."""
    where = f"garment '{mesh.name}'"
    _check_near(where, mesh.positions, avatar.vertices, LARGEST_DISTANCE)
    for index, name in enumerate(mesh.panel_names):
        used = mesh.positions[mesh.faces[mesh.panel == index].ravel()]
        if len(used):
            with about(field=f"pattern.panels.{name}"):
                _check_near(f"{where}: panel '{name}'", used, avatar.vertices, LARGEST_PANEL_DISTANCE)
    if not mesh.flat:
        from toile.dressing.garment.inside_body import faces_inside

        inside = faces_inside(mesh, avatar)
        if len(inside):
            raise InputError(
                f"{where} has a piece that starts inside the body and nowhere comes out of it; move it out",
                faces=() if mesh.origin is None else mesh.origin.face[inside].tolist(),
            )


def _check_near(what: str, positions: Float, body: Float, limit: float) -> None:
    """Raise InputError if the box of some positions is farther from the body's box than the limit."""
    low, high = positions.min(axis=0), positions.max(axis=0)
    apart = np.maximum(np.maximum(low - body.max(axis=0), body.min(axis=0) - high), 0.0)
    distance = math.hypot(*apart)
    if distance > limit:
        axis = "xyz"[int(apart.argmax())]
        raise InputError(
            f"{what} is {distance:.3g} m away from the body (along {axis}); "
            "move it onto the body, or check the units and up axis of both"
        )
