"""Panels: in the Physics tab, where Blender's own cloth is, and a short one beside the 3-D view."""

from textwrap import wrap
from typing import Any, ClassVar

import bpy

from toile.blender_addon.properties import OWN_VALUES
from toile.blender_addon.result import our_modifier
from toile.blender_addon.run import Current

WIDTH = 60
"""Letters in a line of a note."""


def draw_add(self: Any, context: Any) -> None:
    """Offer roles among the physics of an object."""
    obj = context.object
    if obj is None or obj.type != "MESH":
        return
    row = self.layout.row(align=True)
    if obj.toile.role != "NONE":
        row.operator("toile.set_role", text=f"Toile {obj.toile.role.capitalize()}", icon="X").role = "NONE"
        return
    row.operator("toile.set_role", text="Toile Garment", icon="MATCLOTH").role = "GARMENT"
    row.operator("toile.set_role", text="Toile Avatar", icon="OUTLINER_OB_ARMATURE").role = "AVATAR"
    row.operator("toile.set_role", text="Toile Obstacle", icon="MESH_CUBE").role = "OBSTACLE"


def draw_run(layout: Any, context: Any) -> None:
    """Show the run in progress, or what starts one."""
    run = Current.run
    if run is not None:
        layout.progress(factor=run.share, text=run.text)
        layout.operator("toile.cancel", icon="CANCEL")
        return
    row = layout.row(align=True)
    row.operator("toile.dress", icon="PLAY")
    row.operator("toile.dress", text="Only Selected").only_selected = True


class _Physics:
    """A panel in the Physics tab of an object that has a role."""

    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "physics"

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Need an object with a role."""
        return context.object is not None and context.object.toile.role != "NONE"


class TOILE_PT_physics(_Physics, bpy.types.Panel):
    """The object's role, and the run."""

    bl_idname, bl_label = "TOILE_PT_physics", "Toile"

    def draw(self, context: Any) -> None:
        """Draw it."""
        layout, obj = self.layout, context.object
        layout.use_property_split = True
        layout.prop(obj.toile, "role")
        layout.prop(obj.toile, "body")
        if obj.toile.role == "GARMENT":
            layout.prop(obj.toile, "layer")
            layout.prop(obj.toile, "keep_topology")
        if obj.toile.role == "OBSTACLE":
            layout.prop(obj.toile, "use_friction")
            if obj.toile.use_friction:
                layout.prop(obj.toile, "friction")
        draw_run(layout.column(), context)
        if obj.toile.state:
            layout.label(text=f"Frames: {obj.toile.state}")
        for note in obj.toile.notes.splitlines():
            column = layout.column(align=True)
            for number, line in enumerate(wrap(note, WIDTH)):
                column.label(text=line, icon="BLANK1" if number else "INFO")
        if our_modifier(obj) is not None:
            row = layout.row(align=True)
            row.operator("toile.apply")
            row.operator("toile.clear")
            row = layout.row(align=True)
            row.operator_menu_enum("toile.show_fit", "shown", icon="COLOR")
            row.operator("toile.add_nodes", icon="GEOMETRY_NODES")


class TOILE_PT_fabric(_Physics, bpy.types.Panel):
    """Fabric, pins and seams of a garment."""

    bl_idname, bl_label, bl_parent_id = "TOILE_PT_fabric", "Cloth", "TOILE_PT_physics"

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Need a garment."""
        return context.object is not None and context.object.toile.role == "GARMENT"

    def draw(self, context: Any) -> None:
        """Draw it."""
        layout, own = self.layout, context.object.toile
        layout.use_property_split = True
        layout.prop_search(own, "pin_group", context.object, "vertex_groups")
        if own.pin_group:
            layout.prop(own, "pin_stiffness")
        layout.prop(own, "use_sewing")
        layout.prop(own, "fabric")
        layout.prop_search(own, "warp_map", context.object.data, "uv_layers")
        layout.prop(own, "thickness")
        layout.prop(own, "use_own_values")
        if own.use_own_values:
            column = layout.column(align=True)
            for name in OWN_VALUES:
                column.prop(own, name)


class TOILE_PT_fields(_Physics, bpy.types.Panel):
    """Values of a garment that are painted, or change with the animation."""

    bl_idname, bl_label, bl_parent_id = "TOILE_PT_fields", "Fields", "TOILE_PT_physics"
    bl_options: ClassVar[set[str]] = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Need a garment."""
        return context.object is not None and context.object.toile.role == "GARMENT"

    def draw(self, context: Any) -> None:
        """Draw it."""
        layout = self.layout
        for index, field in enumerate(context.object.toile.fields):
            box = layout.box()
            row = box.row(align=True)
            row.prop(field, "quantity", text="")
            row.operator("toile.remove_field", text="", icon="X").index = index
            box.prop_search(field, "source", context.object, "vertex_groups")
            row = box.row(align=True)
            if field.source:
                row.prop(field, "low")
            row.prop(field, "high", text="At 1" if field.source else "Value")
        layout.operator("toile.add_field", icon="ADD")


class TOILE_PT_scene(_Physics, bpy.types.Panel):
    """Settings of the scene."""

    bl_idname, bl_label, bl_parent_id = "TOILE_PT_scene", "Simulation", "TOILE_PT_physics"

    def draw(self, context: Any) -> None:
        """Draw it."""
        layout, settings = self.layout, context.scene.toile
        layout.use_property_split = True
        layout.prop(settings, "mode")
        if settings.mode == "SIMULATE":
            column = layout.column(align=True)
            column.prop(settings, "frame_start")
            column.prop(settings, "frame_end")
        layout.prop(settings, "quality")
        layout.prop(settings, "threads")
        layout.prop(settings, "use_fit")
        layout.prop(settings, "use_remesh")
        column = layout.column(align=True)
        column.prop(settings, "size_min")
        if settings.use_remesh:
            column.prop(settings, "size_max")


class TOILE_PT_view(bpy.types.Panel):
    """The one click, and the run."""

    bl_idname, bl_label = "TOILE_PT_view", "Toile"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Toile"

    def draw(self, context: Any) -> None:
        """Draw it."""
        layout, settings = self.layout, context.scene.toile
        layout.prop(settings, "pattern")
        column = layout.column(align=True)
        column.operator("toile.dress_body", icon="MATCLOTH")
        column.operator("toile.add_pattern")
        column.operator("toile.import_pattern")
        draw_run(layout, context)


CLASSES = (TOILE_PT_physics, TOILE_PT_fabric, TOILE_PT_fields, TOILE_PT_scene, TOILE_PT_view)
