"""Register and unregister again and again; tell what is left behind, and how long it takes."""

import json
import sys
import time

import bpy

import toile.blender_addon


def traces() -> dict[str, object]:
    """What an add-on may leave in Blender."""
    handlers = {
        name: len(entries)
        for name in dir(bpy.app.handlers)
        if isinstance(entries := getattr(bpy.app.handlers, name), list)
    }
    return {
        "types": sorted(name for name in dir(bpy.types) if "toile" in name.lower()),
        "operators": sorted(name for name in dir(bpy.ops) if name == "toile"),
        "properties": [hasattr(bpy.types.Object, "toile"), hasattr(bpy.types.Scene, "toile")],
        "drawn": len(bpy.types.PHYSICS_PT_add._dyn_ui_initialize()),
        "handlers": handlers,
    }


before = traces()
seconds = []
for _ in range(5):
    started = time.perf_counter()
    toile.blender_addon.register()
    seconds.append(time.perf_counter() - started)
    during = traces()
    toile.blender_addon.unregister()
after = traces()
print(json.dumps({
    "before": before, "during": during, "after": after, "seconds": seconds,
    "loaded": sorted({"numba", "scipy", "trimesh", "fcl", "manifold3d"} & set(sys.modules)),
}))  # fmt: skip
