"""Tests whether flipped and collapsed edges leave a cloth mesh free of crossings, with a gap.

Two triangles meet if an edge of one passes through the other, or if a vertex of one is too close to the
face of the other, or an edge of one too close to an edge of the other. The distances settle all that is
nearly touching or nearly coplanar, so that the piercing test decides clear cases only.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from toile.collide import bvh
from toile.collide.avatar_surface import AvatarSurface
from toile.collide.fans import corners_from, fans_stay_apart
from toile.collide.pair_distance import length, pair_weights, weighted_sum
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.face_boxes import face_boxes
from toile.geometry.kernel import (
    F64_2,
    I32_1,
    I32_2,
    OUT_BOOL_1,
    OUT_F64_2,
    OUT_I32_1,
    OUT_I32_2,
    helper,
    kernel,
    unsigned,
)

TOUCH = 1e-6
"""Distance over longest side of the new triangle below which triangles that share a node touch elsewhere."""
FOLD = 1e-3
"""Angle between two triangles at their common edge below which they lie on each other [rad]."""


@helper
def _squared_distance(p, i, j):  # type: ignore[no-untyped-def]
    x, y, z = p[i, 0] - p[j, 0], p[i, 1] - p[j, 1], p[i, 2] - p[j, 2]
    return x * x + y * y + z * z


@helper
def _shared_corners(p, weld, triangles, a, b, touch):  # type: ignore[no-untyped-def]
    """How many corners of a are welded to one of b, how many lie at its place, the last of both kinds.

    That is the last one not welded, and the last one welded, or -1.
    """
    welded = 0
    joined = 0
    lone = -1
    shared = -1
    for k in range(3):
        i = triangles[a, k]
        twin = np.int32(-1)  # of the nodes' own type: another would compile the distance once more
        for m in range(3):
            if weld[i] == weld[triangles[b, m]]:
                twin = triangles[b, m]
        if twin < 0:
            lone = k
            continue
        welded += 1
        shared = k
        if _squared_distance(p, i, twin) <= touch * touch:
            joined += 1
    return welded, joined, lone, shared


@helper
def _folded(p, u, v, a, b, touch):  # type: ignore[no-untyped-def]
    """Whether triangles uva and uvb lie on each other, or one of them has no width."""
    ex, ey, ez = p[v, 0] - p[u, 0], p[v, 1] - p[u, 1], p[v, 2] - p[u, 2]
    ax, ay, az = p[a, 0] - p[u, 0], p[a, 1] - p[u, 1], p[a, 2] - p[u, 2]
    bx, by, bz = p[b, 0] - p[u, 0], p[b, 1] - p[u, 1], p[b, 2] - p[u, 2]
    ee = ex * ex + ey * ey + ez * ez
    if ee <= touch * touch:
        return True
    s = (ax * ex + ay * ey + az * ez) / ee
    t = (bx * ex + by * ey + bz * ez) / ee
    ax, ay, az = ax - s * ex, ay - s * ey, az - s * ez
    bx, by, bz = bx - t * ex, by - t * ey, bz - t * ez
    if min(ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz) <= touch * touch:
        return True
    along = ax * bx + ay * by + az * bz
    x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    return along > 0.0 and x * x + y * y + z * z < FOLD * FOLD * along * along


@helper
def _clearly_apart(p, kind, i, j, k, m, reach):  # type: ignore[no-untyped-def]
    """Whether boxes of vertex i and face jkm (kind 0), or of edges ij and km, are more than reach apart."""
    for axis in range(3):
        one, two, three, four = p[i, axis], p[j, axis], p[k, axis], p[m, axis]
        if kind == 0:
            if min(two, three, four) - one > reach or one - max(two, three, four) > reach:
                return True
        elif min(three, four) - max(one, two) > reach or min(one, two) - max(three, four) > reach:
            return True
    return False


@helper
def _too_close(p, weld, triangles, a, b, reach):  # type: ignore[no-untyped-def]
    """Whether an unshared vertex and face, or two unshared edges, are closer than reach."""
    for test in range(15):
        kind = 0
        if test < 3:
            i, j, k, m = triangles[a, test], triangles[b, 0], triangles[b, 1], triangles[b, 2]
        elif test < 6:
            i, j, k, m = triangles[b, test - 3], triangles[a, 0], triangles[a, 1], triangles[a, 2]
        else:
            kind = 1
            ea = (test - 6) // 3
            eb = (test - 6) % 3
            i, j = triangles[a, ea], triangles[a, (ea + 1) % 3]
            k, m = triangles[b, eb], triangles[b, (eb + 1) % 3]
        i, j, k, m = unsigned(i), unsigned(j), unsigned(k), unsigned(m)
        one, other = weld[i], weld[j]
        if one == weld[k] or one == weld[m] or (kind == 0 and one == other):
            continue
        if kind == 1 and (other == weld[k] or other == weld[m]):
            continue
        if _clearly_apart(p, kind, i, j, k, m, reach):
            continue
        wi, wj, wk, wm = pair_weights(p, kind, i, j, k, m)
        x, y, z = weighted_sum(p, i, j, k, m, wi, wj, wk, wm)
        if length(x, y, z) < reach:
            return True
    return False


@helper
def _pierces(p, weld, i, j, a, b, c, touch):  # type: ignore[no-untyped-def]
    """Whether edge ij, which shares no node with triangle abc, passes through it.

    Only where its ends are farther than `touch` from the plane, on both sides: an edge that passes with an
    end nearer than that comes as close to a side of the triangle, or its end does to the face.
    """
    for node in (i, j):
        if weld[node] == weld[a] or weld[node] == weld[b] or weld[node] == weld[c]:
            return False
    x, y, z = p[i, 0], p[i, 1], p[i, 2]
    dx, dy, dz = p[j, 0] - x, p[j, 1] - y, p[j, 2] - z
    ax, ay, az = p[a, 0] - x, p[a, 1] - y, p[a, 2] - z
    bx, by, bz = p[b, 0] - x, p[b, 1] - y, p[b, 2] - z
    cx, cy, cz = p[c, 0] - x, p[c, 1] - y, p[c, 2] - z
    ux, uy, uz = bx - ax, by - ay, bz - az
    vx, vy, vz = cx - ax, cy - ay, cz - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    limit = touch * touch * (nx * nx + ny * ny + nz * nz)
    above = -(nx * ax + ny * ay + nz * az)
    beyond = above + nx * dx + ny * dy + nz * dz
    if above * above <= limit or beyond * beyond <= limit or (above > 0.0) == (beyond > 0.0):
        return False
    # Turning sense of each side of the triangle about the edge.
    ab = dx * (ay * bz - az * by) + dy * (az * bx - ax * bz) + dz * (ax * by - ay * bx)
    bc = dx * (by * cz - bz * cy) + dy * (bz * cx - bx * cz) + dz * (bx * cy - by * cx)
    ca = dx * (cy * az - cz * ay) + dy * (cz * ax - cx * az) + dz * (cx * ay - cy * ax)
    return (ab >= 0.0 and bc >= 0.0 and ca >= 0.0) or (ab <= 0.0 and bc <= 0.0 and ca <= 0.0)


@kernel(types.void(F64_2, I32_1, I32_2, I32_2, types.int64, types.float64, types.float64, OUT_BOOL_1))
def _judge_pairs(  # type: ignore[no-untyped-def]
    p, weld, triangles, pairs, in_cloth, gap_self, gap_body, meets
):
    """Write for every pair (new triangle, other triangle) if they meet; the first `in_cloth` are cloth."""
    for row in range(pairs.shape[0]):
        a = pairs[row, 0]
        b = pairs[row, 1]
        gap = gap_self if row < in_cloth else gap_body
        longest = 0.0
        for k in range(3):
            longest = max(longest, _squared_distance(p, triangles[a, k], triangles[a, (k + 1) % 3]))
        touch = TOUCH * np.sqrt(longest)
        welded, joined, lone_a, shared_a = _shared_corners(p, weld, triangles, a, b, touch)
        welded_b, joined_b, lone_b, shared_b = _shared_corners(p, weld, triangles, b, a, touch)
        if joined == 3 or joined_b == 3:
            meets[row] = True
            continue
        if joined == 2 and joined_b == 2 and lone_a >= 0 and lone_b >= 0:
            u, v = triangles[a, (lone_a + 1) % 3], triangles[a, (lone_a + 2) % 3]
            meets[row] = _folded(p, u, v, triangles[a, lone_a], triangles[b, lone_b], touch)
            continue
        reach = touch if welded > 0 else max(gap, touch)
        if welded == 1 and welded_b == 1:
            fan = corners_from(triangles, a, unsigned(shared_a))
            other_fan = corners_from(triangles, b, unsigned(shared_b))
            if fans_stay_apart(p, p, *fan, *other_fan, reach):
                meets[row] = False
                continue
        meet = _too_close(p, weld, triangles, a, b, reach)
        test = 0
        while test < 6 and not meet:
            one, other = (a, b) if test < 3 else (b, a)
            i, j = triangles[one, test % 3], triangles[one, (test + 1) % 3]
            meet = _pierces(
                p, weld, i, j, triangles[other, 0], triangles[other, 1], triangles[other, 2], touch
            )
            test += 1
        meets[row] = meet


@kernel(types.void(I32_2, OUT_BOOL_1))
def _settle(rivals, clear):  # type: ignore[no-untyped-def]
    """Give way to clear proposals of lower index; `rivals` (r, 2) are (lower, higher), by the higher."""
    for row in range(len(rivals)):
        if clear[rivals[row, 0]]:
            clear[rivals[row, 1]] = False


@kernel(types.void(F64_2, I32_2, types.float64, OUT_F64_2))
def _grow_boxes(p, triangles, gap, boxes):  # type: ignore[no-untyped-def]
    """Fill `boxes` (q, 6) of triangles [m], wider by the gap or by what counts as touching."""
    for q in range(len(triangles)):
        a, b, c = triangles[q, 0], triangles[q, 1], triangles[q, 2]
        sides = 0.0
        for axis in range(3):
            boxes[q, axis] = min(p[a, axis], p[b, axis], p[c, axis])
            boxes[q, axis + 3] = max(p[a, axis], p[b, axis], p[c, axis])
            sides += boxes[q, axis + 3] - boxes[q, axis]
        grow = max(gap, TOUCH * sides)
        for axis in range(3):
            boxes[q, axis] -= grow
            boxes[q, axis + 3] += grow


@kernel(types.int64(I32_2, I32_1, I32_1, I32_1, types.int32, OUT_I32_1, OUT_I32_2))
def _kept_pairs(pairs, owner, removed, removed_owner, first, link, kept):  # type: ignore[no-untyped-def]
    """Write pairs (new triangle, face) where the triangle's proposal keeps the face; returns how many.

    Faces are numbered from `first` on. Work space: `link` (t + r,), all -1: of every face the last row of
    `removed` that has it, of every row the one before with the same face.
    """
    faces = len(link) - len(removed)
    for row in range(len(removed)):
        link[faces + row] = link[removed[row]]
        link[removed[row]] = row
    count = 0
    for row in range(len(pairs)):
        q, t = pairs[row, 0], pairs[row, 1]
        at = link[t]
        while at >= 0 and removed_owner[at] != owner[q]:
            at = link[faces + at]
        if at < 0:
            kept[count, 0], kept[count, 1] = q, first + t
            count += 1
    return count


class PatchChanges(NamedTuple):
    """Proposals to replace faces by new triangles among existing nodes.

    Attributes
    ----------
    triangles, owner
        New triangles, shape (q, 3), and which proposal each belongs to, shape (q,).
    removed, removed_owner
        Faces that are removed, and which proposal removes each, shape (r,).
    total
        How many proposals there are.
    """

    triangles: Int
    owner: Int
    removed: Int
    removed_owner: Int
    total: int


def clear_proposals(
    positions: Float, faces: Int, weld: Int, changes: PatchChanges, avatar: AvatarSurface | None,
    gap_self: float, gap_body: float,
) -> Bool:  # fmt: skip
    """Tell which proposals may be carried out together without a crossing, shape (total,).

    A proposal replaces faces by new triangles among existing nodes. It is clear if none of its triangles
    meets a face of the cloth that it keeps, a face of the avatar, another of its own triangles, or a
    triangle of a clear proposal of lower index. Triangles meet if they

    - share no node, and cross or are closer than the gap. The gap is a floor and knows nothing of the old
      faces: choose it well below the distance that contacts keep, or cloth at rest on a body is refused.
    - share nodes, and cross or touch (`TOUCH`) elsewhere.
    - share an edge, and lie on each other (`FOLD`), or one of them has no width; or share all nodes.

    Faces that another proposal removes still count: proposals that were clear stay so whichever of them are
    carried out. Proposals that remove the same face exclude each other, which the caller must see to.

    Parameters
    ----------
    positions
        Cloth nodes [m], shape (n, 3).
    faces
        Current cloth faces, shape (t, 3).
    weld
        Nodes with the same number, less than n, count as one, shape (n,). While they are apart (an open
        seam), only the parts of the triangles that they do not belong to are tested.
    changes
        The proposals.
    avatar
        The body at its current place.
    gap_self, gap_body
        Least distance between new triangles and cloth or avatar that they do not share a node with [m].
    """
    triangles, owner, removed, removed_owner, count = changes
    clear = np.ones(count, bool)
    if len(triangles) == 0:
        return clear
    new, kept = len(triangles), len(faces)
    boxes_new = np.empty((new, 6))
    _grow_boxes(positions, triangles, max(gap_self, gap_body), boxes_new)
    tree_new = bvh.build(boxes_new)

    among = bvh.self_overlapping_pairs(tree_new, boxes_new)
    met = bvh.boxes_meeting(tree_new, boxes_new, face_boxes(positions, faces))
    cloth = np.empty_like(met)
    link = np.full(kept + len(removed), -1, np.int32)
    cloth = cloth[: _kept_pairs(met, owner, removed, removed_owner, new, link, cloth)]
    points, welded, corners, pairs = positions, weld, [triangles, faces], [among, cloth]
    if avatar is not None:
        body = bvh.boxes_meeting(tree_new, boxes_new, face_boxes(avatar.vertices, avatar.faces))
        if len(body):
            # Only the faces that are met, with corners of their own.
            own = np.arange(len(positions), len(positions) + 3 * len(body), dtype=np.int32)
            points = np.concatenate([positions, avatar.vertices[avatar.faces[body[:, 1]]].reshape(-1, 3)])
            welded = np.concatenate([weld, own])
            corners.append(own.reshape(-1, 3))
            body[:, 1] = np.arange(new + kept, new + kept + len(body), dtype=np.int32)
            pairs.append(body)

    asked = np.concatenate(pairs)
    meets = np.empty(len(asked), bool)
    in_cloth = len(among) + len(cloth)
    _judge_pairs(points, welded, np.concatenate(corners), asked, in_cloth, gap_self, gap_body, meets)

    if not meets.any():
        return clear
    met = owner[among[meets[: len(among)]]]
    own = met[:, 0] == met[:, 1]
    clear[met[own, 0]] = False
    clear[owner[asked[len(among) :][meets[len(among) :], 0]]] = False
    rivals = np.sort(met[~own], axis=1)
    _settle(rivals[np.argsort(rivals[:, 1], kind="stable")], clear)
    return clear
