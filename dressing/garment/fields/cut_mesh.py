"""Cuts the triangles of a flat panel along a line, so that no face lies on both of its sides."""

from collections.abc import Callable

import numpy as np

from toile.geometry.arrays import Bool, Float, Int

Level = Callable[[Float], Float]
"""Distance-like function of points [m], (n, 2) to (n,): negative on one side of a line, 0 on it."""
ON_LINE = 1e-9
"""A point lies on the line where the function is that close to 0."""
NEAR = 0.3
"""A vertex so near to where the line crosses an edge, as a share of the edge, moves there."""
LEFT = 0.2
"""Share of its area that every face around it must keep."""
HALVINGS = 60


def cut_along(points: Float, faces: Int, fixed: Bool, level: Level) -> tuple[Float, Int]:
    """Return vertices and faces of a panel that is cut along a line.

    Parameters
    ----------
    points
        Vertices [m], shape (n, 2); the first of the result, except that some have moved onto the line.
    faces
        Triangles, counter-clockwise, shape (t, 3).
    fixed
        Vertices that may not move, shape (n,). Border edges are left as they are: the line crosses the border
        in vertices only.
    level
        The line is where it is 0.
    """
    points, values = points.copy(), _rounded(level(points))
    _move_onto(points, faces, fixed | (values == 0.0), values, level)
    values = _rounded(level(points))
    inner = _inner_edges(faces)
    crossed = inner[values[inner[:, 0]] * values[inner[:, 1]] < 0.0]
    middle = _crossing(points[crossed[:, 0]], points[crossed[:, 1]], level)
    new = {(int(a), int(b)): len(points) + k for k, (a, b) in enumerate(crossed)}
    points = np.concatenate([points, middle])
    pieces: list[tuple[int, int, int]] = []
    for face in faces.tolist():
        pieces += _split(face, new, points)
    return points, np.array(pieces, np.int32)


def _rounded(values: Float) -> Float:
    return np.where(np.abs(values) < ON_LINE, 0.0, values)


def _inner_edges(faces: Int) -> Int:
    """Edges of two faces, lower vertex first, shape (e, 2)."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges, count = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    return np.asarray(edges[count == 2], np.int32)


def _crossing(start: Float, end: Float, level: Level) -> Float:
    """Where edges meet the line [m], shape (k, 2): the function has different signs at their ends."""
    low, high = np.zeros(len(start)), np.ones(len(start))
    sign = np.sign(level(start))
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        same = np.sign(level(start + middle[:, None] * (end - start))) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return np.asarray(start + (0.5 * (low + high))[:, None] * (end - start))


def _move_onto(points: Float, faces: Int, fixed: Bool, values: Float, level: Level) -> None:
    """Move vertices that lie near the line onto it, the nearest first, unless faces shrink too much."""
    edges = _inner_edges(faces)
    edges = edges[values[edges[:, 0]] * values[edges[:, 1]] < 0.0]
    if not len(edges):
        return
    places = _crossing(points[edges[:, 0]], points[edges[:, 1]], level)
    ends = np.concatenate([edges, edges[:, ::-1]])
    places = np.concatenate([places, places])
    length = np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1)
    share = np.linalg.norm(places - points[ends[:, 0]], axis=1) / length
    around: dict[int, list[int]] = {}
    for number, face in enumerate(faces.tolist()):
        for vertex in face:
            around.setdefault(vertex, []).append(number)
    moved: set[int] = set()
    for row in np.argsort(share, kind="stable").tolist():
        vertex = int(ends[row, 0])
        if share[row] > NEAR or fixed[vertex] or vertex in moved:
            continue
        own = faces[around[vertex]]
        before, old = _areas(points, own), points[vertex].copy()
        points[vertex] = places[row]
        if (_areas(points, own) < LEFT * before).any():
            points[vertex] = old
        else:
            moved.add(vertex)


def _areas(points: Float, faces: Int) -> Float:
    a, b, c = (points[faces[:, k]] for k in range(3))
    return np.asarray((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def _split(face: list[int], new: dict[tuple[int, int], int], points: Float) -> list[tuple[int, int, int]]:
    """Return the pieces of a face, some of whose sides have a new vertex on them: one or two have."""
    middles = [new.get((min(p, q), max(p, q))) for p, q in zip(face, face[1:] + face[:1], strict=True)]
    count = sum(middle is not None for middle in middles)
    if not count:
        return [(face[0], face[1], face[2])]
    # Turned so that side 0 has one and, of two, the other is side 2: the corner between them is the first.
    turn = next(
        k for k in range(3) if middles[k] is not None and (count == 1 or middles[(k + 2) % 3] is not None)
    )
    a, b, c = face[turn:] + face[:turn]
    m, n = middles[turn], middles[(turn + 2) % 3]
    assert m is not None
    if n is None:
        return [(a, m, c), (m, b, c)]
    if np.linalg.norm(points[m] - points[c]) < np.linalg.norm(points[b] - points[n]):
        return [(a, m, n), (m, b, c), (m, c, n)]
    return [(a, m, n), (m, b, n), (b, c, n)]
