"""From Blender's space to the engine's, metres and Y up, and back."""

from typing import Any

import numpy as np

from toile.geometry.arrays import Float

Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""A body that faces Blender's front view, -Y, faces the engine's +Z."""


def metres_per_unit(scene: Any) -> float:
    """Length of a Blender unit [m]."""
    units = scene.unit_settings
    return 1.0 if units.system == "NONE" else float(units.scale_length)


def to_engine(matrix_world: Any, scene: Any) -> Float:
    """Affine map from an object's local space to the engine's, shape (4, 4)."""
    turn = np.eye(4)
    turn[:3, :3] = metres_per_unit(scene) * Y_UP
    return np.asarray(turn @ np.array(matrix_world, np.float64))


def moved(matrix: Float, points: Float) -> Float:
    """Points (n, 3) under an affine map (4, 4)."""
    return np.asarray(points @ matrix[:3, :3].T + matrix[:3, 3])
