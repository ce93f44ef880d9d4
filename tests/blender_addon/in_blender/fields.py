"""Fields that a vertex group, nodes and keyframes set; what the engine reads, and what comes of it."""

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
small.body()
bpy.ops.mesh.primitive_grid_add(size=0.5, x_subdivisions=5, y_subdivisions=5, location=(0.6, 0.0, 1.3))
cloth = bpy.context.object
cloth.name, cloth.toile.role = "Cloth", "GARMENT"
here = np.array([vertex.co for vertex in cloth.data.vertices])
heavy = cloth.vertex_groups.new(name="Heavy side")
heavy.add(np.flatnonzero(here[:, 0] > 0.1).tolist(), 1.0, "REPLACE")
edge = cloth.vertex_groups.new(name="Edge")
edge.add(np.flatnonzero(np.abs(here[:, 1]) > 0.24).tolist(), 1.0, "REPLACE")
cloth.toile.pin_group = "Edge"
small.settings("SIMULATE")
scene.toile.frame_end = 3
for _ in range(3):
    bpy.ops.toile.add_field()
painted, by_nodes, keyed = cloth.toile.fields
painted.quantity, painted.source, painted.low, painted.high = "areal_density", "Heavy side", 0.1, 1.0
by_nodes.quantity, by_nodes.source, by_nodes.low, by_nodes.high = "bending_warp", "made", 1.0, 5.0
keyed.quantity = "pressure"
for frame, value in ((1, 0.0), (3, 8.0)):
    keyed.high = value
    keyed.keyframe_insert("high", frame=frame)
for curve in (
    cloth.animation_data.action.fcurves
    if hasattr(cloth.animation_data.action, "fcurves")
    else cloth.animation_data.action.layers[0].strips[0].channelbags[0].fcurves
):
    for point in curve.keyframe_points:
        point.interpolation = "LINEAR"
nodes = bpy.data.node_groups.new("Made", "GeometryNodeTree")
for way in ("INPUT", "OUTPUT"):
    nodes.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
store = nodes.nodes.new("GeometryNodeStoreNamedAttribute")
store.inputs["Name"].default_value, store.inputs["Value"].default_value = "made", 0.25
nodes.links.new(nodes.nodes.new("NodeGroupInput").outputs[0], store.inputs["Geometry"])
nodes.links.new(store.outputs["Geometry"], nodes.nodes.new("NodeGroupOutput").inputs[0])
cloth.modifiers.new("Made", "NODES").node_group = nodes
read = folder / "read"
read.mkdir()
small.write_scene(read)
with np.load(read / "Cloth.npz") as data:
    arrays = {key: data[key] for key in data.files if key.startswith("field_")}
lines = (read / "scene.toml").read_text().splitlines()
right = here[:, 0] > 0.1
found = {
    "toml": [lines[at + 1] for at, line in enumerate(lines) if line == "[[garment.field]]"],
    "heavy": [float(arrays["field_0"][right].min()), float(arrays["field_0"][~right].max())],
    "made": [float(arrays["field_1"].min()), float(arrays["field_1"].max())],
}  # fmt: skip
bpy.context.view_layer.objects.active = cloth
bpy.ops.toile.remove_field(index=2)
cloth.modifiers.remove(cloth.modifiers["Made"])
bpy.ops.toile.remove_field(index=1)
scene.toile.mode = "DRAPE"
scene.frame_set(1)
bpy.ops.toile.dress()
mesh = small.shown(cloth, 1)
places, uv = small.points(mesh), np.zeros((len(mesh.vertices), 2))
uv[[loop.vertex_index for loop in mesh.loops]] = small.values(mesh, "UVMap", "vector", 2)
middle = np.abs(uv[:, 1] - 0.5) < 0.2
found["sag"] = [float(places[middle & side, 2].mean()) for side in (uv[:, 0] > 0.8, uv[:, 0] < 0.2)]
cloth.toile.fields[0].source = "nowhere"
try:
    bpy.ops.toile.dress()
except RuntimeError as error:
    found["unknown"] = str(error).strip()
toile.blender_addon.unregister()
print(json.dumps(found))
