"""A triangulated surface as mesh files hold it: nodes, and texture coordinates per face corner."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from toile.dressing.files.polygon_split import split_polygons
from toile.geometry.arrays import Bool, Float, Int


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
    attributes
        Numbers of the file at its nodes by their names, shape (n,) each, where it was just read.
    """

    positions: Float
    faces: Int
    uv: Float
    uv_faces: Int
    panel: Int
    panel_names: tuple[str, ...]
    file_face: Int
    attributes: Mapping[str, Float] = field(default_factory=dict)

    @staticmethod
    def from_polygons(
        *,
        positions: Float,
        corners: Sequence[Sequence[int]],
        uv: Float,
        uv_corners: Sequence[Sequence[int]],
        panel: Int,
        shape: Float | None = None,
    ) -> "Surface":
        """Return the surface with its polygons split into triangles.

        Quads are split along their better diagonal, larger polygons as `split_polygons` does; triangles are
        listed in the order of the polygons. Where the positions of `shape` are given, they decide the split:
        those of the first of many frames, so that all have the same triangles.
        """
        places = positions
        if shape is not None and shape.shape == positions.shape:
            places = shape
        sizes = np.array([len(face) for face in corners], dtype=np.int64)
        pieces: list[tuple[Int, Int, Int]] = []
        for size in np.unique(sizes).tolist():
            which = np.flatnonzero(sizes == size).astype(np.int32)
            nodes = np.array([corners[i] for i in which.tolist()], dtype=np.int32)
            texture = np.array([uv_corners[i] for i in which.tolist()], dtype=np.int32)
            if size == 4:
                turned = split_from_second(places, nodes)
                nodes[turned] = np.roll(nodes[turned], -1, axis=1)
                texture[turned] = np.roll(texture[turned], -1, axis=1)
            if size <= 4:
                ears = np.array([[0, k, k + 1] for k in range(1, size - 1)], np.int32).reshape(-1, 3)
                split = np.broadcast_to(ears, (len(nodes), *ears.shape))
            else:
                split = split_polygons(places[nodes])
            row = np.arange(len(nodes))[:, None]
            for k in range(split.shape[1]):
                pieces.append((which, nodes[row, split[:, k]], texture[row, split[:, k]]))
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

    def with_faces(self, kept: Bool) -> "Surface":
        """Return the surface with the faces that are marked, shape (t,), on the same nodes."""
        return replace(
            self, faces=self.faces[kept], uv_faces=self.uv_faces[kept], panel=self.panel[kept],
            file_face=self.file_face[kept],
        )  # fmt: skip

    def with_panel_names(self, names: tuple[str, ...]) -> "Surface":
        """Return the same surface with its groups named; one unnamed group becomes "garment"."""
        return replace(self, panel_names=tuple(name or "garment" for name in names) or ("garment",))


def triangle_surface(positions: Float, faces: Int) -> Surface:
    """Return triangles without texture, (t, 3), on positions, (n, 3), as a surface of one panel."""
    return Surface(
        positions=positions,
        faces=faces,
        uv=np.empty((0, 2)),
        uv_faces=np.full(faces.shape, -1, np.int32),
        panel=np.zeros(len(faces), np.int32),
        panel_names=("garment",),
        file_face=np.arange(len(faces), dtype=np.int32),
    )


def node_attributes(
    columns: Mapping[str, Any], count: int, not_these: Iterable[str] = ()
) -> dict[str, Float]:
    """Return the columns of a file that hold one finite number for each of so many nodes, by their names."""
    found: dict[str, Float] = {}
    for name, values in columns.items():
        if name in not_these or not isinstance(values, np.ndarray) or values.dtype.kind not in "biuf":
            continue
        if values.size == count and values.shape[0] == count and np.isfinite(values).all():
            found[name] = values.reshape(count).astype(np.float64)
    return found


class MeshFile(NamedTuple):
    """The surface that a file holds, in its units, and what was noticed, one sentence each."""

    surface: Surface
    notes: tuple[str, ...]


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
