"""Registration of the extension in Blender, and its complete removal."""

import bpy

from toile.blender_addon import operators, panels
from toile.blender_addon.properties import TOILE_PG_field, TOILE_PG_object, TOILE_PG_scene

CLASSES = (TOILE_PG_field, TOILE_PG_object, TOILE_PG_scene, *operators.CLASSES, *panels.CLASSES)

HANDLERS = {"load_pre": operators.stop, "load_post": operators.loaded, "save_post": operators.saved}


def register_all() -> None:
    """Add everything."""
    for added in CLASSES:
        bpy.utils.register_class(added)
    kept = {"override": {"LIBRARY_OVERRIDABLE"}}
    bpy.types.Object.toile = bpy.props.PointerProperty(type=TOILE_PG_object, **kept)
    bpy.types.Scene.toile = bpy.props.PointerProperty(type=TOILE_PG_scene, **kept)
    bpy.types.PHYSICS_PT_add.append(panels.draw_add)
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def unregister_all() -> None:
    """Take it out again; a run in progress is stopped."""
    operators.stop()
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(handler)
    bpy.types.PHYSICS_PT_add.remove(panels.draw_add)
    del bpy.types.Scene.toile
    del bpy.types.Object.toile
    for added in reversed(CLASSES):
        bpy.utils.unregister_class(added)
