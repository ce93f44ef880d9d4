"""From Blender's space to the engine's, metres and Y up, and back."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from toile.geometry.arrays import Float

Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""A body that faces Blender's front view, -Y, faces the engine's +Z."""


def metres_per_unit(scene: Any) -> float:
    """Length of a Blender unit [m]."""
    units = scene.unit_settings
    return 1.0 if units.system == "NONE" else float(units.scale_length)


@dataclass(frozen=True)
class Space:
    """How the engine sees a scene: `metres` per unit, and `turn` (3, 3) from Blender's axes to its own."""

    metres: float
    turn: Float

    @staticmethod
    def upright(scene: Any) -> "Space":
        """Return the space in which Blender's Z points up."""
        return Space(metres_per_unit(scene), Y_UP)

    @staticmethod
    def falling(scene: Any) -> "Space":
        """Return the space in which gravity points down, wherever it points in the scene."""
        return Space(metres_per_unit(scene), _turned(gravity(scene)) @ Y_UP)

    def of(self, matrix_world: Any) -> Float:
        """Affine map from an object's local space to the engine's, shape (4, 4)."""
        turn = np.eye(4)
        turn[:3, :3] = self.metres * self.turn
        return np.asarray(turn @ np.array(matrix_world, np.float64))


def gravity(scene: Any) -> Float:
    """Gravity of a scene in Blender's axes [m/s2], shape (3,); none where it is switched off."""
    return np.array(scene.gravity if scene.use_gravity else (0.0, 0.0, 0.0), np.float64)


def moved(matrix: Float, points: Float) -> Float:
    """Points (n, 3) under an affine map (4, 4)."""
    return np.asarray(points @ matrix[:3, :3].T + matrix[:3, 3])


def _turned(force: Float) -> Float:
    """Return the smallest rotation (3, 3), in the engine's axes, that lets gravity in Blender's fall."""
    size = float(np.linalg.norm(force))
    if not size:
        return np.eye(3)
    down = Y_UP @ force / size
    cosine = -down[1]
    if cosine > 1.0 - 1e-12:
        return np.eye(3)
    if cosine < -1.0 + 1e-12:
        return np.diag([-1.0, -1.0, 1.0])
    x, y, z = np.cross(down, (0.0, -1.0, 0.0))
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / (1.0 + cosine))
