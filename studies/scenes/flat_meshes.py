"""Flat meshes of a rectangle: right-triangle grid, equilateral rows, random Delaunay points."""

import numpy as np
from scipy.spatial import Delaunay

from toile.geometry.arrays import Float, Int

KINDS = ("right", "equilateral", "random")


def _counter_clockwise(points: Float, faces: Int) -> Int:
    a, b, c = (points[faces[:, k]] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    faces = np.where((area < 0)[:, None], faces[:, [0, 2, 1]], faces)
    return np.ascontiguousarray(faces, dtype=np.int32)


def right_grid(length: float, width: float, edge: float) -> tuple[Float, Int]:
    """Return points (n, 2) and faces (t, 3) of a grid whose diagonals all run the same way."""
    nx, ny = max(1, round(length / edge)), max(1, round(width / edge))
    x, y = np.meshgrid(np.linspace(0, length, nx + 1), np.linspace(0, width, ny + 1), indexing="ij")
    points = np.column_stack((x.ravel(), y.ravel()))
    i, j = np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij")
    a = (i * (ny + 1) + j).ravel()
    b, c, d = a + ny + 1, a + ny + 2, a + 1
    faces = np.concatenate((np.column_stack((a, b, c)), np.column_stack((a, c, d))))
    return points, _counter_clockwise(points, faces.astype(np.int32))


def equilateral(length: float, width: float, edge: float) -> tuple[Float, Int]:
    """Return rows of (nearly) equilateral triangles; every other row is shifted, ends are cut straight."""
    nx, ny = max(1, round(length / edge)), max(1, round(width / (edge * np.sqrt(0.75))))
    points = []
    for j, y in enumerate(np.linspace(0, width, ny + 1)):
        x = np.linspace(0, length, nx + 1)
        if j % 2:
            x = np.concatenate(([0.0], x[:-1] + 0.5 * length / nx, [length]))
        points.append(np.column_stack((x, np.full(len(x), y))))
    stacked = np.concatenate(points)
    return stacked, _triangulated(stacked)


def random_delaunay(length: float, width: float, edge: float, seed: int = 1) -> tuple[Float, Int]:
    """Return the Delaunay mesh of scattered points at least 0.7 edges apart; borders are sampled evenly."""
    generator = np.random.default_rng(seed)
    nx, ny = max(1, round(length / edge)), max(1, round(width / edge))
    x, y = np.linspace(0, length, nx + 1), np.linspace(0, width, ny + 1)
    border = np.concatenate(
        (
            np.column_stack((x, np.zeros_like(x))),
            np.column_stack((x, np.full_like(x, width))),
            np.column_stack((np.zeros(ny - 1), y[1:-1])),
            np.column_stack((np.full(ny - 1, length), y[1:-1])),
        )
    )
    kept = np.empty((len(border) + 60 * nx * ny, 2))
    kept[: len(border)] = border
    count = len(border)
    for candidate in generator.uniform(size=(60 * nx * ny, 2)) * (length, width):
        margin = min(candidate[0], length - candidate[0], candidate[1], width - candidate[1])
        if margin < 0.45 * edge:
            continue
        if np.min(np.sum((kept[:count] - candidate) ** 2, axis=1)) > (0.7 * edge) ** 2:
            kept[count] = candidate
            count += 1
    points = kept[:count].copy()
    return points, _triangulated(points)


def _triangulated(points: Float) -> Int:
    faces = Delaunay(points).simplices.astype(np.int32)
    a, b, c = (points[faces[:, k]] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    longest = np.max([np.sum((b - a) ** 2, 1), np.sum((c - b) ** 2, 1), np.sum((a - c) ** 2, 1)], axis=0)
    return _counter_clockwise(points, faces[np.abs(area) > 1e-6 * longest])


def mesh(kind: str, length: float, width: float, edge: float, seed: int = 1) -> tuple[Float, Int]:
    """Return points (n, 2) and faces (t, 3) of the rectangle [0, length] x [0, width] for a kind in KINDS."""
    if kind == "right":
        return right_grid(length, width, edge)
    if kind == "equilateral":
        return equilateral(length, width, edge)
    return random_delaunay(length, width, edge, seed)
