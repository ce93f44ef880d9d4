"""A body bent by a bone, and a sheet over it with all that a mesh can carry: small enough for a test."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

import bpy
import numpy as np

FRAMES = 13
SIZE = 0.05


def empty_file(folder: Path) -> None:
    """Start an empty scene, saved in a folder, the add-on at work."""
    import toile.blender_addon

    bpy.ops.wm.read_factory_settings(use_empty=True)
    if not hasattr(bpy.types.Object, "toile"):
        toile.blender_addon.register()
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))


def body() -> bpy.types.Object:
    """Make a ball with a neck whose bone moves it, the avatar."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=16, radius=0.25, location=(0.0, 0.0, 1.0))
    ball = bpy.context.object
    ball.name = "Body"
    # Blender orders the faces of its spheres anew in every process.
    faces = sorted(tuple(polygon.vertices) for polygon in ball.data.polygons)
    places = [vertex.co.copy() for vertex in ball.data.vertices]
    ball.data.clear_geometry()
    ball.data.from_pydata(places, [], faces)
    bpy.ops.object.armature_add(location=(0.0, 0.0, 0.6))
    armature = bpy.context.object
    group = ball.vertex_groups.new(name="Bone")
    group.add(range(len(ball.data.vertices)), 1.0, "REPLACE")
    ball.modifiers.new("Armature", "ARMATURE").object = armature
    bone = armature.pose.bones["Bone"]
    bone.rotation_mode = "XYZ"
    for frame, angle in ((1, 0.0), (FRAMES, 1.2)):
        bone.rotation_euler = (angle, 0.0, 0.0)
        bone.keyframe_insert("rotation_euler", frame=frame)
    ball.toile.role = "AVATAR"
    return ball


def sheet() -> bpy.types.Object:
    """Make a sheet above the body, the garment: turned and scaled, with materials, UVs, groups and more."""
    bpy.ops.mesh.primitive_grid_add(size=1.0, x_subdivisions=8, y_subdivisions=8)
    garment = bpy.context.object
    garment.name = "My Shawl"
    garment.location, garment.rotation_euler, garment.scale = (
        (0.05, 0.0, 1.262),
        (0.0, 0.0, 0.3),
        (0.8, 0.8, 1.0),
    )
    mesh = garment.data
    for name in ("Red", "Blue"):
        mesh.materials.append(bpy.data.materials.new(name))
    here = np.array([vertex.co for vertex in mesh.vertices])
    centre = np.array([polygon.center for polygon in mesh.polygons])
    mesh.polygons.foreach_set("material_index", (centre[:, 0] > 0.0).astype(np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    group = garment.vertex_groups.new(name="weight")
    for index, place in enumerate(here):
        group.add([index], float(place[0] + 0.5), "REPLACE")
    height = mesh.attributes.new("height", "FLOAT", "POINT")
    height.data.foreach_set("value", (here[:, 1] + 0.5).astype(np.float32))
    number = mesh.attributes.new("number", "INT", "FACE")
    number.data.foreach_set("value", np.arange(len(mesh.polygons), dtype=np.int32))
    colour = mesh.attributes.new("colour", "FLOAT_COLOR", "CORNER")
    own = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers["UVMap"].data.foreach_get("uv", own)
    table = np.column_stack([own.reshape(-1, 2), np.zeros(len(mesh.loops)), np.ones(len(mesh.loops))])
    colour.data.foreach_set("color", table.astype(np.float32).ravel())
    garment.toile.role, garment.toile.warp_map = "GARMENT", "UVMap"
    return garment


def settings(mode: str) -> None:
    """Set a coarse, short run."""
    own = bpy.context.scene.toile
    own.mode, own.quality, own.size_min, own.size_max = mode, "preview", SIZE, 0.4
    own.frame_start, own.frame_end = 1, FRAMES


def write_scene(folder: Path) -> None:
    """Write what the engine reads."""
    from toile.blender_addon.snapshot import cast, scene_folder

    for _ in scene_folder.write_scene(bpy.context, folder, cast.casts(bpy.context)[0][0]):
        pass


def frames_folder(obj: bpy.types.Object) -> Path:
    """Return the folder of the frames that an object shows."""
    modifier = obj.modifiers["toile"]
    path = modifier.filepath if modifier.type == "MESH_CACHE" else modifier.cache_file.filepath
    return Path(bpy.path.abspath(path)).parent


class Stub:
    """Counts the runs of `stub_engine`, and notes its tasks."""

    runs = 0
    tasks: ClassVar[list[str]] = []


def stub_engine() -> None:
    """Let a stub stand for the engine that dresses: its n-th run gives one frame, a strip of n triangles."""
    from toile.blender_addon import dressing

    # Frames need Blender's own USD, unless there is another.
    bpy.utils.expose_bundled_modules()
    engine = dressing._spoken

    def spoken(task: str, folder: Path, run: object) -> Iterator[dict[str, object] | None]:
        from toile.blender_addon.engine_side.usd_frame import write_usd_frame

        Stub.tasks.append(task)
        if task != "dress":
            yield from engine(task, folder, run)
            return
        Stub.runs += 1
        for entry in json.loads((folder / "job.json").read_text())["garments"]:
            strip = np.array([(0.1 * corner, corner % 2, 0.0) for corner in range(Stub.runs + 2)])
            faces = np.add.outer(np.arange(Stub.runs), np.arange(3)).astype(np.int32)
            write_usd_frame(Path(entry["cache"]) / f"{entry['stem']}.usdc", strip, faces, None, [])
            (Path(entry["cache"]) / "toile.json").write_text("{}")
        yield {"frame": 1}
        yield {"done": {}}

    dressing._spoken = spoken


def shown(obj: bpy.types.Object, frame: int) -> bpy.types.Mesh:
    """Return what an object shows in a frame; valid until the next call."""
    bpy.context.scene.frame_set(frame)
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()


def points(mesh: bpy.types.Mesh) -> np.ndarray:
    """Return vertices, shape (n, 3)."""
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3)


def values(mesh: bpy.types.Mesh, name: str, field: str, width: int = 1) -> np.ndarray:
    """Return an attribute, shape (k, width)."""
    data = mesh.attributes[name].data
    flat = np.empty(width * len(data), np.float32 if field != "value" else np.float64)
    data.foreach_get(field, flat)
    return flat.reshape(-1, width)
