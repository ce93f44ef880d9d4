"""Insertion of points into a flat triangulation, from the border inwards, until triangles are small enough.

Frontal Delaunay refinement (Rebay 1993; off-centres after Üngör 2004): a triangle whose circumradius is too
large gets a new point above its shortest edge, where the two new sides have the wanted length, or at its
circumcentre if that is closer. Triangles wait in a queue, so layers of good triangles grow inwards. Border
edges are never split.
"""

import math

import numpy as np
from numba import types

from toile.geometry.kernel import F64_1, F64_2, OUT_F64_1, OUT_F64_2, OUT_I32_1, OUT_I32_2, helper, kernel
from toile.remesh.panel.delaunay_flip import edge_is_delaunay, flip, replace_neighbour
from toile.remesh.panel.plane import after, before, squared_circumradius, squared_distance_to_segment, turn


@helper
def size_and_clearance(px, py, border, border_size, target, grading):  # type: ignore[no-untyped-def]
    """Wanted edge length at p [m] and distance of p to the border [m].

    The wanted length grows by `grading` per metre from the border's own spacing up to the target.
    """
    count = len(border)
    size, nearest = target, math.inf
    for i in range(count):
        j = i + 1 if i + 1 < count else 0
        squared = squared_distance_to_segment(px, py, border[i, 0], border[i, 1], border[j, 0], border[j, 1])
        distance = math.sqrt(squared)
        nearest = min(nearest, distance)
        size = min(size, border_size[i] + grading * distance)
    return size, nearest


@kernel(types.void(F64_2, F64_1, types.float64, types.float64, OUT_F64_1))
def border_point_sizes(border, border_size, target, grading, size):  # type: ignore[no-untyped-def]
    """Wanted edge length [m] at each border point, written to the start of `size`."""
    for i in range(len(border)):
        size[i], _ = size_and_clearance(border[i, 0], border[i, 1], border, border_size, target, grading)


@helper
def containing_triangle(points, corners, across, t, px, py):  # type: ignore[no-untyped-def]
    """Walk from triangle t towards p; -1 if the border is in the way."""
    for _ in range(len(corners)):
        moved = False
        for k in range(3):
            b, c = corners[t, after(k)], corners[t, before(k)]
            if turn(points[b, 0], points[b, 1], points[c, 0], points[c, 1], px, py) < 0.0:
                t = across[t, k]
                moved = True
                break
        if not moved or t < 0:
            return t
    return -1


@helper
def candidate(points, corners, t, size, use_centre):  # type: ignore[no-untyped-def]
    """Return the new point for triangle t: off-centre above its shortest edge, or the circumcentre."""
    best, short = 0, math.inf
    for k in range(3):
        b, c = corners[t, after(k)], corners[t, before(k)]
        squared = (points[b, 0] - points[c, 0]) ** 2 + (points[b, 1] - points[c, 1]) ** 2
        if squared < short:
            best, short = k, squared
    a, b, c = corners[t, best], corners[t, after(best)], corners[t, before(best)]
    ax, ay = points[a, 0], points[a, 1]
    bx, by = points[b, 0], points[b, 1]
    cx, cy = points[c, 0], points[c, 1]
    # Height of the circumcentre above the middle of bc: |bc|/2 cot(angle at a).
    cos_a = (bx - ax) * (cx - ax) + (by - ay) * (cy - ay)
    twice = turn(ax, ay, bx, by, cx, cy)
    half = math.sqrt(short) / 2.0
    height = half * cos_a / max(twice, 1e-300)
    if not use_centre:
        height = min(height, math.sqrt(max(size * size - half * half, 0.25 * size * size)))
    factor = height / (2.0 * half)
    return 0.5 * (bx + cx) - factor * (cy - by), 0.5 * (by + cy) + factor * (cx - bx)


@helper
def is_large(points, corners, size, t, limit):  # type: ignore[no-untyped-def]
    """Tell whether the circumradius exceeds `limit` times the wanted edge length at the triangle."""
    a, b, c = corners[t, 0], corners[t, 1], corners[t, 2]
    wanted = limit * (size[a] + size[b] + size[c]) / 3.0
    squared = squared_circumradius(
        points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1]
    )
    return squared > wanted * wanted


@kernel(
    types.UniTuple(types.int64, 2)(
        F64_2, F64_1, types.float64, types.float64, types.float64, types.int64, types.int64,
        OUT_F64_2, OUT_F64_1, OUT_I32_2, OUT_I32_2, OUT_I32_1, OUT_I32_1,
    )
)  # fmt: skip
def insert_points(  # type: ignore[no-untyped-def]
    border,
    border_size,
    target,
    grading,
    limit,
    vertex_count,
    face_count,
    points,
    size,
    corners,
    across,
    queue,
    queued,
):
    """Insert points until no circumradius exceeds `limit` times the wanted edge length, or room ends.

    `points`, `size`, `corners` and `across` hold a constrained Delaunay triangulation and room for more;
    `queue` and `queued` are work space, one entry per triangle. Returns the counts of vertices and triangles;
    where the vertices fill `points`, there was not enough room.
    """
    room = len(queue)
    head, waiting = 0, 0
    for t in range(face_count):
        queue[waiting] = t
        queued[t] = 1
        waiting += 1
    while waiting > 0:
        t = queue[head]
        head = (head + 1) % room
        waiting -= 1
        queued[t] = 0
        if vertex_count >= len(points) or face_count + 2 > room:
            break
        if not is_large(points, corners, size, t, limit):
            continue
        wanted = (size[corners[t, 0]] + size[corners[t, 1]] + size[corners[t, 2]]) / 3.0
        inside = -1
        px, py, new_size = 0.0, 0.0, 0.0
        for attempt in range(2):
            px, py = candidate(points, corners, t, wanted, attempt == 1)
            inside = containing_triangle(points, corners, across, t, px, py)
            if inside < 0:
                continue
            new_size, clearance = size_and_clearance(px, py, border, border_size, target, grading)
            if clearance < 0.5 * new_size:
                inside = -1
                continue
            break
        if inside < 0:
            continue
        p = vertex_count
        vertex_count += 1
        a, b, c = corners[inside, 0], corners[inside, 1], corners[inside, 2]
        # Off any edge of its triangle by a hair, so that all three parts have area.
        points[p, 0] = px + 1e-6 * ((points[a, 0] + points[b, 0] + points[c, 0]) / 3.0 - px)
        points[p, 1] = py + 1e-6 * ((points[a, 1] + points[b, 1] + points[c, 1]) / 3.0 - py)
        size[p] = new_size
        t1, t2 = face_count, face_count + 1
        face_count += 2
        beyond_a, beyond_b, beyond_c = across[inside, 0], across[inside, 1], across[inside, 2]
        corners[inside, 0], corners[inside, 1], corners[inside, 2] = p, b, c
        corners[t1, 0], corners[t1, 1], corners[t1, 2] = p, c, a
        corners[t2, 0], corners[t2, 1], corners[t2, 2] = p, a, b
        across[inside, 0], across[inside, 1], across[inside, 2] = beyond_a, t1, t2
        across[t1, 0], across[t1, 1], across[t1, 2] = beyond_b, t2, inside
        across[t2, 0], across[t2, 1], across[t2, 2] = beyond_c, inside, t1
        replace_neighbour(across, beyond_b, inside, t1)
        replace_neighbour(across, beyond_c, inside, t2)
        # Legalise: turn about p; corner 0 of every triangle of its star is p.
        spoke = inside
        start = inside
        tip = np.int64(0)  # typed: a literal would be a second specialisation of the two helpers
        while True:
            if not edge_is_delaunay(points, corners, across, spoke, tip):
                flip(corners, across, spoke, tip)
                start = spoke
                continue
            spoke = across[spoke, 1]
            if spoke == start:
                break
        # Queue the star.
        spoke = start
        while True:
            if queued[spoke] == 0:
                queue[(head + waiting) % room] = spoke
                queued[spoke] = 1
                waiting += 1
            spoke = across[spoke, 1]
            if spoke == start:
                break
    return vertex_count, face_count
