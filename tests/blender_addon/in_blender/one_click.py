"""Dress the built-in mannequin by one click; import a pattern file."""

import json
import sys
from pathlib import Path

import bpy
import numpy as np
import small_scene as small

from toile.dressing.body.mannequin import mannequin

folder, pattern_file = Path(sys.argv[1]), sys.argv[2]
small.empty_file(folder)
form = mannequin()
bpy.ops.wm.read_factory_settings(use_empty=True)
mesh = bpy.data.meshes.new("Body")
mesh.from_pydata((form.vertices[:, [0, 2, 1]] * (1.0, -1.0, 1.0)).tolist(), [], form.faces.tolist())
body = bpy.data.objects.new("Body", mesh)
bpy.context.scene.collection.objects.link(body)
bpy.context.view_layer.objects.active = body
small.settings("DRAPE")
bpy.context.scene.toile.size_min = 0.03
try:
    bpy.ops.toile.dress_body()
except RuntimeError as error:
    unsaved = [str(error).strip(), body.toile.role, len(bpy.data.objects)]
bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))
bpy.context.view_layer.objects.active = body
answer = bpy.ops.toile.dress_body()
garment = bpy.context.object
dressed = small.shown(garment, 1)
found = {
    "unsaved": unsaved,
    "answer": list(answer),
    "role": body.toile.role,
    "name": garment.name,
    "state": garment.toile.state,
    "report": json.loads((small.frames_folder(garment) / "toile.json").read_text())["report"],
    "loose": sum(edge.is_loose for edge in garment.data.edges),
    "groups": [group.name for group in garment.vertex_groups],
    "uv": [layer.name for layer in dressed.uv_layers],
    "low": small.points(dressed).min(axis=0).tolist(),
    "high": small.points(dressed).max(axis=0).tolist(),
}


def press() -> list[object]:
    """Press the button again; return the names of garments, the frames' folder and what is shown."""
    bpy.context.view_layer.objects.active = body
    small.Stub.tasks.clear()
    bpy.ops.toile.dress_body()
    names = [obj.name for obj in bpy.data.objects if obj.toile.role == "GARMENT"]
    return [names, list(small.Stub.tasks)]


# Pressed again: the same garment is dressed again, and drafted again only where that matters.
garment.data.materials.append(bpy.data.materials.new("Jersey"))
garment.toile.fabric = "denim-12oz"
first = len(garment.data.vertices)
small.stub_engine()
found["again"] = press()
found["shown again"] = len(small.shown(garment, 1).polygons)
bpy.context.scene.toile.size_min = 0.04
found["other quality"] = press()
found["kept"] = [
    garment.toile.fabric, [material.name for material in garment.data.materials],
    len(garment.data.vertices) < first, garment.modifiers[0].name, garment.toile.body == body,
]  # fmt: skip
bpy.ops.toile.import_pattern(filepath=pattern_file)
imported = bpy.context.object
found["imported"] = {
    "name": imported.name, "layer": imported.toile.layer, "role": imported.toile.role,
    "panels": len(np.unique(small.values(imported.data, "panel", "value"))),
    "loose": sum(edge.is_loose for edge in imported.data.edges),
}  # fmt: skip
import toile.blender_addon

toile.blender_addon.unregister()
print(json.dumps(found))
