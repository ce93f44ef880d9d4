"""Connectivity repair: shared edges and consistent winding."""

import numpy as np

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import connected

WELD_TOLERANCE = 1e-6
"""Open borders whose vertices are nearer than this [m] are the same border: float32 rounding at 2 m."""


def _edge_table(faces: Int) -> tuple[Int, Int, Int, Int]:
    """Half-edges grouped by undirected edge.

    Half-edge 3 f + k runs from corner k to corner k + 1 of face f. Returns the half-edges sorted by edge,
    the start of every edge in that order, the number of half-edges per edge, and whether (1) or not (0)
    each sorted half-edge runs from the smaller to the larger vertex.
    """
    start, end = faces.ravel().astype(np.int64), faces[:, [1, 2, 0]].ravel().astype(np.int64)
    key = np.minimum(start, end) * (int(faces.max()) + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    _, first, count = np.unique(key[order], return_index=True, return_counts=True)
    forward = (start < end)[order]
    return order.astype(np.int32), first.astype(np.int32), count.astype(np.int32), forward.astype(np.int32)


def _open_vertices(faces: Int, vertex_count: int) -> Bool:
    """Mark vertices on edges that belong to one face only."""
    order, first, count, _ = _edge_table(faces)
    lone = order[first[count == 1]]
    is_open = np.zeros(vertex_count, dtype=np.bool_)
    is_open[faces.ravel()[lone]] = True
    is_open[faces[:, [1, 2, 0]].ravel()[lone]] = True
    return is_open


def weld_open_edges(vertices: Float, faces: Int) -> tuple[Float, Int, int]:
    """Merge vertices at the same place on open edges; returns vertices, faces and how many were merged.

    Only borders are welded: lips that touch in a closed mesh stay two lips. Exact duplicates first (texture
    seams, STL corners), then borders that still gape, within rounding of single precision.
    """
    merged = 0
    for tolerance in (0.0, WELD_TOLERANCE):
        candidates = np.flatnonzero(_open_vertices(faces, len(vertices)))
        if not len(candidates):
            break
        points = vertices[candidates]
        # + 0.0 makes -0.0 and 0.0 the same bytes.
        keys = points + 0.0 if tolerance == 0.0 else np.round(points / tolerance)
        _, representative, group = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        target = np.arange(len(vertices), dtype=np.int32)
        target[candidates] = candidates[representative[group.ravel()]]
        merged += int(np.count_nonzero(target != np.arange(len(vertices))))
        faces = np.ascontiguousarray(target[faces])
    if merged:
        used, local = np.unique(faces, return_inverse=True)
        vertices = np.ascontiguousarray(vertices[used])
        faces = np.ascontiguousarray(local.reshape(-1, 3), dtype=np.int32)
    return vertices, faces, merged


def _paired_half_edges(vertices: Float, faces: Int) -> tuple[Int, Int]:
    """Half-edges that belong together: two per manifold edge, solids kept apart where several touch."""
    order, first, count, forward = _edge_table(faces)
    two = first[count == 2]
    left, right = [order[two]], [order[two + 1]]
    for begin, size in zip(first[count > 2], count[count > 2], strict=True):
        around = order[begin : begin + size]
        pairs = _pairs_around_edge(vertices, faces, around, forward[begin : begin + size].astype(np.bool_))
        left.append(pairs[:, 0])
        right.append(pairs[:, 1])
    return np.concatenate(left), np.concatenate(right)


def _pairs_around_edge(vertices: Float, faces: Int, half_edges: Int, forward: Bool) -> Int:
    """Pair the half-edges around one edge, shape (p, 2), so that each pair encloses solid, not air.

    A face whose half-edge runs along the edge has the inside of its solid on the side of decreasing angle
    (right-hand rule about the edge), so it belongs to the next face below that runs the other way.
    """
    flat = faces.ravel()
    lower = int(min(flat[half_edges[0]], faces[:, [1, 2, 0]].ravel()[half_edges[0]]))
    upper = int(max(flat[half_edges[0]], faces[:, [1, 2, 0]].ravel()[half_edges[0]]))
    axis = vertices[upper] - vertices[lower]
    axis /= max(float(np.linalg.norm(axis)), 1e-300)
    apex = vertices[faces[:, [2, 0, 1]].ravel()[half_edges]] - vertices[lower]
    across = apex - np.outer(apex @ axis, axis)
    reference = across[0] / max(float(np.linalg.norm(across[0])), 1e-300)
    angle = np.arctan2(across @ np.cross(axis, reference), across @ reference)
    ranked = np.argsort(angle, kind="stable")
    way = forward[ranked]
    pairs = [
        (half_edges[ranked[k]], half_edges[ranked[k - 1]])
        for k in range(len(ranked))
        if way[k] and not way[k - 1]
    ]
    return np.array(pairs, dtype=np.int32).reshape(-1, 2)


def join_corners(vertices: Float, faces: Int) -> tuple[Float, Int, int]:
    """Give every fan of faces that are joined by edges its own vertex.

    Surfaces that touch only in a vertex, or along an edge of more than two faces, come apart there.
    Returns vertices, faces and how many vertices were added.
    """
    left, right = _paired_half_edges(vertices, faces)
    nxt = np.arange(faces.size, dtype=np.int64)
    nxt = np.where(nxt % 3 == 2, nxt - 2, nxt + 1)
    flat = faces.ravel()
    same_start = flat[left] == flat[right]
    # A half-edge's corners are its start and its end; opposite half-edges meet crosswise.
    first = np.concatenate([left, nxt[left]])
    second = np.concatenate(
        [np.where(same_start, right, nxt[right]), np.where(same_start, nxt[right], right)]
    )
    corner_class = connected(np.column_stack([first, second]), faces.size)
    count = int(corner_class.max(initial=-1)) + 1
    if count == len(np.unique(faces)):
        return vertices, faces, 0
    source = np.zeros(count, dtype=np.int64)
    source[corner_class] = flat
    added = count - len(np.unique(faces))
    # Number fans by source vertex, so that an untouched mesh keeps its vertex order.
    rank = np.argsort(source, kind="stable")
    position = np.empty(count, dtype=np.int32)
    position[rank] = np.arange(count, dtype=np.int32)
    return (
        np.ascontiguousarray(vertices[source[rank]]),
        np.ascontiguousarray(position[corner_class].reshape(-1, 3)),
        added,
    )


def orient_faces(faces: Int) -> tuple[Int, Int, int, int]:
    """Make windings consistent within every connected part, by the majority of its faces.

    Returns faces, the part of every face, how many faces were turned, and the first one-sided part (-1 if
    there is none). Every face is two nodes of a graph, as given and turned; an edge that both faces run
    along in the same direction joins "given" to "turned". A part is two-sided if the graph falls in two.
    """
    order, first, count, forward = _edge_table(faces)
    two = first[count == 2]
    a, b = order[two] // 3, order[two + 1] // 3
    same = (forward[two] == forward[two + 1]).astype(np.int32)
    face_count = len(faces)
    part = connected(np.column_stack([a, b]), face_count)
    part_count = int(part.max(initial=-1)) + 1
    rows = np.concatenate([2 * a, 2 * a + 1])
    columns = np.concatenate([2 * b + same, 2 * b + 1 - same])
    sheet = connected(np.column_stack([rows, columns]), 2 * face_count)
    given, turned = sheet[0::2], sheet[1::2]
    one_sided = np.flatnonzero(given == turned)
    # The sheet with the smaller label is the reference; whether it is the majority decides who turns.
    reference = given < turned
    agreeing = np.bincount(part, reference, minlength=part_count)
    total = np.bincount(part, minlength=part_count)
    keep = reference == (2 * agreeing >= total)[part]
    result = faces.copy()
    result[~keep] = result[~keep][:, ::-1]
    bad_part = int(part[one_sided[0]]) if len(one_sided) else -1
    return result, part.astype(np.int32), int(np.count_nonzero(~keep)), bad_part
