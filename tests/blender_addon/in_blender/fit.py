"""How a cloth fits: attributes in the frames, the colours that show them, nodes that read them."""

import json
import sys
from pathlib import Path

import bpy
import numpy as np
import small_scene as small

import toile.blender_addon
from toile.blender_addon import fit_nodes

folder = Path(sys.argv[1])
small.empty_file(folder)
scene = bpy.context.scene
found: dict[str, object] = {"maps": list(fit_nodes.MAPS)}
small.body()
bpy.ops.mesh.primitive_grid_add(size=0.9, x_subdivisions=8, y_subdivisions=8, location=(0.0, 0.0, 1.262))
cloth = bpy.context.object
cloth.name, cloth.toile.role = "Cloth", "GARMENT"
cloth.data.materials.append(bpy.data.materials.new("Own"))
old = cloth.data.attributes.new("pressure_Pa", "FLOAT", "POINT")
old.data.foreach_set("value", np.full(len(cloth.data.vertices), 1e6, np.float32))
small.settings("SIMULATE")
scene.toile.frame_end = 3


def maps(frame: int) -> dict[str, list[float]]:
    """Return the smallest, mean and largest value of every map that the cloth shows."""
    mesh = small.shown(cloth, frame)
    names = [each.name for each in mesh.attributes if each.name.endswith(("percent", "Pa", "N_m", "mm"))]
    seen = {name: small.values(mesh, name, "value") for name in names}
    return {name: [float(at.min()), float(at.mean()), float(at.max())] for name, at in seen.items()}


scene.toile.use_fit = True
bpy.ops.toile.dress()
scene.frame_set(1)
found["refused"] = ""
try:
    bpy.ops.toile.show_fit(shown="tension_N_m")
except RuntimeError as error:
    found["refused"] = str(error).strip()
found["state"], found["frames"] = cloth.toile.state, [maps(frame) for frame in (1, 2, 3)]
sidecar = json.loads((small.frames_folder(cloth) / "toile.json").read_text())["report"]
found["strain"] = sidecar["strain_percent"]
mesh = small.shown(cloth, 3)
pressed = small.values(mesh, "pressure_Pa", "value")[:, 0]
height = (small.points(mesh) + np.array(cloth.location))[:, 2]
gap = small.values(mesh, "ease_mm", "value")[:, 0]
found["pressed where it lies"] = [float(pressed[gap < 5.0].mean()), float(pressed[gap > 50.0].max())]

# Colours in one click; again, another map; and back.
own = [slot.name for slot in mesh.materials]
found["shown"] = []
for shown in ("stretch_warp_percent", "pressure_Pa"):
    bpy.ops.toile.show_fit(shown=shown)
    mesh = small.shown(cloth, 3)
    used = {polygon.material_index for polygon in mesh.polygons}
    found["shown"].append([
        sorted({mesh.materials[index].name for index in used}),
        [modifier.name for modifier in cloth.modifiers],
    ])  # fmt: skip
bpy.ops.object.light_add(type="SUN")
bpy.context.object.data.energy = 4.0
bpy.ops.object.camera_add(location=(0.0, -1.1, 2.0), rotation=(0.85, 0.0, 0.0))
scene.camera = bpy.context.object
bpy.data.objects["Body"].hide_render = True
scene.render.engine, scene.cycles.samples = "CYCLES", 4
scene.render.resolution_x = scene.render.resolution_y = 96
scene.render.filepath = str(folder / "fit.png")
scene.frame_set(3)
bpy.ops.render.render(write_still=True)
image = bpy.data.images.load(str(folder / "fit.png"))
pixels = np.array(image.pixels[:], np.float32).reshape(-1, 4)[:, :3]
found["colours"] = float((pixels[:, 0] - pixels[:, 2]).max())
bpy.context.view_layer.objects.active = cloth
bpy.ops.toile.show_fit(shown="NONE")
mesh = small.shown(cloth, 3)
found["back"] = [[slot.name for slot in mesh.materials] == own, [each.name for each in cloth.modifiers]]

# Nodes of a user's own that read cloth and maps.
bpy.ops.toile.add_nodes()
bpy.ops.toile.add_nodes()
groups = [group for group in bpy.data.node_groups if group.name.startswith("Toile Fit")]
found["asset"] = [len(groups), groups[0].asset_data is not None]
nodes = bpy.data.node_groups.new("Own", "GeometryNodeTree")
nodes.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
read = nodes.nodes.new("GeometryNodeGroup")
read.node_tree = groups[0]
read.inputs["Garment"].default_value = cloth
store = nodes.nodes.new("GeometryNodeStoreNamedAttribute")
store.inputs["Name"].default_value = "copied"
nodes.links.new(read.outputs["Geometry"], store.inputs["Geometry"])
nodes.links.new(read.outputs["Pressure [Pa]"], store.inputs["Value"])
nodes.links.new(store.outputs[0], nodes.nodes.new("NodeGroupOutput").inputs[0])
bpy.ops.mesh.primitive_cube_add()
reader = bpy.context.object
reader.modifiers.new("Own", "NODES").node_group = nodes
seen = small.values(small.shown(reader, 3), "copied", "value")[:, 0]
found["read"] = [len(seen) == len(pressed), float(np.abs(np.sort(seen) - np.sort(pressed)).max())]
bpy.context.view_layer.objects.active = cloth
bpy.ops.toile.show_fit(shown="pressure_Pa")
scene.toile.use_fit = False
without = folder / "without"
without.mkdir()
small.write_scene(without)
found["without"] = "fit" in (without / "scene.toml").read_text()
small.stub_engine()
bpy.ops.toile.dress()
found["stays"] = [modifier.name for modifier in cloth.modifiers]
bpy.ops.toile.clear()
found["cleared"] = [each.name for each in cloth.modifiers]
toile.blender_addon.unregister()
print(json.dumps(found))
