"""Greedy choice of node merges that keeps edges short, triangles well shaped and the surface manifold."""

from numba import types

from toile.geometry.kernel import F64_1, F64_2, I32_1, I32_2, OUT_BOOL_1, OUT_I32_1, helper, kernel
from toile.remesh.sizing.metric import aspect, squared_length, twice_area

LEAST_ASPECT = 0.2
"""A merge may not make triangles worse than this, in the metric, unless they were as bad before."""
LEAST_HEIGHT = 1e-3
"""Twice the area over the squared edges of any new triangle in rest space: away from inverted."""


@helper
def height(rest, normals, t, a, b, c):  # type: ignore[no-untyped-def]
    """Twice the area of a triangle about the normal of face t, over the sum of its squared edges."""
    ux, uy, uz = rest[b, 0] - rest[a, 0], rest[b, 1] - rest[a, 1], rest[b, 2] - rest[a, 2]
    vx, vy, vz = rest[c, 0] - rest[a, 0], rest[c, 1] - rest[a, 1], rest[c, 2] - rest[a, 2]
    squares = ux * ux + uy * uy + uz * uz + vx * vx + vy * vy + vz * vz
    squares += (vx - ux) ** 2 + (vy - uy) ** 2 + (vz - uz) ** 2
    return twice_area(rest, normals, t, a, b, c) / max(squares, 1e-300)


@helper
def has_node(faces, node, t, i):  # type: ignore[no-untyped-def]
    """Tell whether face t has node i."""
    return node[faces[t, 0]] == i or node[faces[t, 1]] == i or node[faces[t, 2]] == i


@helper
def is_blocked(offsets, around, faces, node, used, is_target, i, j):  # type: ignore[no-untyped-def]
    """Tell whether merging i into j touches a merge already taken.

    No face in common; and two merges into neighbours, or into the same node, could both make one edge.
    """
    if is_target[j]:
        return True
    for r in range(offsets[i], offsets[i + 1]):
        t = around[r]
        if used[t]:
            return True
        for corner in range(3):
            if is_target[node[faces[t, corner]]]:
                return True
    return False


@helper
def keeps_shape(  # type: ignore[no-untyped-def]
    offsets, around, faces, node, rest, tensors, normals, aspects, i, j, v0, w0, w1, longest
):
    """Tell whether all new edges are short enough and all new triangles well shaped.

    Corners v0 of node i become w0, others w1.
    """
    worst, worst_before = 2.0, 2.0
    for r in range(offsets[i], offsets[i + 1]):
        t = around[r]
        if has_node(faces, node, t, j):
            continue
        corner = 0
        while node[faces[t, corner]] != i:
            corner += 1
        b, c = faces[t, (corner + 1) % 3], faces[t, (corner + 2) % 3]
        w = w0 if faces[t, corner] == v0 else w1
        for step in (1, 2):
            k = faces[t, (corner + step) % 3]
            if squared_length(rest, tensors, w, k) > longest * longest:
                return False
        if height(rest, normals, t, w, b, c) < LEAST_HEIGHT:
            return False
        worst = min(worst, aspect(rest, tensors, w, b, c))
    if worst > LEAST_ASPECT:
        return True
    for r in range(offsets[i], offsets[i + 1]):
        t = around[r]
        worst_before = min(worst_before, aspects[t])
    return worst >= worst_before


@helper
def keeps_surface(offsets, around, across, faces, node, stamps, stamp, i, j):  # type: ignore[no-untyped-def]
    """Tell whether the surface stays a surface: i and j share only the neighbours beside their edge.

    `stamps` (n,) is work space that does not hold `stamp` yet.
    """
    for r in range(offsets[j], offsets[j + 1]):
        for corner in range(3):
            stamps[node[faces[around[r], corner]]] = stamp
    for r in range(offsets[i], offsets[i + 1]):
        t = around[r]
        if has_node(faces, node, t, j):
            for corner in range(3):
                stamps[node[faces[t, corner]]] = -1
    for r in range(offsets[i], offsets[i + 1]):
        t = around[r]
        for corner in range(3):
            k = node[faces[t, corner]]
            # a neighbour of both beside no face of their edge; or the face would become one that j has
            if stamps[k] == stamp or (k == i and across[t, corner] == j):
                return False
    return True


@kernel(
    types.int64(
        I32_1, I32_1, I32_2, I32_2, I32_1, I32_1, I32_2, I32_2, I32_1, F64_2, F64_2, F64_2, F64_1,
        types.float64,
        OUT_BOOL_1, OUT_BOOL_1, OUT_I32_1, OUT_BOOL_1, OUT_BOOL_1,
    )
)  # fmt: skip
def choose_merges(  # type: ignore[no-untyped-def]
    removed, target, vertices, target_vertices, offsets, around, across, faces, node, rest, tensors, normals,
    aspects, longest, used, is_target, stamps, taken, blocked,
):  # fmt: skip
    """Mark in `taken` the merges (p,) that are possible beside all earlier ones; returns how many.

    In `blocked` those that touch one taken, and may be possible another time.

    `around[offsets[i] : offsets[i + 1]]` are the faces of node i, `across` (t, 3) is the far node across each
    side (-1: none), `aspects` (t,) are the shapes of the faces in the metric. New edges are at most `longest`
    in the metric. Work space: `used` (t,) and `is_target` (n,), all False, and `stamps` (n,), all -1.
    """
    count = 0
    for p in range(len(removed)):
        i, j = removed[p], target[p]
        v0, w0, w1 = vertices[p, 0], target_vertices[p, 0], target_vertices[p, 1]
        if v0 == vertices[p, 1] and w0 != w1:
            continue
        if is_blocked(offsets, around, faces, node, used, is_target, i, j):
            blocked[p] = True
            continue
        if not keeps_shape(
            offsets, around, faces, node, rest, tensors, normals, aspects, i, j, v0, w0, w1, longest
        ):  # fmt: skip
            continue
        if not keeps_surface(offsets, around, across, faces, node, stamps, p, i, j):
            continue
        taken[p] = True
        is_target[j] = True
        count += 1
        for r in range(offsets[i], offsets[i + 1]):
            used[around[r]] = True
    return count
