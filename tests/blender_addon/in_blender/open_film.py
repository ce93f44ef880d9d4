"""Open a USD film; print, per mesh and frame, its area, mean place along x and vertices, and its material."""

import json
import sys

import bpy
import numpy as np

folder, frames = sys.argv[1], int(sys.argv[2])
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.usd_import(filepath=f"{folder}/film.usdc")
found: dict[str, object] = {}
for thing in [thing for thing in bpy.data.objects if thing.type == "MESH"]:
    rows = []
    for frame in range(frames):
        bpy.context.scene.frame_set(frame)
        seen = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
        mesh = seen.to_mesh()
        places = np.array([seen.matrix_world @ vertex.co for vertex in mesh.vertices])
        rows.append([sum(face.area for face in mesh.polygons), float(places[:, 0].mean()), len(places)])
    found[thing.name] = {"frames": rows, "materials": [material.name for material in thing.data.materials]}
print(json.dumps(found))
