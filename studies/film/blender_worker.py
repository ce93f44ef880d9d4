"""Blender's cloth on a garment and a moving body from a file; run by Blender's Python, without toile.

python blender_worker.py JOB.npz FILM.npz

JOB holds positions (n, 3) and faces (t, 3) of the cloth at rest, body (k, v, 3) and body_faces (f, 3) over k
frames, all in metres with Y up, fps, and `settings`, JSON of what to set in Blender's cloth settings
("cloth"), cloth collision settings ("collision") and collider ("collider"). FILM gets positions (k, n, 3),
the CPU time of the frames [s] and Blender's version.
"""

import json
import os
import struct
import sys
from time import process_time
from typing import Any

import numpy as np

GRAVITY = 9.81
UNIT = 1000.0**-0.5
"""Blender's unit of time [s]: it multiplies gravity by 0.001 and takes one unit per frame."""


def start_blender(folder: str) -> Any:
    """Load Blender, alone on one core, without anybody's preferences; return its module."""
    if hasattr(os, "sched_setaffinity"):
        # One core, hence one thread: threads that wait for work would count as CPU time.
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    os.environ["BLENDER_USER_RESOURCES"] = os.path.join(folder, "resources")
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy


def add_mesh(bpy: Any, name: str, positions: Any, faces: Any) -> Any:
    """Add a mesh to the scene, in the coordinates given."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(positions.tolist(), [], faces.tolist())
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def set_all(target: Any, values: dict[str, Any]) -> None:
    """Set properties."""
    for name, value in values.items():
        setattr(target, name, value)


def follow_poses(thing: Any, poses: Any, path: str) -> None:
    """Let a mesh follow poses (k, v, 3), one per frame from frame 1 on, by way of a point cache file."""
    with open(path, "wb") as stream:
        stream.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, poses.shape[1], 1.0, 1.0, len(poses)))
        stream.write(np.ascontiguousarray(poses, "<f4").tobytes())
    cache = thing.modifiers.new("poses", "MESH_CACHE")
    cache.cache_format, cache.filepath = "PC2", path
    # The file is read as it is, without Blender's idea of which way is up.
    cache.forward_axis, cache.up_axis = "POS_Y", "POS_Z"
    cache.frame_start = 1.0


def build(bpy: Any, job: Any, folder: str) -> Any:
    """Build the scene; return the cloth object."""
    settings = json.loads(str(job["settings"]))
    scene = bpy.context.scene
    scene.use_gravity, scene.gravity = True, (0.0, -GRAVITY, 0.0)
    scene.frame_start, scene.frame_end = 1, len(job["body"])
    body = add_mesh(bpy, "body", job["body"][0], job["body_faces"])
    follow_poses(body, job["body"], os.path.join(folder, "body.pc2"))
    body.modifiers.new("collision", "COLLISION")
    set_all(body.collision, settings["collider"])
    garment = add_mesh(bpy, "garment", job["positions"], job["faces"])
    cloth = garment.modifiers.new("cloth", "CLOTH")
    set_all(cloth.settings, settings["cloth"])
    cloth.settings.time_scale = 1.0 / (float(job["fps"]) * UNIT)
    set_all(cloth.collision_settings, settings["collision"])
    cloth.point_cache.frame_start, cloth.point_cache.frame_end = 1, scene.frame_end
    return garment


def positions_of(bpy: Any, thing: Any) -> Any:
    """Return the vertices of an object as its modifiers leave it [m], shape (n, 3)."""
    mesh = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3)


def main() -> None:
    """Run the job of the first argument and write the second."""
    job = np.load(sys.argv[-2])
    folder = os.path.dirname(os.path.abspath(sys.argv[-1]))
    bpy = start_blender(folder)
    garment = build(bpy, job, folder)
    scene = bpy.context.scene
    scene.frame_set(1)
    body = positions_of(bpy, bpy.data.objects["body"])
    if np.abs(body - job["body"][0]).max() > 1e-4:
        raise ValueError("Blender reads the poses of the body in other axes")
    frames, cpu = [positions_of(bpy, garment)], 0.0
    for frame in range(2, scene.frame_end + 1):
        started = process_time()
        scene.frame_set(frame)
        cpu += process_time() - started
        frames.append(positions_of(bpy, garment))
    np.savez(sys.argv[-1], positions=np.array(frames), cpu=cpu, blender=bpy.app.version_string)
    bpy.ops.wm.read_factory_settings(use_empty=True)


if __name__ == "__main__":
    main()
