"""A table that stands still and a ball that comes, beside the body; what the engine reads, and the film."""

import json
import sys
from pathlib import Path

import bpy
import numpy as np
import small_scene as small

import toile.blender_addon

folder = Path(sys.argv[1])
small.empty_file(folder)
scene = bpy.context.scene
found: dict[str, object] = {}


def ball(name: str, role: str, radius: float, place: tuple[float, float, float]) -> bpy.types.Object:
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=radius, location=place)
    made = bpy.context.object
    made.name, made.toile.role = name, role
    return made


ball("Body", "AVATAR", 0.25, (0.0, 0.0, 1.0))
comes = ball("Comes", "OBSTACLE", 0.1, (0.62, 0.0, 1.1))
for frame, x in ((1, 0.62), (5, 0.42)):
    comes.location[0] = x
    comes.keyframe_insert("location", frame=frame)
bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 0.6), scale=(1.0, 1.0, 0.5))
table = bpy.context.object
table.name = "Table"
bpy.ops.toile.set_role(role="OBSTACLE")
table.toile.use_friction, table.toile.friction = True, 0.125
bpy.ops.mesh.primitive_grid_add(size=0.9, x_subdivisions=8, y_subdivisions=8, location=(0.0, 0.0, 1.262))
cloth = bpy.context.object
cloth.name, cloth.toile.role = "Cloth", "GARMENT"
small.settings("SIMULATE")
scene.toile.frame_end = 5
read = folder / "read"
read.mkdir()
small.write_scene(read)
lines = (read / "scene.toml").read_text().splitlines()
found["toml"] = lines[lines.index("[[obstacle]]") :]
found["files"] = sorted(path.name for path in read.glob("obstacle*"))
bpy.ops.toile.dress()
found["state"], found["notes"] = cloth.toile.state, cloth.toile.notes
found["frames"] = []
for frame in (1, 5):
    shown = small.points(small.shown(cloth, frame)) + np.array(cloth.location)
    over = (np.abs(shown[:, :2]) < 0.5).all(axis=1)
    away = np.linalg.norm(shown - np.array(comes.matrix_world.translation), axis=1)
    found["frames"].append([float(shown[over, 2].min()), float(away.min())])
comes.hide_set(True)
comes.toile.role = "NONE"
bpy.context.view_layer.objects.active = table
bpy.ops.toile.set_role(role="NONE")
none = folder / "none"
none.mkdir()
small.write_scene(none)
found["none"] = "[[obstacle]]" in (none / "scene.toml").read_text()
toile.blender_addon.unregister()
print(json.dumps(found))
