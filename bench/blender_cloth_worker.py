"""Blender's cloth on a scene from a file; run by Blender's Python, which knows nothing of toile.

python bench/blender_cloth_worker.py SCENE.npz OUT.npz

SCENE holds positions (n, 3), polygons (q, 3 or 4), pinned (n,), ball_positions (v, 3) and ball_faces
(t, 3), perhaps empty, frames, frame_seconds and `settings`, JSON of {"cloth": ..., "collision": ...,
"collider": ...}, what to set in Blender's cloth settings, cloth collision settings and collider. OUT gets
positions (frames + 1, n, 3), the triangles that Blender collides (t, 3), the CPU time of the frames [s], in
how many of them its linear solver stopped at its iteration limit, and the versions.
"""

import json
import os
import sys
from time import process_time

if hasattr(os, "sched_setaffinity"):
    # One core, hence one thread: threads that wait for work would count as CPU time.
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
# Somebody's preferences and add-ons shall not take part.
os.environ["BLENDER_USER_RESOURCES"] = os.path.join(os.path.dirname(sys.argv[2]), "resources")

import bpy
import numpy as np

GRAVITY = 9.81
UNIT = 1000.0**-0.5
"""Blender's unit of time [s]: it multiplies gravity by 0.001 and takes one unit per frame."""


def add_mesh(name, positions, faces):
    """A mesh object in the scene, in the coordinates given."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(positions.tolist(), [], faces.tolist())
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def assign(target, values):
    """Set properties, and check that Blender took them as they are: it clamps what is out of range."""
    for name, value in values.items():
        setattr(target, name, value)
        taken = getattr(target, name)
        if isinstance(value, float) and abs(taken - value) > 1e-6 * abs(value):
            raise ValueError(f"{name} = {value} became {taken}")


def build(given):
    """Make the scene; return the cloth object."""
    settings = json.loads(str(given["settings"]))
    scene = bpy.context.scene
    scene.use_gravity, scene.gravity = True, (0.0, -GRAVITY, 0.0)
    scene.frame_start, scene.frame_end = 1, int(given["frames"]) + 1
    scene.frame_set(1)
    if len(given["ball_faces"]):
        ball = add_mesh("ball", given["ball_positions"], given["ball_faces"])
        ball.modifiers.new("collision", "COLLISION")
        assign(ball.collision, settings["collider"])
    sheet = add_mesh("sheet", given["positions"], given["polygons"])
    cloth = sheet.modifiers.new("cloth", "CLOTH")
    if given["pinned"].any():
        group = sheet.vertex_groups.new(name="pinned")
        group.add(np.flatnonzero(given["pinned"]).tolist(), 1.0, "REPLACE")
        cloth.settings.vertex_group_mass = "pinned"
    assign(cloth.settings, settings["cloth"])
    cloth.settings.time_scale = float(given["frame_seconds"]) / UNIT
    assign(cloth.collision_settings, settings["collision"])
    cloth.point_cache.frame_start, cloth.point_cache.frame_end = 1, scene.frame_end
    return sheet


def positions_of(thing):
    """Vertices of an object as the modifiers leave it [m], shape (n, 3)."""
    mesh = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3)


def stopped_short(thing):
    """Whether the linear solver stopped at its iteration limit in a step of the last frame."""
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return "NO_CONVERGENCE" in evaluated.modifiers["cloth"].solver_result.status


def main():
    given = np.load(sys.argv[1])
    bpy.ops.wm.read_factory_settings(use_empty=True)
    sheet = build(given)
    sheet.data.calc_loop_triangles()
    triangles = np.empty(3 * len(sheet.data.loop_triangles), np.int32)
    sheet.data.loop_triangles.foreach_get("vertices", triangles)
    scene = bpy.context.scene
    scene.frame_set(1)
    frames, cpu, short = [positions_of(sheet)], 0.0, 0
    for frame in range(2, scene.frame_end + 1):
        started = process_time()
        scene.frame_set(frame)
        cpu += process_time() - started
        frames.append(positions_of(sheet))
        short += stopped_short(sheet)
    np.savez(
        sys.argv[2],
        positions=np.array(frames),
        triangles=triangles.reshape(-1, 3),
        cpu=cpu,
        short=short,
        blender=bpy.app.version_string,
        python=sys.version.split()[0],
    )
    bpy.ops.wm.read_factory_settings(use_empty=True)


if __name__ == "__main__":
    main()
