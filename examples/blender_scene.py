"""A mesh in Blender dressed by a script, with the operators of toile's extension (docs/blender.md).

Run: blender --background --python examples/blender_scene.py -- [FOLDER], or in Python with `pip install bpy`.
The folder then holds dressed.blend: a body, and a T-shirt that is drafted to it, with its frames.
"""

import sys
from pathlib import Path

import bpy
import numpy as np

import toile
from toile.geometry.arrays import Float, Int


def body_object(body: toile.Avatar) -> bpy.types.Object:
    """Return a body as an object of the scene: Blender has Z up and its front view along Y."""
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata((body.vertices[:, [0, 2, 1]] * (1.0, -1.0, 1.0)).tolist(), [], body.faces.tolist())
    made = bpy.data.objects.new("Body", mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def shown_mesh(garment: bpy.types.Object) -> tuple[Float, Int]:
    """Return the garment as the scene shows it: vertices, shape (n, 3), and triangles, shape (t, 3)."""
    shown = garment.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    points, faces = np.empty(3 * len(shown.vertices), np.float32), np.empty(3 * len(shown.polygons), np.int32)
    shown.vertices.foreach_get("co", points)
    shown.polygons.foreach_get("vertices", faces)
    return points.reshape(-1, 3).astype(np.float64), faces.reshape(-1, 3)


def main(output: str = "out", size: float = 0.016) -> tuple[Float, Int]:
    """Dress the mannequin, save the file and return the shirt, Z up."""
    folder = Path(output).absolute()
    folder.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if not hasattr(bpy.types.Object, "toile"):
        # Blender has registered an installed extension already; Python's bpy has not.
        from toile.blender_addon import register

        register()
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "dressed.blend"))
    bpy.context.view_layer.objects.active = body_object(toile.mannequin())
    settings = bpy.context.scene.toile
    settings.mode, settings.quality, settings.size_min = "DRAPE", "preview", size
    settings.pattern = "tshirt"
    bpy.ops.toile.dress_body()
    bpy.context.scene.frame_set(1)
    points, faces = shown_mesh(bpy.context.object)
    bpy.ops.wm.save_mainfile()
    print(f"{bpy.context.object.name}: {len(faces)} triangles")
    return points, faces


if __name__ == "__main__":
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    main(arguments[0] if arguments else "out")
