"""Frames on disk as what the object shows, through Blender's own modifiers; its mesh stays as it is."""

from pathlib import Path
from typing import Any

import bmesh
import bpy

from toile.blender_addon.attribute_nodes import is_nodes, put_back, remove_nodes
from toile.blender_addon.fit_nodes import hide_fit
from toile.blender_addon.frame_folders import MARK, relative, remove_orphans, replaced, shown_folder
from toile.blender_addon.problem import Problem

NAME = "toile"
"""Name of the modifier that shows the frames."""
PRIM = "/garment"
GONE = "missing on disk: dress it again"
"""State of a garment whose frames somebody removed."""
REFINING = {
    "SUBSURF", "MULTIRES", "SOLIDIFY", "BEVEL", "NODES", "SMOOTH", "CORRECTIVE_SMOOTH", "WEIGHTED_NORMAL"
}  # fmt: skip
"""Modifiers that the cloth is refined by, and not made from."""


def is_ours(modifier: Any) -> bool:
    """Whether a modifier shows toile's frames."""
    return modifier.name == NAME and modifier.type in ("MESH_SEQUENCE_CACHE", "MESH_CACHE")


def our_modifier(obj: Any) -> Any:
    """Return the modifier that shows the frames of an object, or None."""
    return next((modifier for modifier in obj.modifiers if is_ours(modifier)), None)


def show_frames(obj: Any, folder: Path, entry: dict[str, Any], first_frame: int, sequence: bool) -> None:
    """Let an object show the frames in a folder, which may still grow; `entry` is its own of the job."""
    stem = entry["stem"]
    before = shown_folder(obj, our_modifier(obj))
    if obj.toile.keep_topology:
        modifier = _placed(obj, "MESH_CACHE")
        modifier.cache_format = "PC2"
        modifier.filepath = relative(folder / f"{stem}.pc2")
        modifier.frame_start = float(first_frame)
        remove_nodes(obj)
    else:
        modifier = _placed(obj, "MESH_SEQUENCE_CACHE")
        name = f"{stem}_{first_frame:04d}.usdc" if sequence else f"{stem}.usdc"
        # Copies of an object share its cache file: every run gets one of its own.
        modifier.cache_file = _opened(folder / name, sequence)
        modifier.object_path = PRIM
        modifier.read_data = {"VERT", "POLY", "UV", "COLOR", "ATTRIBUTES"}
        put_back(obj, modifier, entry["carriers"])
    remove_orphans()
    replaced(before, folder)
    obj.update_tag()


def remove_modifier(obj: Any) -> Path | None:
    """Let an object show its own mesh again; return the folder of the frames that it showed."""
    modifier = our_modifier(obj)
    folder = shown_folder(obj, modifier)
    if modifier is not None:
        obj.modifiers.remove(modifier)
        remove_nodes(obj)
        hide_fit(obj)
        remove_orphans()
    return folder


def note_missing() -> None:
    """Say of garments that their frames are gone, where they are."""
    for obj in bpy.data.objects:
        folder = shown_folder(obj, our_modifier(obj)) if obj.library is None else None
        if folder is not None and not folder.is_dir():
            obj.toile.state = GONE


def made_real(obj: Any, context: Any) -> None:
    """Make what an object shows in the present frame its mesh; modifiers below toile's stay."""
    ours = our_modifier(obj)
    if ours is None:
        raise Problem(f"'{obj.name}' shows no frames of toile: dress it first")
    index = list(obj.modifiers).index(ours)
    above = list(obj.modifiers)[:index]
    below = [modifier for modifier in list(obj.modifiers)[index + 1 :] if not is_nodes(modifier)]
    off = [modifier for modifier in below if modifier.show_viewport]
    for modifier in off:
        modifier.show_viewport = False
    depsgraph = context.evaluated_depsgraph_get()
    holder = obj.evaluated_get(depsgraph)
    mesh = bpy.data.meshes.new_from_object(holder, preserve_all_data_layers=True, depsgraph=depsgraph)
    for modifier in off:
        modifier.show_viewport = True
    remove_modifier(obj)
    for modifier in above:
        obj.modifiers.remove(modifier)
    mesh.name = obj.data.name
    obj.data.use_fake_user = True
    obj.data = mesh


def select_faces(obj: Any, faces: tuple[int, ...]) -> None:
    """Select polygons of an object's own mesh, and nothing else in it; in edit mode, nothing is done."""
    if obj.data.is_editmode:
        return
    # Blender 5.0 crashes where `select` of a mesh is set in which nothing was ever selected.
    editable = bmesh.new()
    try:
        editable.from_mesh(obj.data)
        for elements in (editable.verts, editable.edges, editable.faces):
            for element in elements:
                element.select = False
        editable.faces.ensure_lookup_table()
        for face in faces:
            if face < len(editable.faces):
                editable.faces[face].select_set(True)
        editable.to_mesh(obj.data)
    finally:
        editable.free()


def _opened(path: Path, sequence: bool) -> Any:
    """Return a new cache file of Blender."""
    before = set(bpy.data.cache_files)
    bpy.ops.cachefile.open(filepath=str(path), relative_path=False)
    made = (set(bpy.data.cache_files) - before).pop()
    made[MARK] = True
    # The operator counts itself as a user, and is none.
    made.user_clear()
    made.is_sequence = sequence
    # Setting the path makes Blender read the files.
    made.filepath = relative(path)
    return made


def _placed(obj: Any, kind: str) -> Any:
    """Return the object's modifier of that kind: behind what moves its mesh, before what refines it."""
    modifier = our_modifier(obj)
    if modifier is not None and modifier.type == kind:
        return modifier
    place = None if modifier is None else list(obj.modifiers).index(modifier)
    remove_modifier(obj)
    if place is None:
        kinds = [entry.type for entry in obj.modifiers]
        place = len(kinds)
        while place and kinds[place - 1] in REFINING:
            place -= 1
    modifier = obj.modifiers.new(NAME, kind)
    modifier.name = NAME
    obj.modifiers.move(len(obj.modifiers) - 1, place)
    return our_modifier(obj)
