"""Gravity in any direction, gravity and wind that change; a hash of a drape on a sphere of Blender's own."""

import hashlib
import io
import json
import sys
from contextlib import redirect_stdout
from pathlib import Path

import bpy
import numpy as np
import small_scene as small

import toile.blender_addon

folder = Path(sys.argv[1])
small.empty_file(folder)
scene = bpy.context.scene
found = {}


def sheet(place: tuple[float, float, float], turn: tuple[float, float, float]) -> bpy.types.Object:
    bpy.ops.mesh.primitive_grid_add(
        size=0.5, x_subdivisions=5, y_subdivisions=5, location=place, rotation=turn
    )
    made = bpy.context.object
    made.toile.role = "GARMENT"
    return made


bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=12, radius=0.25)
ball = bpy.context.object
ball.toile.role = "AVATAR"
small.settings("DRAPE")
upright = sheet((0.0, 0.0, 0.26), (0.0, 0.0, 0.0))
bpy.ops.toile.dress()
seen = small.points(small.shown(upright, 1))
found["hash"] = hashlib.sha256(seen.tobytes()).hexdigest()
found["upright"] = [float(seen[:, 2].min()), float(np.abs(seen[:, :2]).max())]
bpy.data.objects.remove(upright)

# Gravity along X, along a diagonal, upwards: the sheet starts on the other side, across.
found["turned"] = []
for direction in ((1.0, 0.0, 0.0), (0.0, -0.6, -0.8), (0.0, 0.0, 1.0)):
    gravity = np.array(direction)
    scene.gravity = (9.81 * gravity).tolist()
    made = sheet(tuple(-0.26 * gravity), (0.0, 0.0, 0.0))
    made.rotation_euler = bpy.data.objects[made.name].location.to_track_quat("Z", "Y").to_euler()
    bpy.ops.toile.dress()
    mesh = small.shown(made, 1)
    places = np.array([made.matrix_world @ vertex.co for vertex in mesh.vertices])
    local = small.points(mesh)
    found["turned"].append([float(local[:, 2].min()), float((places @ gravity).max())])
    bpy.data.objects.remove(made)

# Gravity and wind that change.
made = sheet((0.0, 0.0, 0.26), (0.0, 0.0, 0.0))
small.settings("SIMULATE")
scene.toile.frame_end = 3
for frame, fall in ((1, -9.81), (3, -5.0)):
    scene.gravity = (0.0, 0.0, fall)
    scene.keyframe_insert("gravity", frame=frame)
bpy.ops.object.effector_add(type="WIND")
wind = bpy.context.object
for frame, strength in ((1, 1.0), (3, 4.0)):
    wind.field.strength = strength
    wind.keyframe_insert("field.strength", frame=frame)
small.stub_engine()
printed = io.StringIO()
with redirect_stdout(printed):
    bpy.ops.toile.dress()
found["notes"] = [line for line in printed.getvalue().splitlines() if "Warning" in line]
scene.frame_set(3)
read = folder / "read"
read.mkdir()
small.write_scene(read)
text = (read / "scene.toml").read_text()
found["air"] = text.partition("[air]")[2].partition("[avatar]")[0].strip().splitlines()
found["gravity"] = next(line for line in (read / "scene.toml").read_text().splitlines() if "gravity" in line)
toile.blender_addon.unregister()
print(json.dumps(found))
