"""Open sheets among avatars, such as a floor: a solid below them, so that cloth stays on their side."""

import numpy as np

from toile.geometry.arrays import Float, Int

FLAT = 0.7
"""Share of the area of an open surface that looks one way, from which it is a sheet and not a body."""
DEPTH = 0.1
"""Depth of the solid below a sheet [m]; a tenth of the size of small ones."""


class OpenSheets:
    """The solids below the open sheets of an object: faces once, vertices in every frame.

    `faces` (t, 3) are all triangles of the object at `points` (n, 3) [m]; `is_closed` says that no edge has
    one face. An object of which a part is closed is left alone: what hangs open on a body, such as hair, is
    not a floor.
    """

    def __init__(self, points: Float, faces: Int, *, is_closed: bool) -> None:
        self._solids: list[Int] = [faces]
        self._sheets: list[tuple[Int, Int]] = []
        self._depth: list[float] = []
        if is_closed:
            return
        label = _parts(faces, len(points))[faces[:, 0]]
        pieces = [faces[label == number] for number in np.unique(label)]
        if not all(_is_sheet(points, piece) for piece in pieces):
            return
        self._solids, first = [], len(points)
        for piece in pieces:
            used = np.unique(piece)
            below = np.full(len(points), -1, np.int32)
            below[used] = np.arange(first, first + len(used), dtype=np.int32)
            start, end = _border(piece).T
            walls = (
                np.column_stack([end, start, below[start]]), np.column_stack([end, below[start], below[end]])
            )  # fmt: skip
            self._solids.append(np.concatenate([piece, below[piece[:, ::-1]], *walls]))
            self._sheets.append((used, piece))
            self._depth.append(min(DEPTH, 0.1 * float(_area_vectors(points, piece)[1].sum()) ** 0.5))
            first += len(used)

    @property
    def faces(self) -> Int:
        """Triangles (t, 3) of all that `with_below` returns."""
        return np.concatenate(self._solids).astype(np.int32, copy=False)

    def is_folded(self, points: Float) -> bool:
        """Whether a sheet is folded over, or its faces look to both sides, so that it has no one side."""
        for _, piece in self._sheets:
            normals, areas = _area_vectors(points, piece)
            if (normals @ normals.sum(axis=0) <= 0.0)[areas > 0.0].any():
                return True
        return False

    def turn_to(self, points: Float, place: Float) -> None:
        """Let the sheets at `points` look towards a place (3,), as a floor towards the feet."""
        for number, (used, piece) in enumerate(self._sheets):
            normal = _area_vectors(points, piece)[0].sum(axis=0)
            if (place - points[used].mean(axis=0)) @ normal < 0.0:
                self._solids[number] = self._solids[number][:, ::-1]
                self._depth[number] *= -1.0

    def with_below(self, points: Float) -> Float:
        """Return the points (n, 3) of a frame, and after them those below the sheets."""
        found = [points]
        for (used, piece), depth in zip(self._sheets, self._depth, strict=True):
            normal = _area_vectors(points, piece)[0].sum(axis=0)
            found.append(points[used] - depth * normal / np.linalg.norm(normal))
        return np.concatenate(found)

    def __bool__(self) -> bool:
        """Whether the object consists of open sheets."""
        return bool(self._sheets)


def _parts(faces: Int, count: int) -> Int:
    """Return a number for every vertex, the same for those that faces connect."""
    label = np.arange(count, dtype=np.int32)
    while True:
        root = label[faces]
        least = root.min(axis=1)
        if (root == least[:, None]).all():
            return label
        # The least of what a face joins becomes the root of all of it.
        np.minimum.at(label, root.ravel(), np.repeat(least, 3))
        while not np.array_equal(label, label[label]):
            label = label[label]


def _border(faces: Int) -> Int:
    """Return the edges (b, 2) that only one face has, as it runs along them."""
    edges = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    low, high = np.sort(edges.astype(np.int64), axis=1).T
    _, first, times = np.unique(low * (int(faces.max()) + 1) + high, return_index=True, return_counts=True)
    return np.asarray(edges[np.sort(first[times == 1])])


def _area_vectors(points: Float, faces: Int) -> tuple[Float, Float]:
    """Return normals as long as the faces are large [m2], shape (t, 3), and areas (t,)."""
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    normals = 0.5 * np.cross(b - a, c - a)
    return normals, np.linalg.norm(normals, axis=1)


def _is_sheet(points: Float, faces: Int) -> bool:
    """Whether a connected surface has a border, is nearly flat and not a wall with two sides."""
    normals, areas = _area_vectors(points, faces)
    looks_one_way = np.linalg.norm(normals.sum(axis=0)) > FLAT * areas.sum()
    # Faces that look to both sides of a flat sheet cancel in the sum.
    spread = normals.T @ (normals / np.maximum(areas, 1e-30)[:, None])
    if np.linalg.eigvalsh(spread)[-1] <= FLAT**2 * areas.sum() or not len(_border(faces)):
        return False
    ways = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    return bool(looks_one_way) or len(np.unique(ways, axis=0)) < len(ways)
