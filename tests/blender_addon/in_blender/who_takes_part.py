"""Who takes part: what is hidden, selected, instanced, linked, of another character; floors; what is said."""

import io
import json
import sys
from contextlib import redirect_stdout
from pathlib import Path

import bpy
import small_scene as small

import toile.blender_addon
from toile.blender_addon.snapshot.cast import casts

folder = Path(sys.argv[1])
small.empty_file(folder)
scene, layer = bpy.context.scene, bpy.context.view_layer
found = {}


def ball(name: str, x: float, radius: float = 0.25) -> bpy.types.Object:
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=radius, location=(x, 0.0, 1.0))
    made = bpy.context.object
    made.name, made.toile.role = name, "AVATAR"
    return made


def cloth(name: str, x: float, z: float = 1.26) -> bpy.types.Object:
    bpy.ops.mesh.primitive_grid_add(size=0.5, x_subdivisions=5, y_subdivisions=5, location=(x, 0.0, z))
    made = bpy.context.object
    made.name, made.toile.role = name, "GARMENT"
    return made


def select(*objects: bpy.types.Object) -> None:
    for obj in layer.objects:
        obj.select_set(obj in objects)


def who(**options: bool) -> list[list[str]]:
    return [
        [part.obj.name for part in cast.avatars] + [obj.name for obj in cast.garments]
        for cast in casts(bpy.context, **options)[0]
    ]


def left_out() -> list[str]:
    return casts(bpy.context)[1]


def message(**options: bool) -> str:
    try:
        bpy.ops.toile.dress(**options)
    except RuntimeError as error:
        return str(error).strip()
    return ""


def warnings() -> list[str]:
    """Dress, and return the warnings."""
    printed = io.StringIO()
    with redirect_stdout(printed):
        bpy.ops.toile.dress()
    return [line.removeprefix("Warning: ") for line in printed.getvalue().splitlines() if "Warning" in line]


def lowest(obj: bpy.types.Object) -> float:
    """Return the height of the lowest vertex in the world."""
    mesh = small.shown(obj, 1)
    return float(min((obj.matrix_world @ vertex.co).z for vertex in mesh.vertices))


def shape(obj: bpy.types.Object) -> str:
    return small.points(small.shown(obj, 1)).tobytes().hex()


# One character, then a second one: each by itself.
small.settings("DRAPE")
anna, scarf = ball("Anna", 0.0), cloth("Scarf", 0.0)
found["alone"] = who()
bpy.ops.toile.dress()
alone = shape(scarf)
first = small.frames_folder(scarf)
bert, coat = ball("Bert", 2.0), cloth("Coat", 2.0)
found["together"] = who()
select(coat, bert)
found["selected"] = who(only_selected=True)
bpy.ops.toile.dress(only_selected=True)
found["first untouched"] = small.frames_folder(scarf) == first and shape(scarf) == alone
found["second dressed"] = small.frames_folder(coat).is_dir()
select(anna)
found["no garment selected"] = message(only_selected=True)
scarf.toile.body, coat.toile.body = anna, bert
bpy.ops.mesh.primitive_plane_add(size=6.0)
floor = bpy.context.object
floor.name = "Floor"
floor.toile.role = "AVATAR"
bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.05, location=(0.0, 0.0, 1.24))
hat = bpy.context.object
hat.name, hat.toile.role, hat.toile.body = "Hat", "AVATAR", anna
found["by character"] = who()
extra = cloth("Extra", 0.0, 1.5)
found["one without a body"] = who()
bpy.data.objects.remove(extra)
bpy.data.objects.remove(hat)
bpy.data.objects.remove(floor)
bpy.ops.toile.dress()
found["first as alone"] = shape(scarf) == alone

# Hidden in every way: named, and left out.
found["hidden"] = {}
for way in ("hide_viewport", "eye", "excluded"):
    parked = bpy.data.collections.new("Parked")
    scene.collection.children.link(parked)
    scene.collection.objects.unlink(coat)
    parked.objects.link(coat)
    if way == "hide_viewport":
        coat.hide_viewport = True
    elif way == "eye":
        coat.hide_set(True)
    else:
        layer.layer_collection.children["Parked"].exclude = True
    found["hidden"][way] = [who(), left_out()]
    coat.hide_viewport = False
    if way == "eye":
        coat.hide_set(False)
    parked.objects.unlink(coat)
    bpy.data.collections.remove(parked)
    scene.collection.objects.link(coat)
found["shown again"] = who()
anna.hide_viewport = bert.hide_viewport = True
found["no body"] = message()
anna.hide_viewport = bert.hide_viewport = False
bpy.data.objects.remove(coat)
bpy.data.objects.remove(bert)

# A body that an armature moves and that is an instance of a collection.
people = bpy.data.collections.new("People")
scene.collection.objects.unlink(anna)
people.objects.link(anna)
holder = bpy.data.objects.new("Holder", None)
holder.instance_type, holder.instance_collection = "COLLECTION", people
holder.location.z = 0.3
scene.collection.objects.link(holder)
scarf.toile.body = None
scarf.location.z = 1.57
found["instance"] = who()
bpy.ops.toile.dress()
found["lowest on instance"] = lowest(scarf)

# A floor.
bpy.data.objects.remove(holder)
bpy.ops.mesh.primitive_plane_add(size=2.0, location=(0.0, 0.0, 1.0), rotation=(0.2, 0.0, 0.0))
floor = bpy.context.object
floor.name, floor.toile.role, scarf.location.z = "Floor", "AVATAR", 1.3
found["floor says"] = warnings()
found["notes"] = scarf.toile.notes.splitlines()
mesh = small.shown(scarf, 1)
normal = floor.matrix_world.to_3x3().col[2]
found["above floor"] = min(
    float((scarf.matrix_world @ vertex.co - floor.location).dot(normal)) for vertex in mesh.vertices
)
found["on floor"] = lowest(scarf)
floor.data.flip_normals()
bpy.ops.toile.dress()
mesh = small.shown(scarf, 1)
found["above turned floor"] = min(
    float((scarf.matrix_world @ vertex.co - floor.location).dot(normal)) for vertex in mesh.vertices
)
bpy.data.objects.remove(floor)
bpy.ops.mesh.primitive_grid_add(size=2.0, x_subdivisions=4, y_subdivisions=4, location=(0.0, 0.0, 1.0))
floor = bpy.context.object
floor.name, floor.toile.role = "Floor", "AVATAR"
for polygon in list(floor.data.polygons)[:8]:
    polygon.flip()
floor.data.update()
found["both sides"] = message()
bpy.data.objects.remove(floor)

# What the engine says, in Blender's axes and names.
scene.collection.objects.link(anna)
scarf.location = (0.0, 20.0, 1.3)
found["away"] = message()
scarf.location = (0.0, 0.0, 30.0)
found["above"] = message()
scarf.location = (0.0, 0.0, 1.26)
bpy.context.view_layer.objects.active = anna
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.mesh.select_all(action="DESELECT")
bpy.ops.object.mode_set(mode="OBJECT")
low = min(anna.data.vertices, key=lambda vertex: vertex.co.y)
low.select = True
hole = anna.matrix_world @ low.co
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.mesh.delete(type="VERT")
bpy.ops.object.mode_set(mode="OBJECT")
found["hole says"], found["hole"] = warnings(), list(hole)

# Linked and overridden, saved and opened again.
bpy.data.objects.remove(scarf)
bpy.ops.wm.save_as_mainfile(filepath=str(folder / "people.blend"))
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.save_as_mainfile(filepath=str(folder / "shot.blend"))
with bpy.data.libraries.load(str(folder / "people.blend"), link=True) as (_, wanted):
    wanted.objects = ["Anna"]
linked = wanted.objects[0]
bpy.context.scene.collection.objects.link(linked)
bpy.context.view_layer.objects.active = linked
try:
    bpy.ops.toile.set_role(role="NONE")
except RuntimeError as error:
    found["linked role"] = str(error).strip()
own = linked.override_create()
bpy.context.scene.collection.objects.unlink(linked)
bpy.context.scene.collection.objects.link(own)
bpy.context.view_layer.objects.active = own
bpy.ops.toile.set_role(role="NONE")
own.toile.layer = 7
found["override set"] = own.toile.role
bpy.ops.wm.save_mainfile()
bpy.ops.wm.open_mainfile(filepath=str(folder / "shot.blend"))
own = next(obj for obj in bpy.data.objects if obj.library is None and obj.name.startswith("Anna"))
found["override kept"] = [own.override_library is not None, own.toile.role, own.toile.layer]
bpy.context.view_layer.objects.active = own
bpy.ops.toile.set_role(role="GARMENT")
small.settings("DRAPE")
own.modifiers.new("Subdivision", "SUBSURF")
ball("Inner", 0.0, 0.2)
small.stub_engine()
found["override garment"] = [
    who(),
    message(),
    [modifier.name for modifier in own.modifiers],
    len(small.shown(own, 1).polygons) // 3,
]
bpy.ops.wm.save_mainfile()
bpy.ops.wm.open_mainfile(filepath=str(folder / "shot.blend"))
own = next(obj for obj in bpy.data.objects if obj.library is None and obj.name.startswith("Anna"))
found["override frames kept"] = [own.toile.role, own.toile.state, len(small.shown(own, 1).polygons) // 3]
toile.blender_addon.unregister()
print(json.dumps(found))
