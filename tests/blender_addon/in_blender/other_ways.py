"""What else a user does: keep the topology, cancel midway, undo; and what goes wrong."""

import json
import sys
import time
from math import cos, pi, sin
from pathlib import Path

import bpy
import numpy as np
import small_scene as small

import toile.blender_addon
from toile.blender_addon.dressed import Dressed
from toile.blender_addon.dressing import dress_steps
from toile.blender_addon.run import Current, Run

folder = Path(sys.argv[1])
found: dict[str, object] = {}


def message(operator: object) -> str:
    """Return the error of an operator."""
    try:
        operator()
    except RuntimeError as error:
        return str(error).strip()
    return ""


# Not saved yet, nothing there.
toile.blender_addon.register()
bpy.ops.wm.read_factory_settings(use_empty=True)
found["unsaved"] = message(bpy.ops.toile.dress)
small.empty_file(folder)
found["no avatar"] = message(bpy.ops.toile.dress)
ball = small.body()
found["no garment"] = message(bpy.ops.toile.dress)
garment = small.sheet()

# Keep my topology.
small.settings("SIMULATE")
bpy.context.scene.toile.frame_end = 3
garment.toile.keep_topology = True
bpy.ops.ed.undo_push(message="before")
bpy.ops.toile.dress()
bpy.ops.ed.undo_push(message="after")

# Undo, and redo; references from before are void.
found["undo"] = []
for step in (bpy.ops.ed.undo, bpy.ops.ed.redo):
    step()
    garment = bpy.data.objects["My Shawl"]
    found["undo"].append([modifier.type for modifier in garment.modifiers])
garment.modifiers.new("Subdivision", "SUBSURF").levels = 1
kept = [small.points(small.shown(garment, frame)) for frame in (1, 2, 3)]
found["kept"] = {
    "modifiers": [modifier.type for modifier in garment.modifiers],
    "vertices": [len(frame) for frame in kept],
    "moved": [float(np.abs(frame - kept[0]).max()) for frame in kept],
    "edges": float(np.linalg.norm(np.diff(kept[2][:9] * (0.8, 0.8, 1.0), axis=0), axis=1).max()),
}
garment.modifiers.remove(garment.modifiers["Subdivision"])
garment.toile.keep_topology = False

# Cancel midway, as the modal operator does: tick by tick. Every frame that came is looked at, at once.
came: list[float] = []
places: list[float] = []
frame_came = Dressed.frame_came


def noted(self: Dressed) -> None:
    frame_came(self)
    places.append(float(small.points(small.shown(bpy.data.objects["My Shawl"], len(came) + 1)).sum()))
    came.append(time.time())


Dressed.frame_came = noted
bpy.context.scene.toile.frame_end = 60
Current.run = Run(dress_steps(bpy.context))
ticks, texts, more = [], [], True
cache = folder / "toile_scene" / "My_Shawl" / "2"
while more:
    started = time.perf_counter()
    more = Current.run.tick()
    ticks.append(time.perf_counter() - started)
    texts.append(Current.run.text)
    if len(list(cache.glob("*.usdc"))) >= 3:
        Current.run.cancelled = True
    time.sleep(0.02)
Current.run = None
Dressed.frame_came = frame_came
written = [path.stat().st_mtime for path in sorted(cache.glob("*.usdc"))][: len(came)]
found["waited"] = [seen - at for seen, at in zip(came, written, strict=True)]
found["seen"] = [
    places,
    [float(small.points(small.shown(garment, frame + 1)).sum()) for frame in range(len(came))],
]
found["cancelled"] = {
    "state": garment.toile.state, "files": len(list(cache.glob("*.usdc"))),
    "longest tick": max(ticks), "longest tick was": texts[int(np.argmax(ticks))],
    "sidecar": json.loads((cache / "toile.json").read_text())["state"],
    "shown": len(small.shown(garment, 2).polygons),
    "type": garment.modifiers["toile"].type,
}  # fmt: skip

# Clear.
bpy.context.view_layer.objects.active = garment
bpy.ops.toile.clear()
found["cleared"] = [list(garment.modifiers), cache.exists(), len(bpy.data.cache_files)]

# Degenerate faces are mended, and that is said.
bpy.context.scene.toile.mode = "DRAPE"
corner = garment.data.polygons[9].vertices[0]
saved = [vertex.co.copy() for vertex in garment.data.vertices]
for vertex in garment.data.polygons[9].vertices:
    garment.data.vertices[vertex].co = garment.data.vertices[corner].co
found["degenerate"] = [message(bpy.ops.toile.dress), garment.toile.notes]
for vertex, place in zip(garment.data.vertices, saved, strict=True):
    vertex.co = place

# Faces of a strip with one side are named and selected.
bpy.context.scene.toile.mode = "DRAPE"
strip, count = [], 12
for width in (-0.1, 0.1):
    for index in range(count):
        angle = 2.0 * pi * index / count
        reach = 0.5 + width * cos(0.5 * angle)
        strip.append((reach * cos(angle), reach * sin(angle), 1.0 + width * sin(0.5 * angle)))
quads = [(k, k + 1, count + k + 1, count + k) for k in range(count - 1)]
quads.append((count - 1, count, 0, 2 * count - 1))
garment.data.clear_geometry()
garment.data.from_pydata(strip, [], quads)
garment.data.uv_layers.new(name="UVMap")
found["one-sided"] = message(bpy.ops.toile.dress)
found["selected"] = [polygon.index for polygon in garment.data.polygons if polygon.select]

# A garment whose pins hold it in the body.
bpy.data.objects.remove(garment)
bpy.ops.mesh.primitive_grid_add(size=0.3, x_subdivisions=6, y_subdivisions=6, location=(0.2, 0.0, 1.0))
inside = bpy.context.object
inside.toile.role, inside.name = "GARMENT", "Flag"
inside.vertex_groups.new(name="Pin").add([0, 7, 14, 21, 28, 35, 42], 1.0, "REPLACE")
inside.toile.pin_group = "Pin"
found["inside"] = message(bpy.ops.toile.dress)
found["inside selected"] = sum(polygon.select for polygon in inside.data.polygons)
found["inside state"] = inside.toile.state
found["inside shown"] = [modifier.type for modifier in inside.modifiers]

# A scene in centimetres.
bpy.context.scene.unit_settings.scale_length = 0.01
centimetres = folder / "centimetres"
centimetres.mkdir()
small.write_scene(centimetres)
in_metres = np.load(centimetres / "Flag.npz")["vertices"]
found["centimetres"] = [in_metres.min(axis=0).tolist(), in_metres.max(axis=0).tolist()]
toile.blender_addon.unregister()
print(json.dumps(found))
