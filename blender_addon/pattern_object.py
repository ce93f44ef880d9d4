"""A drafted pattern as a mesh object: panels around the body, stitches as loose edges."""

import hashlib
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from toile.blender_addon.snapshot.avatar_snapshot import STILL
from toile.blender_addon.snapshot.cast import roles
from toile.blender_addon.snapshot.garment_snapshot import HELD
from toile.blender_addon.snapshot.space import Space, moved

UV = "UVMap"
DECIDES = ("quality", "edge_length", "source")
"""Settings of a scene file that a draft depends on."""


def drafted_for(context: Any, body: Any, pattern: str) -> Any:
    """Return the garment that was drafted of a pattern to a body, None if the view layer shows none."""
    return next(
        (obj for obj in roles(context).garments if obj.toile.body == body and obj.toile.pattern == pattern),
        None,
    )


def draft_key(folder: Path) -> str:
    """Return what a draft depends on, in short: the body and settings in a scene folder."""
    lines = (folder / "scene.toml").read_text(encoding="utf-8").splitlines()
    text = "\n".join(line for line in lines if line.startswith(DECIDES))
    return hashlib.sha256(text.encode() + (folder / STILL).read_bytes()).hexdigest()[:16]


def pattern_object(context: Any, path: Path, name: str, into: Any = None) -> Any:
    """Make the object of a placed pattern, marked as outermost garment, and select it.

    `into` is a garment that gets the mesh instead, and keeps its settings, materials and modifiers.
    """
    with np.load(path) as data:
        arrays = {key: data[key] for key in data.files}
    obj = into or bpy.data.objects.new(name, bpy.data.meshes.new(name))
    matrix = Space.upright(context.scene).of(obj.matrix_world if into else np.eye(4))
    local = moved(np.asarray(np.linalg.inv(matrix), np.float64), arrays["vertices"])
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(local.tolist(), arrays["stitches"].tolist(), arrays["faces"].tolist())
    uv = mesh.uv_layers.new(name=UV)
    uv.data.foreach_set("uv", arrays["uv"][arrays["faces"].ravel()].astype(np.float32).ravel())
    panel = mesh.attributes.new("panel", "INT", "FACE")
    panel.data.foreach_set("value", arrays["panel"].astype(np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), np.bool_))
    for material in obj.data.materials:
        mesh.materials.append(material)
    old, obj.data = obj.data, mesh
    if not old.users:
        bpy.data.meshes.remove(old)
    if into is None:
        others = roles(context).garments
        context.scene.collection.objects.link(obj)
        obj.toile.layer = 1 + max((garment.toile.layer for garment in others), default=-1)
    for group in [group for group in obj.vertex_groups if group.name.startswith(HELD)]:
        obj.vertex_groups.remove(group)
    for key, vertices in arrays.items():
        if key.startswith(HELD):
            group = obj.vertex_groups.new(name=key)
            group.add(vertices.tolist(), 1.0, "REPLACE")
    obj.toile.role, obj.toile.warp_map = "GARMENT", UV
    for other in context.view_layer.objects:
        other.select_set(False)
    obj.select_set(True)
    context.view_layer.objects.active = obj
    return obj
