"""The surface of volume cells: faces that belong to one cell only."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Cells = npt.NDArray[np.int64]
"""Nodes of cells of one size or numbers of cells, as mesh files hold them."""

CELL_FACES = {
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    "pyramid": ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}
"""Corners of the faces of every kind of cell, counter-clockwise seen from outside, in meshio's order."""


class Polygons(NamedTuple):
    """Polygons of one size: their nodes, shape (n, k), and the cell of the file each comes from, (n,)."""

    corners: Cells
    cell: Cells


def cell_faces(kind: str, corners: Cells, cell: Cells) -> list[Polygons]:
    """Return all faces of cells of one kind; `corners` (n, k) are their nodes, `cell` (n,) their numbers."""
    faces = CELL_FACES[kind]
    sizes = sorted({len(face) for face in faces})
    return [
        Polygons(
            corners=np.concatenate([corners[:, list(face)] for face in faces if len(face) == size]),
            cell=np.concatenate([cell for face in faces if len(face) == size]),
        )
        for size in sizes
    ]


def skin(faces: list[Polygons]) -> list[Polygons]:
    """Return the faces that occur once, in the order of their cells; faces of two cells lie inside."""
    outer = []
    for size in sorted({part.corners.shape[1] for part in faces}):
        corners = np.concatenate([part.corners for part in faces if part.corners.shape[1] == size])
        cell = np.concatenate([part.cell for part in faces if part.corners.shape[1] == size])
        _, first, count = np.unique(np.sort(corners, axis=1), axis=0, return_index=True, return_counts=True)
        kept = np.sort(first[count == 1])
        kept = kept[np.argsort(cell[kept], kind="stable")]
        outer.append(Polygons(corners[kept], cell[kept]))
    return outer


def without(polygons: Polygons, faces: list[Polygons]) -> Polygons:
    """Return the polygons that are no face of a volume cell: meshers list border faces as cells too."""
    size = polygons.corners.shape[1]
    known = [np.sort(part.corners, axis=1) for part in faces if part.corners.shape[1] == size]
    if not known:
        return polygons
    every = np.concatenate([*known, np.sort(polygons.corners, axis=1)])
    _, number = np.unique(every, axis=0, return_inverse=True)
    number = number.reshape(-1)
    own = len(every) - len(polygons.corners)
    kept = ~np.isin(number[own:], number[:own])
    return Polygons(polygons.corners[kept], polygons.cell[kept])
