"""Blender's wind as the engine knows it, the same everywhere, and notes about other force fields."""

import math
from typing import Any

import numpy as np

from toile.blender_addon.problem import Problem
from toile.blender_addon.snapshot.space import Space, gravity
from toile.dressing.run.air import FASTEST


def _fields(scene: Any, *, wind: bool) -> list[Any]:
    """Return the objects with a force field, of wind or of another kind."""
    found = [obj for obj in scene.objects if obj.field is not None and obj.field.type != "NONE"]
    return [obj for obj in found if (obj.field.type == "WIND") is wind and not obj.hide_viewport]


class Weather:
    """Gravity and wind as they are in the first frame, and whether they change afterwards.

    `lines` and `air` say them in a scene file: gravity downwards in `space`, and the air of films.
    """

    def __init__(self, scene: Any, space: Space, *, films: bool) -> None:
        self.lines = [f"gravity = {np.linalg.norm(gravity(scene)):.6f}"]
        self.air = air_toml(scene, space) if films else []
        self._began = _state(scene)
        self._changes: dict[str, None] = {}

    def see(self, scene: Any) -> None:
        """Note what is another in the present frame."""
        now = _state(scene)
        for name in now:
            if not np.allclose(now[name], self._began.get(name, np.inf), rtol=0.0, atol=1e-6):
                self._changes[name] = None

    def notes(self) -> list[str]:
        """Return a sentence for everything that changes in the course of the frames."""
        return [
            f"{name} changes with the animation: it stays as it is in the first frame"
            for name in self._changes
        ]


def _state(scene: Any) -> dict[str, Any]:
    """Return gravity, and strength, noise and direction of every wind."""
    found = {"gravity": gravity(scene)}
    for obj in _fields(scene, wind=True):
        axis = np.array(obj.matrix_world, np.float64)[:3, 2]
        turn = axis / max(float(np.linalg.norm(axis)), 1e-12)
        found[f"wind '{obj.name}'"] = np.array([obj.field.strength, obj.field.noise, *turn])
    return found


def air_toml(scene: Any, space: Space) -> list[str]:
    """Return the table of the air as it is in the present frame; nothing without a wind.

    A wind blows along its object's Z axis, at its strength [m/s]; its noise is the standard deviation of
    gusts [m/s]. Several add up. One of strength 0 is still air.
    """
    winds = _fields(scene, wind=True)
    if not winds:
        return []
    along = [np.array(obj.matrix_world, np.float64)[:3, 2] for obj in winds]
    velocity = space.turn @ sum(
        obj.field.strength * axis / max(float(np.linalg.norm(axis)), 1e-12)
        for obj, axis in zip(winds, along, strict=True)
    )
    speed = float(np.linalg.norm(velocity))
    if speed > FASTEST:
        raise Problem(f"wind '{winds[0].name}' blows at {speed:.0f} m/s, toile takes up to {FASTEST:g}: "
                      "lower its strength")  # fmt: skip
    noise = math.hypot(*(obj.field.noise for obj in winds))
    lines = ["[air]", f"velocity = [{', '.join(f'{part:.6f}' for part in velocity)}]"]
    if noise and speed:
        lines += [f"gusts = {min(noise / speed, 1.0):.6f}", f"seed = {winds[0].field.seed}"]
    return lines


def not_understood(scene: Any, films: bool) -> list[str]:
    """Return a sentence for every force field that does nothing, or not all that it does in Blender."""
    notes = [
        f"force field '{obj.name}' does nothing: toile knows wind only, not {obj.field.type.lower()}"
        for obj in _fields(scene, wind=False)
    ]
    for obj in _fields(scene, wind=True):
        field = obj.field
        if not films:
            notes.append(f"wind '{obj.name}' does nothing: it acts on garments that follow a body (Simulate)")
        elif field.falloff_power > 0.0 or field.use_max_distance or field.use_min_distance:
            notes.append(f"wind '{obj.name}' blows the same everywhere, without its falloff")
    return notes
