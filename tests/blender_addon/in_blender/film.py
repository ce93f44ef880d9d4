"""Dress a moving body by script; tell about frames, attributes, saving, moving, applying."""

import json
import shutil
import sys
import time
from pathlib import Path

import bpy
import numpy as np
import small_scene as small

folder = Path(sys.argv[1])
work = folder / "work"
work.mkdir()
small.empty_file(work)
ball, garment = small.body(), small.sheet()
small.settings("SIMULATE")
before = small.points(garment.data).tobytes(), len(garment.data.polygons)

# What the engine reads, for a run without Blender.
engine_folder = folder / "engine"
engine_folder.mkdir()
small.write_scene(engine_folder)
to_local = np.load(engine_folder / "My_Shawl_carried.npz")["to_local"]

started = time.perf_counter()
answer = bpy.ops.toile.dress()
seconds = time.perf_counter() - started
found = {"answer": list(answer), "state": garment.toile.state, "seconds": seconds, "frames": [], "errors": {}}

errors: dict[str, float] = {}
for frame in range(1, small.FRAMES + 1):
    mesh = small.shown(garment, frame)
    local = small.points(mesh)
    np.save(folder / f"shown_{frame}.npy", local)
    uv = small.values(mesh, "UVMap", "vector", 2)
    loop_vertex = np.array([loop.vertex_index for loop in mesh.loops])
    uv_vertex = np.zeros((len(local), 2))
    uv_vertex[loop_vertex] = uv
    weight = np.array(
        [sum(entry.weight for entry in vertex.groups if entry.group == 0) for vertex in mesh.vertices]
    )
    colour = small.values(mesh, "colour", "color", 4)
    height = small.values(mesh, "height", "value")[:, 0]
    number = small.values(mesh, "number", "value")[:, 0].astype(int)
    material = np.array([polygon.material_index for polygon in mesh.polygons])
    centre = uv.reshape(-1, 3, 2).mean(axis=1)
    off = {
        "uv against group": np.abs(uv_vertex[:, 0] - weight).max(),
        "uv against attribute": np.abs(uv_vertex[:, 1] - height).max(),
        "uv against colour": np.abs(uv - colour[:, :2]).max(),
        "material": float(np.mean(material != (centre[:, 0] > 0.5))),
        "polygon number": float(np.mean(material != number % 8 // 4)),
    }
    errors = {key: max(float(value), errors.get(key, 0.0)) for key, value in off.items()}
    found["frames"].append(
        {
            "vertices": len(local), "faces": len(mesh.polygons), "materials": sorted(set(material.tolist())),
            "smooth": all(polygon.use_smooth for polygon in mesh.polygons),
            "speed": float(np.abs(small.values(mesh, "velocity", "vector", 3)).max()),
            "uv": [float(uv.min()), float(uv.max())],
        }
    )  # fmt: skip
found["errors"] = errors
found["original kept"] = before == (small.points(garment.data).tobytes(), len(garment.data.polygons))
garment.modifiers["toile"].show_viewport = False
found["original shown"] = small.points(small.shown(garment, 3)).tobytes() == before[0]
garment.modifiers["toile"].show_viewport = True
found["path"] = garment.modifiers["toile"].cache_file.filepath
found["sidecar"] = json.loads((small.frames_folder(garment) / "toile.json").read_text())
found["files"] = sorted(path.name for path in small.frames_folder(garment).iterdir())
np.save(folder / "to_local.npy", to_local)

# Every frame again in what was saved, moved and opened without the add-on.
bpy.ops.wm.save_mainfile()
import toile.blender_addon

toile.blender_addon.unregister()
moved = folder / "moved"
shutil.move(work, moved)
bpy.ops.wm.open_mainfile(filepath=str(moved / "scene.blend"))
garment = bpy.data.objects["My Shawl"]
found["moved"] = [
    np.array_equal(small.points(small.shown(garment, frame)), np.load(folder / f"shown_{frame}.npy"))
    for frame in range(1, small.FRAMES + 1)
]

# Linked into another file.
bpy.ops.wm.read_factory_settings(use_empty=True)
with bpy.data.libraries.load(str(moved / "scene.blend"), link=True) as (_, wanted):
    wanted.objects = ["My Shawl"]
bpy.context.scene.collection.objects.link(wanted.objects[0])
found["linked"] = len(small.shown(wanted.objects[0], 4).vertices)

# Exported for other tools, and read back.
bpy.ops.wm.open_mainfile(filepath=str(moved / "scene.blend"))
garment = bpy.data.objects["My Shawl"]
for other in bpy.data.objects:
    other.select_set(other == garment)
bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, small.FRAMES
bpy.ops.wm.alembic_export(filepath=str(folder / "out.abc"), selected=True, as_background_job=False)
bpy.ops.wm.usd_export(filepath=str(folder / "out.usdc"), selected_objects_only=True, export_animation=True)
found["exported"] = [(folder / name).stat().st_size for name in ("out.abc", "out.usdc")]

# Applied.
toile.blender_addon.register()
bpy.context.view_layer.objects.active = garment
bpy.context.scene.frame_set(4)
count = len(small.shown(garment, 4).vertices)
bpy.ops.toile.apply()
found["applied"] = [len(garment.data.vertices) == count, [modifier.type for modifier in garment.modifiers],
                    len(garment.data.materials), garment.toile.role]  # fmt: skip
toile.blender_addon.unregister()
print(json.dumps(found))
