"""Panels drawn into a layout that checks what it gets; a run as a window drives it; times of operators."""

import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import small_scene as small

import toile.blender_addon
from toile.blender_addon import panels
from toile.blender_addon.operators import _Runs
from toile.blender_addon.run import Current

folder = Path(sys.argv[1])
small.empty_file(folder)
scene = bpy.context.scene
found: dict[str, Any] = {"drawn": {}, "took": {}}


class Layout:
    """Takes what panels draw; a property or operator that does not exist is an error, as in a window."""

    def __init__(self, drawn: list[str]) -> None:
        self._drawn = drawn

    def prop(self, data: Any, name: str, **_: object) -> None:
        data.bl_rna.properties[name]
        self._drawn.append(name)

    def prop_search(self, data: Any, name: str, where: Any, among: str, **_: object) -> None:
        where.bl_rna.properties[among]
        self.prop(data, name)

    def operator(self, name: str, **_: object) -> Any:
        made = SimpleNamespace()
        group, verb = name.split(".")
        getattr(getattr(bpy.ops, group), verb).get_rna_type()
        self._drawn.append(name)
        return made

    def operator_menu_enum(self, name: str, values: str, **_: object) -> None:
        group, verb = name.split(".")
        getattr(getattr(bpy.ops, group), verb).get_rna_type().properties[values]
        self._drawn.append(name)

    def label(self, **text: str) -> None:
        self._drawn.append(text["text"])

    def progress(self, *, factor: float, text: str) -> None:
        self._drawn.append(f"{factor:.2f} {text}")

    def row(self, **_: object) -> "Layout":
        return Layout(self._drawn)

    column = box = row


def drawn(obj: Any) -> list[str]:
    """Draw all panels that show for an object."""
    seen: list[str] = []
    context = SimpleNamespace(object=obj, scene=scene)
    for panel in panels.CLASSES:
        if not hasattr(panel, "poll") or panel.poll(context):
            panel.draw(SimpleNamespace(layout=Layout(seen)), context)
    panels.draw_add(SimpleNamespace(layout=Layout(seen)), context)
    return seen


def timed(name: str, **options: object) -> None:
    """Run an operator, and note how long it takes [ms]."""
    started = time.perf_counter()
    getattr(bpy.ops.toile, name)(**options)
    found["took"][name] = 1e3 * (time.perf_counter() - started)


body = small.body()
bpy.ops.mesh.primitive_grid_add(size=0.5, x_subdivisions=60, y_subdivisions=60, location=(0.0, 0.0, 1.3))
cloth = bpy.context.object
found["drawn"]["plain"] = drawn(cloth)
timed("set_role", role="GARMENT")
timed("add_field")
cloth.vertex_groups.new(name="Pins").add([0, 1], 1.0, "REPLACE")
cloth.toile.pin_group, cloth.toile.use_own_values = "Pins", True
cloth.toile.notes = "a note of many words that is longer than a line of the panel, and so takes two"
small.settings("DRAPE")
small.stub_engine()
bpy.ops.toile.dress()
cloth.toile.state = "complete"
found["drawn"]["garment"] = drawn(cloth)
scene.toile.mode = "SIMULATE"
found["drawn"]["avatar"] = drawn(body)
body.toile.role = "OBSTACLE"
body.toile.use_friction = True
found["drawn"]["obstacle"] = drawn(body)
body.toile.role = "AVATAR"
timed("add_nodes")
timed("remove_field", index=0)
timed("clear")
scene.toile.mode = "DRAPE"
bpy.ops.toile.dress()
timed("apply")


class Driven(_Runs):
    """An operator without Blender around it: nothing redraws and no timer fires."""

    def __init__(self, work: Iterator[bool]) -> None:
        self._work, self.said = work, []

    def steps(self, context: Any) -> Iterator[bool]:
        return self._work

    def report(self, kind: set[str], text: str) -> None:
        self.said.append(text)


class Manager:
    """A window manager that counts its timers and handlers."""

    def __init__(self) -> None:
        self.timers, self.handlers, self.windows = 0, 0, []

    def event_timer_add(self, seconds: float, window: object) -> float:
        self.timers += 1
        return seconds

    def event_timer_remove(self, timer: object) -> None:
        self.timers -= 1

    def modal_handler_add(self, operator: object) -> None:
        self.handlers += 1


def steps() -> Iterator[bool]:
    """Three ticks, or fewer if cancelled."""
    assert Current.run is not None
    for number in range(3):
        if Current.run.cancelled:
            Current.run.notes.append(f"stopped at {number}")
            return
        Current.run.text = f"step {number}"
        yield False


def driven(events: list[str]) -> list[Any]:
    """Send events to a run, as a window does; return what it answers, reports and leaves behind."""
    manager, texts = Manager(), []
    context = SimpleNamespace(
        window_manager=manager, window=None, workspace=SimpleNamespace(status_text_set=texts.append)
    )
    operator = Driven(steps())
    answers = [operator.invoke(context, None)]
    running = drawn(None) if events else []
    for event in events:
        answers.append(operator.modal(context, SimpleNamespace(type=event)))
    return [
        [min(answer) for answer in answers], operator.said, manager.timers, Current.run is None, texts,
        running,
    ]  # fmt: skip


found["to the end"] = driven(["TIMER", "MOUSEMOVE", "TIMER", "TIMER", "TIMER"])
found["esc"] = driven(["TIMER", "ESC", "TIMER"])
toile.blender_addon.unregister()
print(json.dumps(found))
