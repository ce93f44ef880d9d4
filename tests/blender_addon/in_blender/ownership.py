"""Whose frames an object shows: after copies, renames, removals, saving under another name, and clearing."""

import json
import shutil
import sys
from pathlib import Path

import bpy
import small_scene as small

folder = Path(sys.argv[1])
small.empty_file(folder)
small.stub_engine()
small.body()
scene = bpy.context.scene
small.settings("DRAPE")


def grid(name: str) -> bpy.types.Object:
    bpy.ops.mesh.primitive_grid_add(size=0.5, x_subdivisions=3, y_subdivisions=3, location=(0.0, 0.0, 1.3))
    made = bpy.context.object
    made.name, made.toile.role = name, "GARMENT"
    return made


def dress(*objects: bpy.types.Object) -> None:
    for obj in bpy.data.objects:
        if obj.name in bpy.context.view_layer.objects:
            obj.select_set(obj in objects)
    bpy.ops.toile.dress(only_selected=True)


def faces(obj: bpy.types.Object) -> int:
    """Return how many faces an object shows: the number of the run whose frames these are."""
    return len(small.shown(obj, 1).polygons)


def clear(obj: bpy.types.Object) -> None:
    bpy.context.view_layer.objects.active = obj
    bpy.ops.toile.clear()


found = {}
cloth = grid("Cloth")
dress(cloth)

# Copies, in every way.
bpy.ops.object.duplicate()
copy = bpy.context.object
cloth.select_set(True)
copy.select_set(False)
bpy.context.view_layer.objects.active = cloth
bpy.ops.object.duplicate(linked=True)
linked = bpy.context.object
found["copies show"] = [faces(obj) for obj in (cloth, copy, linked)]
dress(copy)
dress(linked)
found["each shows its own"] = [faces(obj) for obj in (cloth, copy, linked)]
dress(cloth)
dress(cloth)
found["dressed again"] = [faces(obj) for obj in (cloth, copy, linked)]
clear(copy)
found["one cleared"] = [faces(obj) for obj in (cloth, copy, linked)]

# A copy that still shows the frames of another, which is cleared.
for obj in bpy.data.objects:
    obj.select_set(obj == cloth)
bpy.context.view_layer.objects.active = cloth
bpy.ops.object.duplicate()
second = bpy.context.object
before = faces(second)
clear(cloth)
found["the other cleared"] = [faces(cloth), faces(second) == before]

# The whole scene copied.
dress(second)
before = faces(second)
bpy.ops.scene.new(type="FULL_COPY")
twin = bpy.context.scene.objects[list(scene.objects).index(second)]
dress(twin)
found["scene copied"] = [bpy.context.scene != scene, faces(twin) - before]
bpy.ops.scene.delete()
found["scene copied"].append(faces(second) == before and bpy.context.scene == scene)

# Removed, and another of the same name.
dress(cloth)
name = cloth.name
bpy.data.objects.remove(cloth)
cloth = grid(name)
dress(cloth)
found["same name"] = [faces(cloth), cloth.name == name]
bpy.ops.toile.dress()
found["cache files"] = [len(bpy.data.cache_files), sum("toile" in obj.modifiers for obj in bpy.data.objects)]
for obj in (copy, linked, second):
    bpy.data.objects.remove(obj)

# Names that differ in punctuation only.
one, other = grid("Shirt.001"), grid("Shirt_001")
dress(one)
dress(other)
found["punctuation"] = [faces(one), faces(other)]
clear(one)
found["punctuation cleared"] = faces(other)

# Renamed.
shown = faces(other)
other.name = "Coat"
place = small.frames_folder(other)
found["renamed"] = faces(other) == shown
dress(other)
dress(other)
found["renamed goes"] = [place.is_dir(), small.frames_folder(other).parent.name]

# Saved under another name: both files show the frames, until one of them is gone.
place, shown = small.frames_folder(other), faces(other)
bpy.ops.wm.save_mainfile()
bpy.ops.wm.save_as_mainfile(filepath=str(folder / "second.blend"))
clear(other)
found["another file shows them"] = [place.is_dir(), faces(other)]
bpy.ops.wm.open_mainfile(filepath=str(folder / "scene.blend"))
other = bpy.data.objects["Coat"]
found["first file"] = faces(other) == shown
(folder / "second.blend").unlink()
clear(other)
found["no other file shows them"] = place.is_dir()

# The .blend file was renamed by the user.
dress(other)
place, shown = small.frames_folder(other), faces(other)
bpy.ops.wm.save_mainfile()
bpy.ops.wm.read_factory_settings(use_empty=True)
shutil.move(folder / "scene.blend", folder / "renamed.blend")
bpy.ops.wm.open_mainfile(filepath=str(folder / "renamed.blend"))
other = bpy.data.objects["Coat"]
found["file renamed"] = faces(other) == shown
clear(other)
found["file renamed cleared"] = place.is_dir()

# Orphans go when the file is saved in a later session; frames that are gone are said to be.
dress(other)
lost = small.frames_folder(other)
bpy.ops.wm.save_mainfile()
bpy.data.objects.remove(other)
third = grid("Third")
dress(third)
bpy.ops.wm.save_mainfile()
found["orphan stays for undo"] = lost.is_dir()
kept = small.frames_folder(third)
from toile.blender_addon.frame_folders import _Session

_Session.made.clear()
bpy.ops.wm.open_mainfile(filepath=str(folder / "renamed.blend"))
bpy.ops.wm.save_mainfile()
found["orphan goes"] = [lost.is_dir(), kept.is_dir()]
shutil.rmtree(kept)
bpy.ops.wm.open_mainfile(filepath=str(folder / "renamed.blend"))
found["missing"] = bpy.data.objects["Third"].toile.state

# Undo leads back to the frames of the run before.
third = bpy.data.objects["Third"]
dress(third)
shown = faces(third)
bpy.ops.ed.undo_push(message="one")
dress(third)
bpy.ops.ed.undo_push(message="two")
bpy.ops.ed.undo()
found["undo"] = faces(bpy.data.objects["Third"]) == shown

# Appended into another file, twice.
bpy.ops.wm.save_mainfile()
place = small.frames_folder(bpy.data.objects["Third"])
bpy.ops.wm.read_factory_settings(use_empty=True)
(folder / "elsewhere").mkdir()
bpy.ops.wm.save_as_mainfile(filepath=str(folder / "elsewhere" / "other.blend"))
for _ in range(2):
    bpy.ops.wm.append(directory=str(folder / "renamed.blend" / "Object"), filename="Third")
small.body()
bpy.context.scene.toile.size_min = 0.05
garments = [obj for obj in bpy.data.objects if obj.toile.role == "GARMENT"]
found["appended"] = [faces(obj) == shown for obj in garments]
dress(garments[0])
dress(garments[1])
found["appended dressed"] = faces(garments[1]) - faces(garments[0])
clear(garments[0])
found["appended cleared"] = [place.is_dir(), faces(garments[1]) == small.Stub.runs]
import toile.blender_addon

toile.blender_addon.unregister()
print(json.dumps(found))
