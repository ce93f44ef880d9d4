"""Filling of holes: boundary loops and the triangles that close them."""

import manifold3d
import numpy as np
from scipy.spatial import cKDTree

from toile.geometry.arrays import Float, Int

LONGEST_SEARCHED, PIECE = 400, 128
"""Longest loop [edges] whose best patch is searched, at cubic cost, and of the pieces of longer ones."""

PLANAR_SPREAD = 0.02
"""A loop this flat, relative to its size, is capped in its plane."""


def boundary_loops(faces: Int) -> list[Int]:
    """Return the closed vertex loops along the holes of consistently oriented faces.

    A loop runs so that triangles counter-clockwise along it have the same orientation as the faces.
    """
    start, end = faces.ravel().astype(np.int64), faces[:, [1, 2, 0]].ravel().astype(np.int64)
    span = int(faces.max()) + 1
    # Where a third face hangs on an edge, one way along it comes twice and the other once.
    ways, times = np.unique(np.concatenate([start * span + end, end * span + start]), return_inverse=True)
    excess = np.bincount(times[: len(start)], minlength=len(ways))
    excess -= np.bincount(times[len(start) :], minlength=len(ways))
    lone = np.repeat(ways, np.maximum(excess, 0))
    following: dict[int, list[int]] = {}
    for vertex, after in zip((lone % span).tolist(), (lone // span).tolist(), strict=True):
        following.setdefault(vertex, []).append(after)
    loops: list[Int] = []
    for first in sorted(following):
        while following[first]:
            path = [first]
            while following[path[-1]]:
                after = following[path[-1]].pop()
                path.append(after)
                # Holes may touch in a vertex: each is a loop of its own.
                begin = path.index(after)
                if begin < len(path) - 1:
                    loop = path[begin:-1]
                    del path[begin + 1 :]
                    turn = loop.index(min(loop))
                    loops.append(np.array(loop[turn:] + loop[:turn], dtype=np.int32))
    return sorted(loops, key=lambda loop: int(loop[0]))


def fill_loop(points: Float) -> Int:
    """Triangles (t, 3) into the loop's points [m] that close it.

    Flat loops are triangulated in their plane; curved ones get the patch of least area (dynamic
    programming over all triangulations, Barequet and Sharir 1995). Very long ones are cut in two by the
    shortest chord between parts of at least a third, and again.
    """
    count = len(points)
    if count == 3:
        return np.array([[0, 1, 2]], dtype=np.int32)
    flat = _fill_flat(points)
    if flat is not None:
        return flat
    if count <= LONGEST_SEARCHED:
        return _fill_least_area(points)
    return np.concatenate([loop[_fill_least_area(points[loop])] for loop in _pieces(points)])


def _pieces(points: Float) -> list[Int]:
    """Loops of at most PIECE corners, as numbers of points, that share chords and make up a long loop."""
    waiting = [np.arange(len(points), dtype=np.int32)]
    pieces: list[Int] = []
    while waiting:
        loop = waiting.pop()
        count = len(loop)
        if count <= PIECE:
            pieces.append(loop)
            continue
        least, best = np.inf, (0, count // 2)
        for start in range(count - count // 3):
            ends = np.arange(start + count // 3, min(start + count - count // 3, count - 1) + 1)
            if len(ends):
                length = np.linalg.norm(points[loop[ends]] - points[loop[start]], axis=1)
                nearest = int(length.argmin())
                if length[nearest] < least:
                    least, best = float(length[nearest]), (start, int(ends[nearest]))
        start, end = best
        waiting += [loop[start : end + 1], np.concatenate([loop[: start + 1], loop[end:]])]
    return pieces


def _fill_flat(points: Float) -> Int | None:
    """Triangulate a flat, simple loop in its plane; None if it is neither."""
    centred = points - points.mean(axis=0)
    # Newell's normal: exact for flat loops, the mean direction for wavy ones.
    normal = np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0)
    length = float(np.linalg.norm(normal))
    size = float(np.ptp(centred, axis=0).max())
    if length < 1e-3 * size * size:
        return None
    normal /= length
    if float(np.ptp(centred @ normal)) > PLANAR_SPREAD * size:
        return None
    helper = np.eye(3)[int(np.argmin(np.abs(normal)))]
    first = np.cross(helper, normal)
    first /= np.linalg.norm(first)
    plane = np.column_stack([centred @ first, centred @ np.cross(normal, first)])
    if len(cKDTree(plane).query_pairs(1e-9)):
        return None
    triangles = np.asarray(manifold3d.triangulate([plane], 0.0), dtype=np.int32)
    if len(triangles) != len(points) - 2:
        return None
    a, b, c = (plane[triangles[:, k]] for k in range(3))
    u, v = b - a, c - a
    area = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    # A loop that crosses itself in the plane gives turned triangles: not a clean cap.
    if area.min() < -1e-9 * size * size or abs(2.0 * area.sum() - length) > 1e-6 * length:
        return None
    return triangles


def _fill_least_area(points: Float) -> Int:
    """Triangulation of a closed loop with the least total area, shape (n - 2, 3)."""
    count = len(points)
    cost = np.zeros((count, count))
    split = np.zeros((count, count), dtype=np.int64)
    for gap in range(2, count):
        for i in range(count - gap):
            k = i + gap
            middle = np.arange(i + 1, k)
            normals = np.cross(points[middle] - points[i], points[k] - points[i])
            total = cost[i, middle] + cost[middle, k] + 0.5 * np.linalg.norm(normals, axis=1)
            best = int(np.argmin(total))
            cost[i, k], split[i, k] = total[best], middle[best]
    triangles: list[tuple[int, int, int]] = []
    stack = [(0, count - 1)]
    while stack:
        i, k = stack.pop()
        if k - i < 2:
            continue
        m = int(split[i, k])
        triangles.append((i, m, k))
        stack += [(i, m), (m, k)]
    return np.array(triangles, dtype=np.int32)
