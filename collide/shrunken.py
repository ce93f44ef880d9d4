"""A thinner copy of the avatar: seams close around it, then it grows back to its true shape.

Every vertex moves inward along its smoothed normal by the wanted depth, or less where the body is thin:
the thickness is measured by a ray through the body. Where the body faces itself across a narrow gap
(armpit, crotch), measured by a ray outward, it stays: opening such a place would let cloth in that is
caught when the body grows.
"""

from math import inf

import numpy as np
from numba import types

from toile.collide import bvh
from toile.geometry.arrays import Float, Int
from toile.geometry.face_boxes import face_boxes
from toile.geometry.kernel import F64_2, I32_1, I32_2, OUT_F64_1, helper, kernel
from toile.geometry.normals import vertex_normals

THIN_SHARE = 0.35
"""Largest inward motion as a share of the local thickness: less than half, or opposite sides would cross."""
WIDE_GAP = 0.25
"""Distance [m] across which a body that faces itself is shrunk in full; less in proportion below."""
SMOOTHING = 8


@helper
def _slab(box, node, ox, oy, oz, dx, dy, dz, limit):  # type: ignore[no-untyped-def]
    """Whether the ray o + t d, 0 <= t <= limit, meets a box."""
    low = 0.0
    high = limit
    for axis in range(3):
        o = ox if axis == 0 else (oy if axis == 1 else oz)
        d = dx if axis == 0 else (dy if axis == 1 else dz)
        if abs(d) < 1e-12:
            if o < box[node, axis] or o > box[node, axis + 3]:
                return False
        else:
            a = (box[node, axis] - o) / d
            b = (box[node, axis + 3] - o) / d
            low = max(low, min(a, b))
            high = min(high, max(a, b))
    return low <= high


@helper
def _hit(p, a, b, c, ox, oy, oz, dx, dy, dz):  # type: ignore[no-untyped-def]
    """Ray parameter at which triangle abc is met, inf if it is not (Moeller and Trumbore 1997)."""
    ux, uy, uz = p[b, 0] - p[a, 0], p[b, 1] - p[a, 1], p[b, 2] - p[a, 2]
    vx, vy, vz = p[c, 0] - p[a, 0], p[c, 1] - p[a, 1], p[c, 2] - p[a, 2]
    hx, hy, hz = dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx
    det = ux * hx + uy * hy + uz * hz
    if abs(det) < 1e-18:
        return inf
    sx, sy, sz = ox - p[a, 0], oy - p[a, 1], oz - p[a, 2]
    s = (sx * hx + sy * hy + sz * hz) / det
    qx, qy, qz = sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux
    t = (dx * qx + dy * qy + dz * qz) / det
    if s < 0.0 or t < 0.0 or s + t > 1.0:
        return inf
    return (vx * qx + vy * qy + vz * qz) / det


@kernel(types.void(F64_2, I32_2, F64_2, I32_1, I32_2, F64_2, types.float64, OUT_F64_1))
def _thickness(p, faces, normals, order, child, box, limit, thickness):  # type: ignore[no-untyped-def]
    stack = np.empty(256, np.int64)
    for v in range(p.shape[0]):
        dx, dy, dz = -normals[v, 0], -normals[v, 1], -normals[v, 2]
        nearest = limit
        stack[0] = 0
        depth = 1
        while depth > 0:
            depth -= 1
            node = stack[depth]
            if not _slab(box, node, p[v, 0], p[v, 1], p[v, 2], dx, dy, dz, nearest):
                continue
            if child[node, 0] < 0:
                first = -1 - child[node, 0]
                for k in range(first, first + child[node, 1]):
                    a = faces[order[k], 0]
                    b = faces[order[k], 1]
                    c = faces[order[k], 2]
                    if a == v or b == v or c == v:
                        continue
                    t = _hit(p, a, b, c, p[v, 0], p[v, 1], p[v, 2], dx, dy, dz)
                    if 1e-6 < t < nearest:
                        nearest = t
            else:
                stack[depth] = child[node, 0]
                stack[depth + 1] = child[node, 1]
                depth += 2
        thickness[v] = nearest


def shrunken(vertices: Float, faces: Int, depth: float) -> Float:
    """Vertices moved inward by at most `depth` [m], shape (v, 3)."""
    boxes = face_boxes(vertices, faces)
    tree = bvh.build(boxes)
    normals = vertex_normals(vertices, faces)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    count = np.maximum(np.bincount(edges[:, 0], minlength=len(vertices)), 1)

    def smooth(values: Float) -> Float:
        summed = np.bincount(edges[:, 0], weights=values[edges[:, 1]], minlength=len(vertices))
        return np.asarray(0.5 * values + 0.5 * summed / count)

    for _ in range(SMOOTHING):
        normals = np.stack([smooth(normals[:, k]) for k in range(3)], axis=1)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    normals = np.ascontiguousarray(normals)
    thickness = np.empty(len(vertices))
    gap = np.empty(len(vertices))
    _thickness(
        vertices, faces, normals, tree.order, tree.child, tree.box, 2.0 * depth / THIN_SHARE, thickness
    )
    _thickness(vertices, faces, -normals, tree.order, tree.child, tree.box, WIDE_GAP, gap)
    inward = np.minimum(depth * gap / WIDE_GAP, THIN_SHARE * thickness)
    for _ in range(SMOOTHING):
        inward = np.minimum(inward, smooth(inward))
    for _ in range(SMOOTHING):
        inward = smooth(inward)
    return np.ascontiguousarray(vertices - inward[:, None] * normals)
