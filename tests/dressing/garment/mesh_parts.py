"""Parts of simple garments, and the OBJ file that holds them as groups."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.geometry.arrays import Float

Part = tuple[Float, Sequence[tuple[int, ...]]]
"""Vertices [m], shape (n, 3), and polygons."""


def tube(radius: float = 0.3, around: int = 40, rows: int = 12, row_height: float = 0.02) -> Part:
    """Return quads of a tube about the vertical axis, from 1 m up."""
    angle = 2.0 * np.pi * np.arange(around) / around
    ring = np.column_stack([radius * np.sin(angle), np.zeros(around), radius * np.cos(angle)])
    levels = [ring + np.array([0.0, 1.0 + row_height * row, 0.0]) for row in range(rows + 1)]
    faces = [
        (row * around + i, row * around + (i + 1) % around, (row + 1) * around + (i + 1) % around,
         (row + 1) * around + i)
        for row in range(rows) for i in range(around)
    ]  # fmt: skip
    return np.concatenate(levels), faces


def octahedron(centre: tuple[float, float, float], radius: float) -> Part:
    """Return a closed shell of eight triangles."""
    corners = radius * np.concatenate([np.eye(3), -np.eye(3)]) + centre
    faces = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]
    return corners, faces


def obj_text(*parts: Part) -> str:
    """Return an OBJ file whose groups are the parts."""
    lines, first = [], 1
    for number, (vertices, faces) in enumerate(parts):
        lines.append(f"g part{number}")
        lines += ["v {:.9g} {:.9g} {:.9g}".format(*vertex) for vertex in vertices.tolist()]
        lines += ["f " + " ".join(str(first + corner) for corner in face) for face in faces]
        first += len(vertices)
    return "\n".join(lines) + "\n"


def read(folder: Path, *parts: Part, walls: int = 1) -> GarmentMesh:
    """Write parts as groups of an OBJ file and read it."""
    (folder / "dirty.obj").write_text(obj_text(*parts))
    return read_mesh_garment(folder / "dirty.obj", walls=walls)
