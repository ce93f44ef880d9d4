"""Blender meshes as arrays: triangles, attributes, vertex groups, loose edges."""

from typing import Any

import numpy as np
import numpy.typing as npt

from toile.blender_addon.snapshot.carriers import Chosen
from toile.dressing.files.corner_surface import split_from_second
from toile.geometry.arrays import Float, Int

SAME = 1e-6
"""Difference of values at the corners of a vertex that is rounding."""
FIELDS = {
    "FLOAT": ("value", 1, np.float32), "INT": ("value", 1, np.int32), "BOOLEAN": ("value", 1, np.bool_),
    "FLOAT_VECTOR": ("vector", 3, np.float32), "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32), "BYTE_COLOR": ("color", 4, np.float32),
    "INT8": ("value", 1, np.int8), "QUATERNION": ("value", 4, np.float32),
}  # fmt: skip
"""Types of attributes that are carried: field, width and number."""
BUILT_IN = ("position", "velocity", "crease_vert", "crease_edge")
"""Attributes that belong to the shape or to other modifiers."""


def positions(mesh: Any) -> Float:
    """Local positions, shape (n, 3)."""
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", flat)
    return flat.reshape(-1, 3).astype(np.float64)


def loop_vertices(mesh: Any) -> Int:
    """Vertex of every loop, shape (l,)."""
    vertex = np.empty(len(mesh.loops), np.int32)
    # A hundred times as fast as by way of the loops.
    mesh.attributes[".corner_vert"].data.foreach_get("value", vertex)
    return vertex


def triangles(mesh: Any) -> tuple[Int, Int, Int]:
    """Vertices and loops of the triangles, shape (t, 3), and the polygon of each, shape (t,).

    Triangles are ordered by their vertices. Quads are split here: how Blender does it depends on its cache.
    """
    loop_vertex = loop_vertices(mesh)
    start: Int = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", start)
    total = np.diff(start, append=np.int32(len(loop_vertex)))
    threes, fours = (np.flatnonzero(total == size).astype(np.int32) for size in (3, 4))
    three = np.add.outer(start[threes], np.arange(3, dtype=np.int32))
    quads = np.add.outer(start[fours], np.arange(4, dtype=np.int32))
    turned = split_from_second(positions(mesh), loop_vertex[quads])
    quads[turned] = np.roll(quads[turned], -1, axis=1)
    loops, polygon = [three, quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]], [threes, fours, fours]
    if (total > 4).any():
        mesh.calc_loop_triangles()
        many, owner = (np.empty(size * len(mesh.loop_triangles), np.int32) for size in (3, 1))
        mesh.loop_triangles.foreach_get("loops", many)
        mesh.loop_triangles.foreach_get("polygon_index", owner)
        larger = total[owner] > 4
        loops.append(many.reshape(-1, 3)[larger])
        polygon.append(owner[larger])
    owner, corner = np.concatenate(polygon), np.concatenate(loops)
    # Blender orders the faces of some meshes, such as its spheres, anew in every process.
    order = np.lexsort(loop_vertex[corner].T[::-1])
    corner = corner[order]
    return loop_vertex[corner], corner, owner[order]


def loose_edges(mesh: Any) -> Int:
    """Vertex pairs of edges without a face, shape (s, 2), ordered by their vertices."""
    count = len(mesh.edges)
    loose, ends = np.empty(count, np.bool_), np.empty(2 * count, np.int32)
    mesh.edges.foreach_get("is_loose", loose)
    mesh.edges.foreach_get("vertices", ends)
    pairs = np.sort(ends.reshape(-1, 2)[loose], axis=1)
    return pairs[np.lexsort(pairs.T[::-1])]


def add_group_weights(mesh: Any, first: int, count: int, weights: npt.NDArray[np.float32]) -> None:
    """Fill in the weights of `count` vertices, from the first on, in every vertex group, shape (g, n)."""
    for vertex in mesh.vertices[first : first + count] if len(weights) else ():
        for entry in vertex.groups:
            if entry.group < len(weights):
                weights[entry.group, vertex.index] = entry.weight


def attributes(mesh: Any) -> dict[tuple[str, str, str], npt.NDArray[Any]]:
    """Return what a mesh carries, by (domain, type, name): a row per vertex, loop or polygon."""
    found = {}
    for attribute in _own(mesh):
        name, kind = attribute.name, attribute.data_type
        if kind not in FIELDS:
            continue
        field, width, number = FIELDS[kind]
        flat: npt.NDArray[Any] = np.empty(width * len(attribute.data), number)
        attribute.data.foreach_get(field, flat)
        found[attribute.domain, kind, name] = flat.reshape(-1, width) if width > 1 else flat
    return found


def left_behind(mesh: Any) -> list[str]:
    """Return the names of attributes of points, faces and corners whose type cannot be carried."""
    return [attribute.name for attribute in _own(mesh) if attribute.data_type not in FIELDS]


def chosen(mesh: Any) -> tuple[Chosen, Chosen]:
    """Return which UV maps, and which colours, of a mesh are active and render."""
    layers, colours = mesh.uv_layers, mesh.color_attributes
    renders = next((layer.name for layer in layers if layer.active_render), "")
    uv = Chosen("" if layers.active is None else layers.active.name, renders)
    return uv, Chosen(colours.active_color_name, colours.default_color_name)


def _own(mesh: Any) -> list[Any]:
    """Return the attributes of points, faces and corners that belong to the user."""
    return [
        attribute for attribute in mesh.attributes
        if attribute.domain in ("POINT", "FACE", "CORNER")
        and not attribute.name.startswith(".") and attribute.name not in BUILT_IN
    ]  # fmt: skip


def corners(loop_vertex: Int, values: list[npt.NDArray[Any]]) -> tuple[Int, Int]:
    """Tell loops apart that differ in vertex or values: the corner of every loop, and a loop of each.

    Values count as equal to SAME: UV maps of Blender's own grid differ in their last digits from face to
    face, in every version in other ones.
    """
    rows = [loop_vertex.astype(np.float64)[:, None]]
    rows += [
        np.rint(np.asarray(array, np.float64).reshape(len(loop_vertex), -1) / SAME) * SAME for array in values
    ]
    table = np.ascontiguousarray(np.concatenate(rows, axis=1))
    # Comparing rows as bytes is ten times as fast as comparing them number by number.
    keys = (table + 0.0).view(np.dtype((np.void, table.itemsize * table.shape[1]))).ravel()
    _, first, corner = np.unique(keys, return_index=True, return_inverse=True)
    return corner.ravel().astype(np.int32), first.astype(np.int32)
