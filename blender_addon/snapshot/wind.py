"""Blender's gravity and wind as the engine knows them, and notes about other force fields."""

import math
from typing import Any

import numpy as np

from toile.blender_addon.problem import Problem
from toile.blender_addon.snapshot.space import Space, gravity
from toile.engine.forces.fan import FASTEST
from toile.geometry.arrays import Float


def _fields(scene: Any, *, wind: bool) -> list[Any]:
    """Return the objects with a force field, of wind or of another kind."""
    found = [obj for obj in scene.objects if obj.field is not None and obj.field.type != "NONE"]
    return [obj for obj in found if (obj.field.type == "WIND") is wind and not obj.hide_viewport]


class Weather:
    """Gravity as it is in the first frame, and wind as it changes in a film.

    `lines` say gravity in a scene file, downwards in `space`.
    """

    def __init__(self, scene: Any, space: Space, *, films: bool) -> None:
        self.lines = [f"gravity = {np.linalg.norm(gravity(scene)):.6f}"]
        self._space = space
        self._gravity = gravity(scene)
        self._gravity_changes = False
        self._winds = [_Wind(obj, space) for obj in _fields(scene, wind=True)] if films else []

    def see(self, scene: Any) -> None:
        """Note how it is in the present frame."""
        self._gravity_changes |= not np.allclose(gravity(scene), self._gravity, rtol=0.0, atol=1e-6)
        for wind in self._winds:
            wind.see()

    def notes(self) -> list[str]:
        """Return a sentence for everything that changes without effect."""
        notes = [note for wind in self._winds for note in wind.notes()]
        if self._gravity_changes:
            notes.insert(0, "gravity changes with the animation: it stays as it is in the first frame")
        return notes

    def air(self, fps: float) -> list[str]:
        """Return the table of the air in a scene file; nothing without a wind.

        A wind blows along its object's Z axis, at its strength [m/s]; its noise is the standard deviation of
        gusts [m/s]. Several add up. One of strength 0 is still air.
        """
        if not self._winds:
            return []
        steady = [wind for wind in self._winds if wind.is_steady]
        velocity = sum((wind.velocities[0] for wind in steady), np.zeros(3))
        speed = float(np.linalg.norm(velocity))
        if speed > FASTEST:
            raise Problem(f"wind '{steady[0].name}' blows at {speed:.0f} m/s, toile takes up to {FASTEST:g}: "
                          "lower its strength")  # fmt: skip
        noise = math.hypot(*(wind.noise for wind in steady))
        lines = ["[air]", f"velocity = {_row(velocity)}"]
        if noise and speed:
            lines += [f"gusts = {min(noise / speed, 1.0):.6f}", f"seed = {steady[0].seed}"]
        for wind in self._winds:
            lines += [] if wind.is_steady else wind.fan(fps)
        return lines


class _Wind:
    """One wind: its velocity [m/s] and place [m] in every frame, in the engine's axes."""

    def __init__(self, obj: Any, space: Space) -> None:
        self._obj, self._space = obj, space
        self.name, self.noise, self.seed = obj.name, obj.field.noise, obj.field.seed
        self.velocities: list[Float] = []
        self._places: list[Float] = []

    def see(self) -> None:
        """Note how it is in the present frame."""
        matrix = np.array(self._obj.matrix_world, np.float64)
        axis = matrix[:3, 2] / max(float(np.linalg.norm(matrix[:3, 2])), 1e-12)
        self.velocities.append(self._space.turn @ (self._obj.field.strength * axis))
        self._places.append(self._space.metres * (self._space.turn @ matrix[:3, 3]))

    @property
    def is_steady(self) -> bool:
        """Whether it blows the same everywhere and at all times."""
        field = self._obj.field
        weaker = field.falloff_power > 0.0 or field.use_max_distance
        return not weaker and bool(np.allclose(self.velocities, self.velocities[0], rtol=0.0, atol=1e-6))

    def fan(self, fps: float) -> list[str]:
        """Return its own table in a scene file."""
        field, metres = self._obj.field, self._space.metres
        fastest = max(float(np.linalg.norm(velocity)) for velocity in self.velocities)
        if fastest > FASTEST:
            raise Problem(f"wind '{self.name}' blows at {fastest:.0f} m/s, toile takes up to {FASTEST:g}: "
                          "lower its strength")  # fmt: skip
        lines = [
            "[[air.fan]]",
            f"times = [{', '.join(f'{frame / fps:.9g}' for frame in range(len(self.velocities)))}]",
            f"velocities = [{', '.join(map(_row, self.velocities))}]",
        ]
        if field.falloff_power > 0.0 or field.use_max_distance:
            lines.append(f"places = [{', '.join(map(_row, self._places))}]")
            lines.append(f"falloff = {field.falloff_power:.9g}")
            if field.use_min_distance:
                lines.append(f"nearest = {metres * field.distance_min:.9g}")
            if field.use_max_distance:
                lines.append(f"farthest = {metres * field.distance_max:.9g}")
        return lines

    def notes(self) -> list[str]:
        """Return a sentence for everything of it that has no effect."""
        if self.is_steady:
            return []
        field, notes = self._obj.field, []
        if self.noise:
            notes.append(f"wind '{self.name}' blows without its noise, since it changes or weakens")
        if field.falloff_power > 0.0 or field.use_max_distance:
            if field.falloff_type != "SPHERE" or field.z_direction != "BOTH":
                notes.append(f"wind '{self.name}' weakens with the distance in all directions alike")
        return notes


def _row(vector: Float) -> str:
    """Return a vector for a scene file."""
    return f"[{', '.join(f'{part:.6f}' for part in vector)}]"


def not_understood(scene: Any, films: bool) -> list[str]:
    """Return a sentence for every force field that does nothing, or not all that it does in Blender."""
    notes = [
        f"force field '{obj.name}' does nothing: toile knows wind only, not {obj.field.type.lower()}"
        for obj in _fields(scene, wind=False)
    ]
    for obj in _fields(scene, wind=True):
        if not films:
            notes.append(f"wind '{obj.name}' does nothing: it acts on garments that follow a body (Simulate)")
    return notes
