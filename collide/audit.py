"""Independent audit of every frame: which triangles cross, by exact arithmetic.

It shares no code with the contact search, which a contract holds: broad phase and triangle test are its own
(`collide/crossings`). Tests compare it with rational numbers and with another library, FCL.
"""

from dataclasses import dataclass

import numpy as np

from toile.collide.crossings.cells import cells_of
from toile.collide.crossings.face_pairs import pairs_between, pairs_within
from toile.geometry.arrays import Float, Int


@dataclass(frozen=True)
class Crossings:
    """Crossing face pairs: (cloth face, avatar face) and within the cloth, shape (k, 2)."""

    avatar: Int
    cloth: Int


def crossings_within(positions: Float, faces: Int, weld: Int) -> Int:
    """Face pairs of a surface that cross each other, each once, the smaller first, shape (k, 2).

    Parameters
    ----------
    positions, faces
        The surface [m], shapes (n, 3) and (t, 3).
    weld
        Vertices with the same number are being sewn together; face pairs that share such a number but
        not the vertex itself lie on the two sides of an open seam and are not counted, shape (n,).

    Touching counts, also of faces in one plane: a gap of nothing is none. Faces with one corner in common
    count if they meet beyond it, faces with an edge in common never.
    """
    return Auditor(None, None).audit(positions, faces, weld).cloth


class Auditor:
    """Counts crossing triangle pairs of cloth against one avatar and itself."""

    def __init__(self, avatar_vertices: Float | None, avatar_faces: Int | None) -> None:
        self._body: tuple[Float, Int] | None = None
        if avatar_vertices is not None and avatar_faces is not None:
            self._body = avatar_vertices, avatar_faces

    def audit(self, positions: Float, faces: Int, weld: Int) -> Crossings:
        """Crossings of the cloth surface.

        Parameters
        ----------
        positions, faces
            Cloth surface [m], shapes (n, 3) and (t, 3).
        weld
            As for `crossings_within`.
        """
        against = within = np.empty((0, 2), np.int32)
        if len(faces):
            cells = cells_of(positions, faces)
            within = pairs_within(positions, faces, weld, cells)
            if self._body is not None:
                against = pairs_between(positions, faces, cells, *self._body)
        return Crossings(against, within)
