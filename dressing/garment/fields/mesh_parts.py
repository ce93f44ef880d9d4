"""Garments with fields, elastic, gas and holds: meshed along their borders, and marked."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.garment.fields.closure_points import fastening_of
from toile.dressing.garment.fields.cut_mesh import Level
from toile.dressing.garment.fields.field import Field, FieldValue, Hold, Painted, Parts, Textured
from toile.dressing.garment.fields.layer import Layer, Layers
from toile.dressing.garment.fields.patch import patched
from toile.dressing.garment.fields.places import cuts_of, levels_of
from toile.dressing.garment.fields.read_png import read_brightness
from toile.dressing.garment.fields.runs import run_sides
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.pattern import Pattern
from toile.dressing.pattern.sewing_edges import SewingEdges
from toile.engine.cloth.fields.edge_runs import EdgeRun, border_sides
from toile.engine.cloth.fields.fields import Fields, Value
from toile.engine.cloth.fields.gas import Gas
from toile.engine.cloth.fields.paintings import ImagePainting, VertexPainting
from toile.engine.cloth.fields.timed_pins import RunHold
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import connected
from toile.geometry.errors import InputError

NO_LINES = np.empty((0, 2, 3))
Levels = Mapping[str, Level]


def mesh_with_parts(pattern: Pattern, parts: Parts, edges: SewingEdges, fps: float) -> GarmentMesh:
    """Return the mesh of a pattern, cut along the borders of its fields, with all its parts.

    `fps` are the frames per second of the film. Raises InputError if a part names what is not there.
    """
    if not parts:
        return mesh_pattern(pattern, edge_length=edges.length, curve_edge_length=edges.curves)
    lines: dict[str, list[Level]] = {}
    with _named(pattern.name):
        _check_panels(parts, tuple(panel.name for panel in pattern.panels))
        regions: list[Field | Layer] = [*parts.fields, *parts.layers]
        levels = [levels_of(one, pattern) for one in regions]
        for of_panels in levels:
            for name, level in of_panels.items():
                lines.setdefault(name, []).append(level)
        cuts = cuts_of(parts, levels, pattern)
    mesh = mesh_pattern(
        pattern, edge_length=edges.length, curve_edge_length=edges.curves, cuts=cuts or None, lines=lines
    )
    with _named(mesh.name):
        return with_parts(mesh, parts, levels, fps)


@contextmanager
def _named(garment: str) -> Iterator[None]:
    """Put the name of a garment in front of errors raised inside."""
    try:
        yield
    except InputError as error:
        raise error.at(f"garment '{garment}'", garment=garment) from None


def with_parts(mesh: GarmentMesh, parts: Parts, levels: list[dict[str, Level]], fps: float) -> GarmentMesh:
    """Return a mesh with its parts; `levels` of fields and layers, by panel, say which faces lie within."""
    elastic = [
        (EdgeRun(garment=0, panel=panel, lines=NO_LINES, rest=one.rest, stiffness=one.stiffness), sides)
        for one in parts.elastic
        for panel, sides in run_sides(one.run, mesh).items()
    ]
    holds: list[tuple[RunHold, Int | None]] = []
    for hold in parts.holds:
        places: dict[int, Int | None] = {mesh.panel_names.index(name): None for name in hold.panels}
        if hold.run is not None:
            places.update(run_sides(hold.run, mesh))
        share = hold.shares(fps)
        for panel, there in places.items():
            one = RunHold(
                garment=0, panel=panel, lines=None, share=share, stiffness=hold.stiffness, follow=hold.follow
            )
            holds.append((one, there))
    mesh = replace(mesh, elastic=tuple(elastic), holds=tuple(holds))
    if parts.gas is not None:
        _check_closed(mesh)
        mesh = replace(mesh, gas=(Gas(garment=0, pressure=parts.gas.pressure, volume=parts.gas.volume),))
    if parts.closures:
        mesh = replace(mesh, fastenings=tuple(fastening_of(closure, mesh) for closure in parts.closures))
    if parts.patches:
        mesh = patched(mesh, parts.patches)
    if parts.layers:
        mesh = _with_layers(mesh, parts.layers, levels[len(parts.fields) :])
    return _with_fields(mesh, parts.fields, levels[: len(parts.fields)]) if parts.fields else mesh


def parts_on_mesh(mesh: GarmentMesh, parts: Parts, fps: float) -> GarmentMesh:
    """Return a garment that came as a mesh with its parts. Raises InputError if they need a pattern."""
    if not parts:
        return mesh
    with _named(mesh.name):
        _check_panels(parts, mesh.panel_names)
        regions: list[Field | Layer] = [*parts.fields, *parts.layers]
        for one in regions:
            if one.run is not None or one.polygon:
                what = "field" if isinstance(one, Field) else "layer"
                raise InputError(
                    f"{what}: bands and polygons need a pattern; of a mesh, paint vertices or name panels",
                    field="run" if one.run is not None else "polygon",
                )
        return with_parts(mesh, parts, [{} for _ in regions], fps)


def _check_panels(parts: Parts, known: tuple[str, ...]) -> None:
    """Raise InputError if a field, a layer or a hold names a panel that is not there."""
    named: list[Field | Layer | Hold] = [*parts.fields, *parts.layers, *parts.holds]
    for name in [name for one in named for name in one.panels]:
        if name not in known:
            raise InputError(f"panels: {unknown_name('panel', name, known)}", field="panels")


def _with_fields(mesh: GarmentMesh, fields: tuple[Field, ...], levels: list[dict[str, Level]]) -> GarmentMesh:
    """Return a mesh with a region for every combination of fields on a panel."""
    within = _all_within(mesh, fields, levels, "field")
    rows = np.column_stack([np.where(within.any(axis=1), mesh.panel + 1, 0), within])
    kinds, inverse = np.unique(rows, axis=0, return_inverse=True)
    region: Int = inverse.ravel().astype(np.int32)
    values: list[dict[str, Value]] = []
    pull = np.zeros(len(mesh.positions))
    for number, kind in enumerate(kinds.tolist()):
        own = region == number
        merged: dict[str, FieldValue] = {}
        for field, is_in in zip(fields, kind[1:], strict=True):
            merged.update(field.values if is_in else {})
        here = {name: _value(value, mesh, own) for name, value in merged.items()}
        pulled = here.pop("pull", None)
        if pulled is not None:
            _add_pull(pull, pulled, mesh, own)
        values.append(here)
    found = Fields(region=region, values=tuple(values))
    return replace(mesh, fields=found if found.names() else None, pull=pull if pull.any() else mesh.pull)


def _with_layers(mesh: GarmentMesh, layers: tuple[Layer, ...], levels: list[dict[str, Level]]) -> GarmentMesh:
    """Return a mesh with the stack of layers of every face."""
    within = _all_within(mesh, layers, levels, "layer")
    kinds, stack = np.unique(within, axis=0, return_inverse=True)
    stacks = tuple(
        tuple(layer for layer, is_in in zip(layers, kind, strict=True) if is_in) for kind in kinds.tolist()
    )
    return replace(mesh, layers=Layers(stack.ravel().astype(np.int32), stacks))


def _all_within(
    mesh: GarmentMesh, regions: Sequence[Field | Layer], levels: list[dict[str, Level]], what: str
) -> Bool:
    """Mark the faces of fields or layers, shape (t, k). Raises InputError if one has none."""
    within = np.stack([_within(mesh, one, on) for one, on in zip(regions, levels, strict=True)], axis=1)
    for one, own in zip(regions, within.T, strict=True):
        if not own.any():
            raise InputError(
                f"{what}: no part of the garment lies in it; check its width or polygon",
                field="polygon" if one.polygon else "width",
            )
    return within


def _within(mesh: GarmentMesh, field: Field | Layer, levels: Levels) -> Bool:
    """Mark the faces of a field or a layer, shape (t,)."""
    names = field.panels or mesh.panel_names
    own: Bool = np.isin(mesh.panel, [mesh.panel_names.index(name) for name in names])
    if field.run is None and not field.polygon:
        return own
    middle = mesh.uv[mesh.faces].mean(axis=1)
    inside = np.zeros(len(mesh.faces), bool)
    for name, level in levels.items():
        here = np.flatnonzero(mesh.panel == mesh.panel_names.index(name))
        inside[here] = level(middle[here]) < 0.0
    return own & inside


def _value(value: FieldValue, mesh: GarmentMesh, own: Bool) -> Value:
    """Return a value as the engine takes it, on the faces marked in `own`, shape (t,)."""
    if isinstance(value, Painted):
        if value.attribute not in mesh.attributes:
            known = list(mesh.attributes) or ["none in this garment"]
            raise InputError(f"field: {unknown_name('attribute', value.attribute, known)}", field="attribute")
        scaled = value.low + (value.high - value.low) * mesh.attributes[value.attribute]
        return VertexPainting(points=mesh.positions, faces=mesh.faces[own], values=scaled)
    if isinstance(value, Textured):
        bright = read_brightness(value.image) if isinstance(value.image, Path) else np.asarray(value.image)
        corners = mesh.uv[mesh.faces[own]].reshape(-1, 2)
        # One region is of one panel.
        whole = mesh.uv[mesh.faces[mesh.panel == mesh.panel[np.flatnonzero(own)[0]]]].reshape(-1, 2)
        box = value.box or (*whole.min(axis=0).tolist(), *whole.max(axis=0).tolist())
        if bright.ndim != 2 or not bright.size or not len(corners):
            raise InputError("field: an image has rows and columns of brightness", field="image")
        return ImagePainting(
            values=value.low + (value.high - value.low) * bright, low=(box[0], box[1]), high=(box[2], box[3])
        )
    return value


def _add_pull(pull: Float, value: Value, mesh: GarmentMesh, own: Bool) -> None:
    """Set how hard vertices of marked faces are drawn to their places [N/m^3], shape (m,)."""
    if mesh.flat:
        raise InputError(
            "field: pull draws a mesh to where it starts; panels start flat, use a hold instead", field="pull"
        )
    vertices: Int = np.unique(mesh.faces[own])
    if isinstance(value, VertexPainting):
        pull[vertices] = value.values[vertices]
    elif isinstance(value, float | int):
        pull[vertices] = value
    else:
        raise InputError("field: pull is a number, or painted on vertices", field="pull")


def _check_closed(mesh: GarmentMesh) -> None:
    """Raise InputError if a garment has borders once it is sewn."""
    weld: Int = np.arange(len(mesh.positions), dtype=np.int32)
    if len(mesh.stitches):
        weld = connected(mesh.stitches, len(weld))
    sides, _ = border_sides(weld[mesh.faces])
    if len(sides):
        raise InputError(
            f"gas: {len(sides)} edges of the sewn garment are open, so that it holds no gas; close it, or "
            "set the pressure of a field",
            field="gas",
        )
