"""A drafted pattern as a mesh object: panels around the body, stitches as loose edges."""

from pathlib import Path
from typing import Any

import bpy
import numpy as np

from toile.blender_addon.snapshot.garment_snapshot import HELD
from toile.blender_addon.snapshot.scene_folder import of_role
from toile.blender_addon.snapshot.space import moved, to_engine

UV = "UVMap"


def pattern_object(context: Any, path: Path, name: str) -> Any:
    """Make the object of a placed pattern, marked as outermost garment, and select it."""
    with np.load(path) as data:
        arrays = {key: data[key] for key in data.files}
    local = moved(
        np.asarray(np.linalg.inv(to_engine(np.eye(4), context.scene)), np.float64), arrays["vertices"]
    )
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(local.tolist(), arrays["stitches"].tolist(), arrays["faces"].tolist())
    uv = mesh.uv_layers.new(name=UV)
    uv.data.foreach_set("uv", arrays["uv"][arrays["faces"].ravel()].astype(np.float32).ravel())
    panel = mesh.attributes.new("panel", "INT", "FACE")
    panel.data.foreach_set("value", arrays["panel"].astype(np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), np.bool_))
    layer = 1 + max((garment.toile.layer for garment in of_role(context.scene, "GARMENT")), default=-1)
    obj = bpy.data.objects.new(name, mesh)
    context.scene.collection.objects.link(obj)
    for key, vertices in arrays.items():
        if key.startswith(HELD):
            group = obj.vertex_groups.new(name=key)
            group.add(vertices.tolist(), 1.0, "REPLACE")
    obj.toile.role, obj.toile.layer, obj.toile.warp_map = "GARMENT", layer, UV
    for other in context.scene.objects:
        other.select_set(False)
    obj.select_set(True)
    context.view_layer.objects.active = obj
    return obj
