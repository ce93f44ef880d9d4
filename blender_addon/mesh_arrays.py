"""Blender meshes as arrays: triangles, attributes, vertex groups, loose edges."""

from typing import Any

import numpy as np
import numpy.typing as npt

from toile.dress.surface import split_from_second
from toile.geometry.arrays import Float, Int

FIELDS = {
    "FLOAT": ("value", 1, np.float32), "INT": ("value", 1, np.int32), "BOOLEAN": ("value", 1, np.bool_),
    "FLOAT_VECTOR": ("vector", 3, np.float32), "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32), "BYTE_COLOR": ("color", 4, np.float32),
}  # fmt: skip
"""Types of attributes that are carried: field, width and number."""
BUILT_IN = ("position", "velocity", "crease_vert", "crease_edge")
"""Attributes that belong to the shape or to other modifiers."""


def positions(mesh: Any) -> Float:
    """Local positions, shape (n, 3)."""
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(np.float64)


def triangles(mesh: Any) -> tuple[Int, Int, Int]:
    """Vertices and loops of the triangles, shape (t, 3), and the polygon of each, shape (t,).

    Quads are split here: how Blender does it depends on what it has cached.
    """
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    loops, polygon = (np.empty(size, np.int32) for size in (3 * count, count))
    mesh.loop_triangles.foreach_get("loops", loops)
    mesh.loop_triangles.foreach_get("polygon_index", polygon)
    start, total, loop_vertex = (
        np.empty(size, np.int32) for size in (len(mesh.polygons),) * 2 + (len(mesh.loops),)
    )
    mesh.polygons.foreach_get("loop_start", start)
    mesh.polygons.foreach_get("loop_total", total)
    mesh.loops.foreach_get("vertex_index", loop_vertex)
    which = np.flatnonzero(total == 4).astype(np.int32)
    quads = start[which][:, None] + np.arange(4, dtype=np.int32)
    turned = split_from_second(positions(mesh), loop_vertex[quads])
    quads[turned] = np.roll(quads[turned], -1, axis=1)
    others = total[polygon] != 4
    loops = np.concatenate([loops.reshape(-1, 3)[others], quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    polygon = np.concatenate([polygon[others], which, which])
    order = np.argsort(polygon, kind="stable")
    return loop_vertex[loops[order]], loops[order], polygon[order]


def loose_edges(mesh: Any) -> Int:
    """Vertex pairs of edges without a face, shape (s, 2)."""
    count = len(mesh.edges)
    loose, ends = np.empty(count, np.bool_), np.empty(2 * count, np.int32)
    mesh.edges.foreach_get("is_loose", loose)
    mesh.edges.foreach_get("vertices", ends)
    return ends.reshape(-1, 2)[loose]


def vertex_groups(holder: Any, mesh: Any) -> dict[str, npt.NDArray[np.float32]]:
    """Weights of every vertex group of an object, on its evaluated mesh, shape (n,) each."""
    names = [group.name for group in holder.vertex_groups]
    weights = np.zeros((len(names), len(mesh.vertices)), np.float32)
    for vertex in mesh.vertices if names else ():
        for entry in vertex.groups:
            if entry.group < len(names):
                weights[entry.group, vertex.index] = entry.weight
    return dict(zip(names, weights, strict=True))


def attributes(mesh: Any) -> dict[tuple[str, str, str], npt.NDArray[Any]]:
    """Return what a mesh carries, by (domain, type, name): a row per vertex, loop or polygon."""
    found = {}
    for attribute in mesh.attributes:
        name, kind = attribute.name, attribute.data_type
        known = kind in FIELDS and attribute.domain in ("POINT", "FACE", "CORNER")
        if not known or name.startswith(".") or name in BUILT_IN:
            continue
        field, width, number = FIELDS[kind]
        flat: npt.NDArray[Any] = np.empty(width * len(attribute.data), number)
        attribute.data.foreach_get(field, flat)
        plain = "FLOAT_COLOR" if kind == "BYTE_COLOR" else kind
        found[attribute.domain, plain, name] = flat.reshape(-1, width) if width > 1 else flat
    return found


def corners(loop_vertex: Int, values: list[npt.NDArray[Any]]) -> tuple[Int, Int]:
    """Tell loops apart that differ in vertex or values: the corner of every loop, and a loop of each."""
    rows = [loop_vertex.astype(np.float64)[:, None]]
    rows += [np.asarray(array, np.float64).reshape(len(loop_vertex), -1) for array in values]
    table = np.ascontiguousarray(np.concatenate(rows, axis=1))
    # Comparing rows as bytes is ten times as fast as comparing them number by number.
    keys = (table + 0.0).view(np.dtype((np.void, table.itemsize * table.shape[1]))).ravel()
    _, first, corner = np.unique(keys, return_index=True, return_inverse=True)
    return corner.ravel().astype(np.int32), first.astype(np.int32)
