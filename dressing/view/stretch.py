"""How much a mesh is stretched beside its pattern, as a field that colours it."""

import numpy as np

from toile.dressing.view.view_part import Field, Pose, Shape
from toile.geometry.arrays import Float, Int


def largest_stretch(positions: Float, faces: Int, uv: Float) -> Float:
    """Return the largest stretch of every face in any direction [%], shape (t,).

    It is the larger singular value of the map from the pattern, less 1. `positions`, shape (m, 3), and `uv`,
    (m, 2), are those of the vertices of `faces`, (t, 3) [m]. 0 where a face has no area in the pattern.
    """
    rest, now = uv[faces], positions[faces]
    u, v = rest[:, 1] - rest[:, 0], rest[:, 2] - rest[:, 0]
    a, b = now[:, 1] - now[:, 0], now[:, 2] - now[:, 0]
    doubled = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    some = np.abs(doubled) > 1e-14
    scale = np.where(some, 1.0 / np.where(some, doubled, 1.0), 0.0)[:, None]
    along, across = (v[:, 1:] * a - u[:, 1:] * b) * scale, (u[:, :1] * b - v[:, :1] * a) * scale
    e, g = (along**2).sum(axis=1), (across**2).sum(axis=1)
    f = (along * across).sum(axis=1)
    squared = 0.5 * (e + g) + np.sqrt(0.25 * (e - g) ** 2 + f**2)
    return np.where(some, 100.0 * (np.sqrt(squared) - 1.0), 0.0)


def is_pattern(positions: Float, faces: Int, uv: Float) -> bool:
    """Whether uv [m] is a flat pattern of the mesh: its median face has about its area there."""
    rest, now = uv[faces], positions[faces]
    u, v = rest[:, 1] - rest[:, 0], rest[:, 2] - rest[:, 0]
    flat = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    area = np.linalg.norm(np.cross(now[:, 1] - now[:, 0], now[:, 2] - now[:, 0]), axis=1)
    share = np.median(flat / np.maximum(area, 1e-300))
    return bool(0.4 < share < 2.5)


def patterned(shape: Shape, positions: Float) -> Shape:
    """Return triangles without texture coordinates that are no pattern."""
    flat = shape.uv is not None and is_pattern(positions, shape.faces, shape.uv)
    return shape if flat else Shape(shape.faces)


def stretched(shape: Shape, positions: Float, fields: tuple[Field, ...] = ()) -> Pose:
    """Return a pose with its stretch among the fields, where it has a pattern."""
    if shape.uv is None:
        return Pose(shape, positions, fields)
    return Pose(
        shape, positions, (Field("stretch", "%", largest_stretch(positions, shape.faces, shape.uv)), *fields)
    )


def posed(shape: Shape, positions: Float, fields: tuple[Field, ...] = ()) -> Pose:
    """Return a pose of a mesh whose texture coordinates may be a pattern, with its stretch if they are."""
    return stretched(patterned(shape, positions), positions, fields)
