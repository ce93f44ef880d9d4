"""Write one body in every format and with many options; print the triangles that Blender itself shows.

The argument is a folder to write into. A posed figure of two bones with a shape key, turned, scaled and
moved, goes into glTF; the same figure as it stands into OBJ, PLY and STL.
"""

import json
import sys
from itertools import product
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector

folder = Path(sys.argv[1])
random = np.random.default_rng(5)
bpy.ops.wm.read_factory_settings(use_empty=True)


def figure() -> bpy.types.Object:
    """A blob of 80 triangles on two bones."""
    data = bpy.data.armatures.new("bones")
    armature = bpy.data.objects.new("bones", data)
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    lower, upper = data.edit_bones.new("lower"), data.edit_bones.new("upper")
    lower.head, lower.tail, upper.head, upper.tail = (0, 0, -1), (0, 0, 0), (0, 0, 0), (0, 0, 1)
    upper.parent = lower
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=1.0, calc_uvs=True)
    body = bpy.context.object
    mesh = body.data
    for vertex in mesh.vertices:
        vertex.co *= random.uniform(0.6, 1.0)
    mesh.materials.append(bpy.data.materials.new("skin"))
    body.parent = armature
    groups = [body.vertex_groups.new(name=name) for name in ("lower", "upper")]
    for vertex in mesh.vertices:
        share = float(np.clip(0.5 + 0.5 * vertex.co.z, 0.0, 1.0))
        groups[0].add([vertex.index], 1.0 - share, "REPLACE")
        groups[1].add([vertex.index], share, "REPLACE")
    body.shape_key_add(name="Basis")
    key = body.shape_key_add(name="stout")
    for point in key.data:
        point.co += 0.2 * Vector(random.normal(size=3))
    key.value = 0.5
    body.modifiers.new("bones", "ARMATURE").object = armature
    armature.pose.bones["upper"].rotation_mode = "XYZ"
    armature.pose.bones["upper"].rotation_euler = (0.5, 0.2, -0.3)
    armature.matrix_world = (
        Matrix.Translation((0.3, -0.8, 1.1))
        @ Euler((0.2, -0.4, 0.9)).to_matrix().to_4x4()
        @ Matrix.Scale(0.7, 4)
    )
    return body


def shown(body: bpy.types.Object) -> list[list[list[float]]]:
    """Corners of the triangles in the world, Z up."""
    seen = body.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = seen.to_mesh()
    mesh.calc_loop_triangles()
    places = [seen.matrix_world @ vertex.co for vertex in mesh.vertices]
    return [[list(places[v]) for v in triangle.vertices] for triangle in mesh.loop_triangles]


body = figure()
bpy.context.view_layer.update()
found: dict[str, object] = {"triangles": shown(body), "y_up": [], "z_up": []}


def write(kind: str, place: str, operator: object, suffix: str, **options: object) -> None:
    name = f"{kind}_{len(found['y_up']) + len(found['z_up'])}.{suffix}"
    operator(filepath=str(folder / name), **options)
    found[place].append([name, json.dumps(options)])


gltf = bpy.ops.export_scene.gltf
for form, flags in product(
    ("GLB", "GLTF_SEPARATE"),
    (
        {}, {"export_normals": False, "export_texcoords": False}, {"export_materials": "NONE"},
        {"export_try_sparse_sk": True}, {"export_hierarchy_flatten_objs": True}, {"export_def_bones": True},
        {"export_influence_nb": 2}, {"export_shared_accessors": True}, {"use_visible": True},
        {"export_armature_object_remove": True},
    ),
):  # fmt: skip
    write(
        "gltf",
        "y_up",
        gltf,
        "glb" if form == "GLB" else "gltf",
        export_format=form,
        export_rest_position_armature=False,
        **flags,
    )
write("gltf", "z_up", gltf, "glb", export_yup=False, export_rest_position_armature=False)
for flags in (
    {}, {"export_normals": False}, {"export_uv": False}, {"export_materials": False},
    {"export_smooth_groups": True}, {"export_object_groups": True}, {"export_vertex_groups": True},
    {"export_material_groups": True},
    {"export_colors": True}, {"export_triangulated_mesh": True}, {"path_mode": "STRIP"},
):  # fmt: skip
    write("obj", "y_up", bpy.ops.wm.obj_export, "obj", **flags)
write("obj", "z_up", bpy.ops.wm.obj_export, "obj", forward_axis="Y", up_axis="Z")
for text, flags in product(
    (False, True),
    (
        {},
        {"export_normals": True},
        {"export_uv": True},
        {"export_colors": "LINEAR"},
        {"export_triangulated_mesh": True},
    ),
):
    write("ply", "z_up", bpy.ops.wm.ply_export, "ply", ascii_format=text, **flags)
write("ply", "y_up", bpy.ops.wm.ply_export, "ply", forward_axis="NEGATIVE_Z", up_axis="Y")
for text in (False, True):
    write("stl", "z_up", bpy.ops.wm.stl_export, "stl", ascii_format=text)
write("stl", "y_up", bpy.ops.wm.stl_export, "stl", forward_axis="NEGATIVE_Z", up_axis="Y")
print(json.dumps(found))
