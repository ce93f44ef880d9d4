"""Draft a garment to a body that walks, with the playhead elsewhere than where its simulation starts."""

import json
import sys
from pathlib import Path

import bpy
import numpy as np
import small_scene as small

from toile.dressing.body.mannequin import mannequin

empty = Path(sys.argv[1])
small.empty_file(empty)
form = mannequin()
mesh = bpy.data.meshes.new("Body")
mesh.from_pydata((form.vertices[:, [0, 2, 1]] * (1.0, -1.0, 1.0)).tolist(), [], form.faces.tolist())
body = bpy.data.objects.new("Body", mesh)
scene = bpy.context.scene
scene.collection.objects.link(body)
body.toile.role = "AVATAR"
for frame, place in ((3, 2.0), (13, 5.0)):
    body.location = (place, 0.0, 0.0)
    body.keyframe_insert("location", frame=frame)
found = {}
for mode in ("SIMULATE", "DRAPE"):
    small.settings(mode)
    scene.toile.frame_start, scene.toile.size_min = 3, 0.04
    scene.frame_set(13)
    bpy.context.view_layer.objects.active = body
    bpy.ops.toile.add_pattern()
    drafted = bpy.context.object
    places = np.array([drafted.matrix_world @ vertex.co for vertex in drafted.data.vertices])
    found[mode] = float(0.5 * (places[:, 0].min() + places[:, 0].max()))
found["frame"] = scene.frame_current
small.settings("SIMULATE")
scene.toile.frame_start = 3
try:
    bpy.ops.toile.dress()
except RuntimeError as error:
    found["error"] = str(error)
import toile.blender_addon

toile.blender_addon.unregister()
print(json.dumps(found))
