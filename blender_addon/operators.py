"""The operators `toile.*`. Each works without an event loop; with one, the long-running ones are modal."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy.app.handlers import persistent
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from toile.blender_addon.dressing import draft_steps, dress_body_steps, dress_steps
from toile.blender_addon.fit_nodes import MAPS, cloth_nodes, hide_fit, show_fit
from toile.blender_addon.frame_folders import forget, note_loaded, note_user, sweep
from toile.blender_addon.problem import Problem, check_editable
from toile.blender_addon.result import made_real, note_missing, our_modifier, remove_modifier
from toile.blender_addon.run import Current, Run, Steps, cancel_current
from toile.blender_addon.snapshot.cast import roles

ROLES = ("NONE", "AVATAR", "GARMENT", "OBSTACLE")
SHOWN_IN = {"PROPERTIES", "VIEW_3D"}
"""Editors that show progress."""


class _Runs:
    """An operator whose work is done in steps: at once by `execute`, beside Blender's own by `invoke`."""

    _timer: Any = None
    steps: Callable[[Any], Steps]
    """Returns the work, in a context; every operator has its own."""

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Allow one run at a time."""
        return Current.run is None

    def execute(self, context: Any) -> set[str]:
        """Work to the end."""
        self._begin(context)
        try:
            assert Current.run is not None
            Current.run.finish()
        except Problem as problem:
            return self._failed(problem)
        finally:
            self._end(context)
        return {"FINISHED"}

    def invoke(self, context: Any, event: Any) -> set[str]:
        """Work a little at every tick of a timer."""
        self._begin(context)
        self._timer = context.window_manager.event_timer_add(0.05, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: Any, event: Any) -> set[str]:
        """Continue, or stop when the user presses Esc."""
        run = Current.run
        if run is None:
            self._end(context)
            return {"CANCELLED"}
        if event.type == "ESC":
            run.cancelled = True
        if event.type != "TIMER":
            # Undo would replace objects while they are read.
            return {"RUNNING_MODAL"} if run.reading else {"PASS_THROUGH"}
        try:
            more = run.tick()
        except Problem as problem:
            self._end(context)
            return self._failed(problem)
        _redraw(context, f"toile: {run.text}   (Esc: stop, keep the frames so far)")
        if more:
            return {"RUNNING_MODAL"}
        self._end(context)
        return {"FINISHED"}

    def cancel(self, context: Any) -> None:
        """Stop, as when another file is loaded."""
        self._end(context)

    def _begin(self, context: Any) -> None:
        Current.run = Run(self.steps(context))

    def _end(self, context: Any) -> None:
        if Current.run is not None:
            for note in Current.run.notes:
                self.report({"WARNING"}, note)  # type: ignore[attr-defined]
            Current.run.close()
            Current.run = None
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None
        _redraw(context, None)

    def _failed(self, problem: Problem) -> set[str]:
        self.report({"ERROR"}, str(problem))  # type: ignore[attr-defined]
        return {"CANCELLED"}


def _body(context: Any) -> Any:
    """Return the avatar that a pattern is drafted to: the active one, or the only one; None if in doubt."""
    avatars = [part.obj for part in roles(context).avatars if not part.instance]
    if context.object in avatars:
        return context.object
    return avatars[0] if len(avatars) == 1 else None


def _redraw(context: Any, text: str | None) -> None:
    """Show progress, where there is something to show it in."""
    if context.workspace is not None:
        context.workspace.status_text_set(text)
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in SHOWN_IN:
                area.tag_redraw()


class TOILE_OT_dress(_Runs, bpy.types.Operator):
    """Put the garments of the scene on its avatars, or only those that are selected."""

    bl_idname, bl_label, bl_options = "toile.dress", "Dress", {"UNDO"}
    __annotations__ = {
        "only_selected": BoolProperty(
            name="Only Selected",
            description="Leave garments alone that are not selected, and avatars if some are",
        )
    }

    def steps(self, context: Any) -> Steps:
        """Return the work."""
        return dress_steps(context, only_selected=self.only_selected)


class TOILE_OT_dress_body(_Runs, bpy.types.Operator):
    """Draft a built-in pattern to the active object, and dress it."""

    bl_idname, bl_label, bl_options = "toile.dress_body", "Dress This Body", {"UNDO"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Need a mesh that is not a garment."""
        body = context.object
        return (
            Current.run is None and body is not None and body.type == "MESH" and body.toile.role != "GARMENT"
        )

    def steps(self, context: Any) -> Steps:
        """Return the work."""
        return dress_body_steps(context, context.object, context.scene.toile.pattern)


class TOILE_OT_add_pattern(_Runs, bpy.types.Operator):
    """Draft the chosen built-in pattern to the avatar, its panels around it."""

    bl_idname, bl_label, bl_options = "toile.add_pattern", "Add Pattern", {"UNDO"}

    def steps(self, context: Any) -> Steps:
        """Return the work."""
        return draft_steps(context, context.scene.toile.pattern, _body(context))


class TOILE_OT_import_pattern(_Runs, bpy.types.Operator, ImportHelper):
    """Import a sewing pattern in the GarmentCode format, its panels around the avatar."""

    bl_idname, bl_label, bl_options = "toile.import_pattern", "Import GarmentCode Pattern", {"UNDO"}
    filename_ext = ".json"
    __annotations__ = {"filter_glob": StringProperty(default="*.json", options={"HIDDEN"})}

    def invoke(self, context: Any, event: Any) -> set[str]:
        """Ask for the file."""
        chosen: set[str] = ImportHelper.invoke(self, context, event)
        return chosen

    def steps(self, context: Any) -> Steps:
        """Return the work."""
        return draft_steps(context, str(Path(bpy.path.abspath(self.filepath)).resolve()), _body(context))


class TOILE_OT_cancel(bpy.types.Operator):
    """Stop, and keep the frames so far."""

    bl_idname, bl_label = "toile.cancel", "Cancel"

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Need a run."""
        return Current.run is not None

    def execute(self, context: Any) -> set[str]:
        """Ask the run to stop."""
        if Current.run is not None:
            Current.run.cancelled = True
        return {"FINISHED"}


class TOILE_OT_set_role(bpy.types.Operator):
    """Make the active object an avatar, a garment or an obstacle, or none of them."""

    bl_idname, bl_label, bl_options = "toile.set_role", "Set Role", {"REGISTER", "UNDO"}
    __annotations__ = {"role": EnumProperty(items=[(word, word.capitalize(), "") for word in ROLES])}

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Need a mesh."""
        return context.object is not None and context.object.type == "MESH"

    def execute(self, context: Any) -> set[str]:
        """Set it."""
        try:
            check_editable(context.object)
        except Problem as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        context.object.toile.role = self.role
        if self.role != "GARMENT":
            remove_modifier(context.object)
        return {"FINISHED"}


class TOILE_OT_add_field(bpy.types.Operator):
    """Let a value of the fabric differ from place to place, or change with the animation."""

    bl_idname, bl_label, bl_options = "toile.add_field", "Add Field", {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Need a garment."""
        return context.object is not None and context.object.toile.role == "GARMENT"

    def execute(self, context: Any) -> set[str]:
        """Add it."""
        context.object.toile.fields.add()
        return {"FINISHED"}


class TOILE_OT_remove_field(bpy.types.Operator):
    """Remove a field of the garment."""

    bl_idname, bl_label, bl_options = "toile.remove_field", "Remove Field", {"REGISTER", "UNDO"}
    __annotations__ = {"index": IntProperty(min=0)}

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Need fields."""
        return context.object is not None and len(context.object.toile.fields) > 0

    def execute(self, context: Any) -> set[str]:
        """Remove it."""
        context.object.toile.fields.remove(self.index)
        return {"FINISHED"}


class _OnGarment:
    """An operator on a garment that shows frames."""

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Need the frames."""
        return Current.run is None and context.object is not None and our_modifier(context.object) is not None


class TOILE_OT_show_fit(_OnGarment, bpy.types.Operator):
    """Colour this garment by how it fits; its mesh and materials stay."""

    bl_idname, bl_label, bl_options = "toile.show_fit", "Show Fit", {"REGISTER", "UNDO"}
    __annotations__ = {
        "shown": EnumProperty(
            name="Shown", default="stretch_warp_percent",
            items=[("NONE", "Own Materials", ""), *((name, made.label, "") for name, made in MAPS.items())],
        )
    }  # fmt: skip

    def execute(self, context: Any) -> set[str]:
        """Show it."""
        garment = context.object
        if self.shown == "NONE":
            hide_fit(garment)
            return {"FINISHED"}
        seen = garment.evaluated_get(context.evaluated_depsgraph_get()).data.attributes.get(self.shown)
        if seen is None:
            self.report({"ERROR"}, f"'{garment.name}' has no such map in this frame: switch Fit Maps on and "
                        "dress it; pressure, tension, shear and gap are in the last frame")  # fmt: skip
            return {"CANCELLED"}
        values = np.empty(len(seen.data), np.float32)
        seen.data.foreach_get("value", values)
        top = show_fit(garment, our_modifier(garment), self.shown, values.astype(np.float64))
        self.report({"INFO"}, f"{MAPS[self.shown].label}: colours from 0 to {top:g}")
        return {"FINISHED"}


class TOILE_OT_add_nodes(bpy.types.Operator):
    """Add geometry nodes that read the cloth and its maps to this file, as an asset."""

    bl_idname, bl_label, bl_options = "toile.add_nodes", "Add Nodes", {"REGISTER", "UNDO"}

    def execute(self, context: Any) -> set[str]:
        """Add them."""
        self.report({"INFO"}, f"geometry nodes '{cloth_nodes().name}'")
        return {"FINISHED"}


class TOILE_OT_apply(_OnGarment, bpy.types.Operator):
    """Make what the garment shows in this frame its mesh; the old mesh is kept as data."""

    bl_idname, bl_label, bl_options = "toile.apply", "Apply This Frame", {"REGISTER", "UNDO"}

    def execute(self, context: Any) -> set[str]:
        """Apply it."""
        made_real(context.object, context)
        context.object.toile.role = "NONE"
        return {"FINISHED"}


class TOILE_OT_clear(_OnGarment, bpy.types.Operator):
    """Remove the frames of this garment from disk; it shows its own mesh again."""

    bl_idname, bl_label, bl_options = "toile.clear", "Clear Frames", {"REGISTER"}

    def execute(self, context: Any) -> set[str]:
        """Clear them."""
        garment = context.object
        folder = remove_modifier(garment)
        kept = "" if folder is None else forget(folder)
        if kept:
            self.report({"WARNING"}, f"'{garment.name}' shows its own mesh; its frames stay on disk: {kept}")
        garment.toile.state = garment.toile.notes = ""
        return {"FINISHED"}


CLASSES = (
    TOILE_OT_dress, TOILE_OT_dress_body, TOILE_OT_add_pattern, TOILE_OT_import_pattern, TOILE_OT_cancel,
    TOILE_OT_set_role, TOILE_OT_show_fit, TOILE_OT_add_nodes, TOILE_OT_apply, TOILE_OT_clear,
    TOILE_OT_add_field, TOILE_OT_remove_field,
)  # fmt: skip


@persistent
def stop(*_: object) -> None:
    """Stop the run in progress, as before another file is loaded."""
    cancel_current()


@persistent
def loaded(*_: object) -> None:
    """Note what frames a file came with, and garments whose frames are gone."""
    note_loaded()
    note_missing()


@persistent
def saved(path: str = "", *_: object) -> None:
    """Note that a file shows frames, and remove those that no object shows any more."""
    note_user(path)
    sweep()
