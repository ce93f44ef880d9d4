"""A flag on a body that moves: held by weights, blown by a wind; and a ring that starts inside the body."""

import io
import json
import sys
from contextlib import redirect_stdout
from pathlib import Path

import bpy
import numpy as np
import small_scene as small

import toile.blender_addon

FRAMES = 8
folder = Path(sys.argv[1])
small.empty_file(folder)
scene = bpy.context.scene
ball = small.body()
ball.modifiers.clear()
for frame, place in ((1, 0.0), (FRAMES, 0.1)):
    ball.location.y = place
    ball.keyframe_insert("location", index=1, frame=frame)


def flag(name: str, height: float) -> bpy.types.Object:
    """A sheet beside the body that moves along with it, its weights falling from 1 to 0 away from it."""
    bpy.ops.mesh.primitive_grid_add(size=0.4, x_subdivisions=8, y_subdivisions=8, location=(0.5, 0.0, height))
    made = bpy.context.object
    made.name, made.parent = name, ball
    made.matrix_parent_inverse = ball.matrix_world.inverted()
    group = made.vertex_groups.new(name="Pin")
    for vertex in made.data.vertices:
        group.add([vertex.index], float(np.clip(0.5 - 2.5 * vertex.co.x, 0.0, 1.0)), "REPLACE")
    made.toile.role, made.toile.pin_group = "GARMENT", "Pin"
    return made


def away(obj: bpy.types.Object) -> dict[str, object]:
    """Mean distance from where the object's own mesh is, in its space, at weights 1, 0.5 and 0.

    A coarse mesh need have no vertices in the row of weight 0.5: it is read between those on both sides.
    """
    mesh = small.shown(obj, FRAMES)
    here, uv = small.points(mesh), np.zeros((len(mesh.vertices), 2))
    loops = np.array([loop.vertex_index for loop in mesh.loops])
    uv[loops] = small.values(mesh, "UVMap", "vector", 2)
    own = np.column_stack([0.4 * (uv - 0.5), np.zeros(len(uv))])
    weight = np.array([sum(entry.weight for entry in vertex.groups) for vertex in mesh.vertices])
    wrong = float(np.abs(weight - np.clip(0.5 - 2.5 * own[:, 0], 0.0, 1.0)).max())
    off = here - own
    distance = np.linalg.norm(off, axis=1)
    order = np.argsort(weight)
    half = float(np.interp(0.5, weight[order], distance[order]))
    return {
        "weights off": wrong, "vertices": len(here),
        "away": [float(distance[weight > 0.99].mean()), half, float(distance[weight < 0.05].mean())],
        "up": float(off[:, 2].mean()),
    }  # fmt: skip


small.settings("SIMULATE")
scene.toile.frame_end = FRAMES
soft, stiff = flag("Soft", 1.0), flag("Stiff", 1.3)
soft.toile.pin_stiffness, stiff.toile.pin_stiffness = 30.0, 3000.0
printed = io.StringIO()
with redirect_stdout(printed):
    bpy.ops.toile.dress()
found = {"state": soft.toile.state, "soft": away(soft), "stiff": away(stiff)}

# Wind from two objects, and fields that are not understood.
bpy.data.objects.remove(stiff)
bpy.ops.object.effector_add(type="WIND", location=(3.0, 0.0, 0.0), rotation=(np.pi / 2.0, 0.0, 0.0))
first = bpy.context.object
first.scale = (2.0, 2.0, 2.0)
first.field.strength, first.field.noise, first.field.seed = 6.0, 0.5, 7
bpy.ops.object.effector_add(type="WIND", rotation=(0.0, np.pi / 2.0, 0.0))
second = bpy.context.object
second.field.strength, second.field.falloff_power = 2.0, 1.0
bpy.ops.object.effector_add(type="VORTEX")
bpy.context.object.name = "Whirl"
bpy.ops.object.effector_add(type="TURBULENCE")
bpy.context.object.hide_viewport = True
read = folder / "read"
read.mkdir()
small.write_scene(read)
table = (read / "scene.toml").read_text().partition("[air]")[2].partition("[avatar]")[0]
found["air"] = table.strip().splitlines()
first.rotation_euler.x = 0.0
printed = io.StringIO()
with redirect_stdout(printed):
    bpy.ops.toile.dress()
found["notes"] = [line for line in printed.getvalue().splitlines() if "Warning" in line]
found["windy"] = away(soft)
scene.toile.mode = "DRAPE"
printed = io.StringIO()
with redirect_stdout(printed):
    bpy.ops.toile.dress()
found["notes at rest"] = [line for line in printed.getvalue().splitlines() if "Warning" in line]
first.field.strength = 200.0
scene.toile.mode = "SIMULATE"
try:
    bpy.ops.toile.dress()
except RuntimeError as error:
    found["storm"] = str(error).strip()

# A ring that starts inside the body, and is free.
bpy.data.objects.remove(soft)
scene.toile.mode = "DRAPE"
scene.frame_set(1)
bpy.ops.mesh.primitive_cylinder_add(
    vertices=16, radius=0.15, depth=0.1, end_fill_type="NOTHING", location=(0.0, 0.0, 1.0)
)
ring = bpy.context.object
ring.name = "Ring"
ring.toile.role = "GARMENT"
try:
    bpy.ops.toile.dress()
except RuntimeError as error:
    found["ring"] = str(error).strip()
found["ring selected"] = [ring.toile.state, sum(polygon.select for polygon in ring.data.polygons)]
toile.blender_addon.unregister()
print(json.dumps(found))
