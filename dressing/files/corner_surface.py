"""A triangulated surface as mesh files hold it: nodes, and texture coordinates per face corner."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from toile.geometry.arrays import Float, Int


@dataclass(frozen=True, kw_only=True)
class Surface:
    """Triangles with shared nodes and separate texture coordinates, in a file's units.

    Attributes
    ----------
    positions
        Nodes, shape (n, 3).
    faces
        Triangles into positions, shape (t, 3).
    uv
        Texture coordinates, shape (k, 2); empty where the file has none.
    uv_faces
        The same triangles into uv, shape (t, 3); -1 where a face has none.
    panel
        Group of every face, shape (t,).
    panel_names
        One name per group.
    file_face
        Number of the face in the file, from 0, shape (t,): a polygon gives several triangles.
    """

    positions: Float
    faces: Int
    uv: Float
    uv_faces: Int
    panel: Int
    panel_names: tuple[str, ...]
    file_face: Int

    @staticmethod
    def from_polygons(
        *,
        positions: Float,
        corners: Sequence[Sequence[int]],
        uv: Float,
        uv_corners: Sequence[Sequence[int]],
        panel: Int,
    ) -> "Surface":
        """Return the surface with quads split along their better diagonal and larger polygons as fans."""
        sizes = np.array([len(face) for face in corners], dtype=np.int64)
        pieces: list[tuple[Int, Int, Int]] = []
        for size in np.unique(sizes).tolist():
            which = np.flatnonzero(sizes == size).astype(np.int32)
            nodes = np.array([corners[i] for i in which.tolist()], dtype=np.int32)
            texture = np.array([uv_corners[i] for i in which.tolist()], dtype=np.int32)
            if size == 4:
                turned = split_from_second(positions, nodes)
                nodes[turned] = np.roll(nodes[turned], -1, axis=1)
                texture[turned] = np.roll(texture[turned], -1, axis=1)
            for k in range(1, size - 1):
                pieces.append((which, nodes[:, [0, k, k + 1]], texture[:, [0, k, k + 1]]))
        if not pieces:
            pieces = [(np.empty(0, np.int32), np.empty((0, 3), np.int32), np.empty((0, 3), np.int32))]
        source = np.concatenate([piece[0] for piece in pieces])
        order = np.argsort(source, kind="stable")
        return Surface(
            positions=positions,
            faces=np.concatenate([piece[1] for piece in pieces])[order],
            uv=uv,
            uv_faces=np.concatenate([piece[2] for piece in pieces])[order],
            panel=panel[source[order]],
            panel_names=(),
            file_face=source[order].astype(np.int32),
        )

    def with_panel_names(self, names: tuple[str, ...]) -> "Surface":
        """Return the same surface with its groups named; one unnamed group becomes "garment"."""
        return replace(self, panel_names=tuple(name or "garment" for name in names) or ("garment",))


def split_from_second(positions: Float, quads: Int) -> Int:
    """Return the quads (q, 4) to be split from corner 1 to 3: where normals stay alike, or it is shorter."""
    p = positions[quads]
    agree = []
    for a, b, c, d in ((0, 1, 2, 3), (1, 2, 3, 0)):
        first = np.cross(p[:, b] - p[:, a], p[:, c] - p[:, a])
        second = np.cross(p[:, c] - p[:, a], p[:, d] - p[:, a])
        agree.append(np.einsum("ij,ij->i", first, second, dtype=np.float64) > 0.0)
    longer = np.linalg.norm(p[:, 0] - p[:, 2], axis=1) > np.linalg.norm(p[:, 1] - p[:, 3], axis=1)
    better = np.where(np.equal(agree[0], agree[1]), longer, agree[1])
    return np.flatnonzero(better).astype(np.int32)
