"""Install the zip into a clean Blender, dress with it if asked to, take it out again."""

import json
import sys
import time
from importlib import import_module
from pathlib import Path

import bpy

addon_utils = import_module("addon_utils")  # bpy makes it findable
NAME = "bl_ext.user_default.toile"
folder, archive, dresses = Path(sys.argv[1]), sys.argv[2], sys.argv[3] == "dress"
bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default", enable_on_install=True)
import toile

found = {"from": toile.__file__, "enabled": hasattr(bpy.types.Object, "toile")}
addon_utils.disable(NAME)
found["disabled"] = not hasattr(bpy.types.Object, "toile") and "toile" not in sys.modules
started = time.perf_counter()
addon_utils.enable(NAME)
found["seconds"] = time.perf_counter() - started
found["loaded"] = sorted({"numba", "scipy", "trimesh"} & set(sys.modules))
bpy.ops.wm.save_as_mainfile(filepath=str(folder / "installed.blend"))
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3 if dresses else 0.003)
bpy.context.object.toile.role = "AVATAR"
bpy.ops.mesh.primitive_grid_add(size=1.0, location=(0.0, 0.0, 0.32))
garment = bpy.context.object
garment.toile.role = "GARMENT"
bpy.context.scene.toile.quality, bpy.context.scene.toile.size_min = "preview", 0.05
try:
    bpy.ops.toile.dress()
except RuntimeError as error:
    found["message"] = str(error)
found["state"] = garment.toile.state
addon_utils.disable(NAME)
print(json.dumps(found))
