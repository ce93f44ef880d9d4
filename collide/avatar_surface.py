"""The surface of an avatar, ready to be searched."""

import numpy as np
from numba import types

from toile.collide import bvh
from toile.collide.surface import surface_of
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_1, F64_2, I32_2, OUT_F64_2, kernel
from toile.geometry.normals import area_normals


@kernel(types.void(F64_2, F64_2, I32_2, F64_1, OUT_F64_2))
def moving_boxes(p, ends, faces, reach, boxes):  # type: ignore[no-untyped-def]
    """Boxes of faces at p and at ends [m], shape (t, 12), each grown by the largest reach of its vertices."""
    for t in range(faces.shape[0]):
        a = faces[t, 0]
        b = faces[t, 1]
        c = faces[t, 2]
        grow = max(reach[a], reach[b], reach[c])
        for axis in range(3):
            boxes[t, axis] = min(p[a, axis], p[b, axis], p[c, axis]) - grow
            boxes[t, axis + 3] = max(p[a, axis], p[b, axis], p[c, axis]) + grow
            boxes[t, axis + 6] = min(ends[a, axis], ends[b, axis], ends[c, axis]) - grow
            boxes[t, axis + 9] = max(ends[a, axis], ends[b, axis], ends[c, axis]) + grow


class AvatarSurface:
    """An avatar, ready to be searched: shared by all topologies of a run.

    Attributes
    ----------
    vertices
        Current positions [m], shape (v, 3); change them through `move_to`.
    motion
        How far each vertex may move before the next search [m], shape (v,): from where it is or, with a
        drift, from the place that drifts along.
    drift
        Where the vertices are going [m], shape (v, 3), or None.
    bound_for
        Places that they are on the way to [m], shape (v, 3), beyond the step at hand; None where not known.
    off_course
        How far from the straight way there they will be at most [m], shape (v,).
    rows
        Numbers of its vertices in the whole avatar, shape (v,), where it is a part of one; else None.
    """

    def __init__(self, vertices: Float, faces: Int, rows: Int | None = None) -> None:
        self.vertices = vertices.copy()
        self.faces = faces
        self.rows = rows
        self.surface = surface_of(faces)
        self.motion = np.zeros(len(vertices))
        self.drift: Float | None = None
        self.bound_for: Float | None = None
        self.off_course = np.zeros(len(vertices))
        self.boxes = np.empty((len(faces), 12))
        self._tree: bvh.Bvh | None = None
        self._reach = np.full(len(vertices), -1.0)

    def expect(self, motion: Float, drift: Float | None = None) -> None:
        """Say how far vertices may move before the next search [m], (v,), and where they drift, (v, 3)."""
        self.motion, self.drift = motion, drift

    def stay(self) -> None:
        """Expect no motion in the next search."""
        self.motion = np.zeros(len(self.vertices))
        self.drift = None

    def move_to(self, vertices: Float) -> None:
        """Put the vertices elsewhere; the next search refits the hierarchy."""
        self.vertices = vertices
        self._reach[:] = -1.0

    def tree(self, reach: Float, ends: Float | None = None) -> bvh.Bvh:
        """Hierarchy over the faces, each grown by the largest reach of its vertices [m], shape (v,).

        With `ends` [m], shape (v, 3), the faces move there.
        """
        if self._tree is None or ends is not None or not np.array_equal(reach, self._reach):
            still = ends is None
            moving_boxes(self.vertices, self.vertices if still else ends, self.faces, reach, self.boxes)
            self._reach[:] = reach if still else -1.0
            if self._tree is None:
                self._tree = bvh.build(self.boxes)
            else:
                bvh.refit(self._tree, self.boxes)
        return self._tree

    @property
    def known_tree(self) -> bvh.Bvh:
        """The hierarchy as it was searched last."""
        assert self._tree is not None
        return self._tree

    @property
    def vertex_area(self) -> Float:
        """A third of the area of the faces around each vertex [m^2], shape (v,)."""
        area = 0.5 * np.linalg.norm(area_normals(self.vertices[self.faces]), axis=1)
        shares = np.repeat(area / 3.0, 3)
        count = len(self.vertices)
        return np.asarray(np.bincount(self.faces.ravel(), weights=shares, minlength=count), np.float64)
