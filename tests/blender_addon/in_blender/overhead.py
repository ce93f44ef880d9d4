"""CPU time of one press on Dress This Body and of the command line on the same scene."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import bpy
import numpy as np
import small_scene as small

import toile
import toile.blender_addon
from toile.blender_addon import dressing

folder = Path(sys.argv[1])
small.empty_file(folder)
form = toile.mannequin()
mesh = bpy.data.meshes.new("Body")
mesh.from_pydata(
    (form.vertices @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)).tolist(), [], form.faces.tolist()
)
body = bpy.data.objects.new("Body", mesh)
bpy.context.scene.collection.objects.link(body)
bpy.context.view_layer.objects.active = body
body.toile.role = "AVATAR"
bpy.context.scene.toile.quality = "preview"
bpy.ops.toile.add_pattern()
kept = folder / "kept"
kept.mkdir()
small.write_scene(kept)


def children() -> float:
    times = os.times()
    return times.children_user + times.children_system


found: dict[str, list[float]] = {"engine": [], "blender": [], "command": []}
for number in range(2):
    before, own = children(), time.process_time()
    bpy.ops.toile.dress()
    found["engine"].append(children() - before)
    found["blender"].append(time.process_time() - own)
    before = children()
    command = [
        sys.executable,
        "-m",
        "toile",
        "dress",
        str(kept / "scene.toml"),
        "-o",
        str(folder / f"out{number}"),
    ]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([*dressing._bundled_paths(), *sys.path])}
    subprocess.run([*command, "--quiet"], check=True, env=environment)
    found["command"].append(children() - before)
toile.blender_addon.unregister()
print(json.dumps(found))
