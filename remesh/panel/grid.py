"""A grid of rectangular cells, each of two triangles."""

from typing import NamedTuple

import numpy as np

from toile.geometry.arrays import Float, Int


class Grid(NamedTuple):
    """A flat grid: points [m], shape (n, 2), row by row; faces, shape (t, 3), diagonals in turn."""

    points: Float
    faces: Int


def grid_mesh(width: float, height: float, columns: int, rows: int) -> Grid:
    """Return a grid of columns x rows cells on a rectangle [m]."""
    u, v = np.meshgrid(np.linspace(0.0, width, columns + 1), np.linspace(0.0, height, rows + 1))
    node = np.arange((columns + 1) * (rows + 1), dtype=np.int32).reshape(rows + 1, columns + 1)
    a, b = node[:-1, :-1].ravel(), node[:-1, 1:].ravel()
    c, d = node[1:, :-1].ravel(), node[1:, 1:].ravel()
    even = ((a // (columns + 1) + a % (columns + 1)) % 2 == 0)[:, None, None]
    rising = np.stack([np.stack([a, b, d], 1), np.stack([a, d, c], 1)], 1)
    falling = np.stack([np.stack([a, b, c], 1), np.stack([b, d, c], 1)], 1)
    faces = np.where(even, rising, falling).reshape(-1, 3)
    return Grid(np.column_stack((u.ravel(), v.ravel())), np.ascontiguousarray(faces, np.int32))
