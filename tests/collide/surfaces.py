"""Small random surfaces for the tests of contact search, guard and audit."""

import numpy as np

from toile.geometry.arrays import Float, Int


def sheet(count: int, edge: float) -> tuple[Float, Int]:
    """Flat square grid of count x count vertices in the plane y = 0 [m]."""
    i, j = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
    points = np.column_stack([i.ravel() * edge, np.zeros(count * count), j.ravel() * edge])
    a = (i[:-1, :-1] * count + j[:-1, :-1]).ravel()
    faces = np.concatenate(
        [np.column_stack([a, a + 1, a + count]), np.column_stack([a + 1, a + count + 1, a + count])]
    )
    return points, faces.astype(np.int32)


def crumpled(generator: np.random.Generator, count: int, edge: float, roughness: float) -> tuple[Float, Int]:
    """Randomly turned sheet whose vertices are displaced by `roughness` edges."""
    points, faces = sheet(count, edge)
    points = points - points.mean(axis=0) + roughness * edge * generator.normal(size=points.shape)
    turn = np.linalg.qr(generator.normal(size=(3, 3)))[0]
    return np.ascontiguousarray(points @ turn.T), faces


def stacked(parts: list[tuple[Float, Int]]) -> tuple[Float, Int]:
    """Several surfaces as one: positions one after the other, faces renumbered."""
    starts = np.cumsum([0] + [len(points) for points, _ in parts])
    positions = np.concatenate([points for points, _ in parts])
    faces = np.concatenate([f + start for (_, f), start in zip(parts, starts, strict=False)])
    return np.ascontiguousarray(positions), np.ascontiguousarray(faces, np.int32)


def vertices(count: int) -> Int:
    """Indices of all vertices, shape (count,)."""
    return np.arange(count, dtype=np.int32)


def edges_of(faces: Int) -> Int:
    """Every edge once, smaller vertex first, shape (e, 2)."""
    both = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    return np.unique(np.sort(both, axis=1), axis=0).astype(np.int32)


def all_vertex_faces(vertices: Int, faces: Int) -> Int:
    """Every (vertex, face) combination without a common vertex, shape (n, 4)."""
    rows = np.concatenate(
        [np.repeat(vertices, len(faces))[:, None], np.tile(faces, (len(vertices), 1))], axis=1
    )
    return np.ascontiguousarray(rows[(rows[:, :1] != rows[:, 1:]).all(axis=1)], np.int32)


def all_edge_edges(edges: Int) -> Int:
    """Every pair of edges without a common vertex, shape (n, 4)."""
    i, j = np.triu_indices(len(edges), 1)
    rows = np.concatenate([edges[i], edges[j]], axis=1)
    apart = (rows[:, [0]] != rows[:, 2:]).all(axis=1) & (rows[:, [1]] != rows[:, 2:]).all(axis=1)
    return np.ascontiguousarray(rows[apart], np.int32)
