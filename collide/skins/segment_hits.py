"""Faces of a surface that straight segments cross, found by a hierarchy over the faces.

For many segments and poses that change: `collide.segments` answers the same by FCL, from scratch.
Segment and triangle: Moeller and Trumbore 1997.
"""

import numpy as np
from numba import types

from toile.collide import bvh
from toile.geometry.arrays import Float, Int
from toile.geometry.face_boxes import face_boxes
from toile.geometry.kernel import F64_2, I32_1, I32_2, OUT_I32_2, helper, kernel
from toile.geometry.threads.crew import in_parts, together

SEGMENTS_PER_PART = 1024
"""Segments that one thread follows at a time."""


@helper
def _meets_box(start, way, s, box, node):  # type: ignore[no-untyped-def]
    """Whether segment s, start + t way with t from 0 to 1, meets a box."""
    enters, leaves = 0.0, 1.0
    for axis in range(3):
        low, high = box[node, axis] - start[s, axis], box[node, axis + 3] - start[s, axis]
        if way[s, axis] == 0.0:
            if low > 0.0 or high < 0.0:
                return False
            continue
        one, other = low / way[s, axis], high / way[s, axis]
        enters, leaves = max(enters, min(one, other)), min(leaves, max(one, other))
    return enters <= leaves


@helper
def _meets_face(start, way, s, p, a, b, c):  # type: ignore[no-untyped-def]
    """Whether segment s meets triangle abc; one in its plane does not."""
    ux, uy, uz = p[b, 0] - p[a, 0], p[b, 1] - p[a, 1], p[b, 2] - p[a, 2]
    vx, vy, vz = p[c, 0] - p[a, 0], p[c, 1] - p[a, 1], p[c, 2] - p[a, 2]
    dx, dy, dz = way[s, 0], way[s, 1], way[s, 2]
    hx, hy, hz = dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx
    volume = ux * hx + uy * hy + uz * hz
    if volume == 0.0:
        return False
    wx, wy, wz = start[s, 0] - p[a, 0], start[s, 1] - p[a, 1], start[s, 2] - p[a, 2]
    first = (wx * hx + wy * hy + wz * hz) / volume
    qx, qy, qz = wy * uz - wz * uy, wz * ux - wx * uz, wx * uy - wy * ux
    second = (dx * qx + dy * qy + dz * qz) / volume
    along = (vx * qx + vy * qy + vz * qz) / volume
    return first >= 0.0 and second >= 0.0 and first + second <= 1.0 and 0.0 <= along <= 1.0


@kernel(types.int64(F64_2, F64_2, F64_2, I32_2, I32_1, I32_2, F64_2, OUT_I32_2))
def _hits(start, way, p, faces, order, child, tree_box, pairs):  # type: ignore[no-untyped-def]
    """Write pairs (segment, face) that meet while they fit; return how many there are."""
    found = 0
    stack = np.empty(128, np.int32)
    for s in range(start.shape[0]):
        stack[0] = 0
        depth = 1
        while depth > 0:
            depth -= 1
            node = stack[depth]
            if not _meets_box(start, way, s, tree_box, node):
                continue
            if child[node, 0] >= 0:
                stack[depth] = child[node, 1]
                stack[depth + 1] = child[node, 0]
                depth += 2
                continue
            first = -1 - child[node, 0]
            for k in range(first, first + child[node, 1]):
                face = order[k]
                if _meets_face(start, way, s, p, faces[face, 0], faces[face, 1], faces[face, 2]):
                    if found < pairs.shape[0]:
                        pairs[found, 0] = s
                        pairs[found, 1] = face
                    found += 1
    return found


class SegmentHits:
    """Segments against the faces (t, 3) of one surface that takes on one pose after the other."""

    def __init__(self, vertices: Float, faces: Int) -> None:
        """Build the hierarchy from a pose [m], shape (v, 3)."""
        self._faces = faces
        self._tree = bvh.build(face_boxes(vertices, faces))
        self._vertices = vertices

    def pose(self, vertices: Float) -> None:
        """Take on another pose [m], shape (v, 3)."""
        self._vertices = np.ascontiguousarray(vertices)
        bvh.refit(self._tree, face_boxes(vertices, self._faces))

    def hits(self, start: Float, end: Float) -> Int:
        """Segments from start to end [m], shapes (s, 3), and the faces that they cross, pairs (k, 2)."""
        tree, way = self._tree, np.ascontiguousarray(end - start)
        start = np.ascontiguousarray(start)

        def find(first: int, last: int) -> Int:
            some = slice(first, last)
            capacity = 4 * (last - first) + 64
            while True:
                pairs = np.empty((capacity, 2), np.int32)
                found = _hits(
                    start[some], way[some], self._vertices, self._faces, tree.order, tree.child, tree.box,
                    pairs,
                )  # fmt: skip
                if found <= capacity:
                    pairs = pairs[:found]
                    pairs[:, 0] += first
                    return pairs
                capacity = found

        return together(in_parts(find, len(start), SEGMENTS_PER_PART), 2)
