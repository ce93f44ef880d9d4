"""Longest-edge bisection (Rivara 1984): refines a surface and at least halves no angle more than once."""

import numpy as np
import numpy.typing as npt

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.errors import InputError

Int64 = npt.NDArray[np.int64]
MOST_FACES = 1_000_000
"""Triangles that a mesh may get: ten times those of a coat in edges of 5 mm."""


def subdivide(
    positions: Float, uv: Float, node: Int, faces: Int, *, longest: float
) -> tuple[Float, Float, Int, Int, Int, list[Int]]:
    """Split edges until none is longer than a given length; the surface itself does not change.

    Parameters
    ----------
    positions
        Nodes, shape (n, 3).
    uv
        Texture coordinates of material vertices, shape (m, 2).
    node
        Node of every material vertex, shape (m,).
    faces
        Triangles into material vertices, shape (t, 3).
    longest
        Longest edge allowed, in the unit of positions.

    Returns
    -------
    positions, uv, node, faces, parent, births
        The refined mesh, the original face of every face, and round by round, in the order of their numbers,
        the two material vertices between which each new one lies, shape (k, 2).

    Raises
    ------
    InputError
        If that would take more than MOST_FACES triangles.
    """
    parent = np.arange(len(faces), dtype=np.int32)
    births: list[Int] = []
    while True:
        corners = node[faces]
        ends = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1), axis=-1).astype(np.int64)
        keys, edge = np.unique(ends[..., 0] * len(positions) + ends[..., 1], return_inverse=True)
        edge = edge.reshape(-1, 3)
        start, end = keys // len(positions), keys % len(positions)
        lengths = np.linalg.norm(positions[end] - positions[start], axis=1)
        marked = lengths > longest
        if not marked.any():
            return positions, uv, node, faces, parent, births
        # Equal lengths are ranked by edge number, so that two faces agree on the longest.
        rank = np.empty(len(lengths), dtype=np.int64)
        rank[np.argsort(lengths, kind="stable")] = np.arange(len(lengths))
        largest = rank[edge].argmax(axis=1)
        _spread(marked, edge, edge[np.arange(len(edge)), largest])
        if len(faces) + np.count_nonzero(marked[edge]) > MOST_FACES:
            raise InputError(
                f"the mesh is {np.ptp(positions, axis=0).max():.3g} m large, too large for edges of "
                f"{longest:.3g} m; check its units"
            )
        middle = np.full(len(keys), -1, dtype=np.int64)
        middle[marked] = len(positions) + np.arange(np.count_nonzero(marked))
        positions = np.concatenate([positions, 0.5 * (positions[start[marked]] + positions[end[marked]])])
        rows = np.arange(len(faces))[:, None]
        turn = (np.arange(3)[None, :] + largest[:, None]) % 3
        faces, edge = faces[rows, turn], edge[rows, turn]
        uv, node, halves, parents = _material_middles(uv, node, faces, edge, marked, middle)
        births.append(parents)
        faces, parent = _split(faces, halves, parent)


def _spread(marked: Bool, edge: Int, longest_edge: Int) -> None:
    """Mark, in place, the longest edge of every face that has a marked edge, until nothing changes."""
    while True:
        needed = longest_edge[marked[edge].any(axis=1)]
        if marked[needed].all():
            return
        marked[needed] = True


def _material_middles(
    uv: Float, node: Int, faces: Int, edge: Int, marked: Bool, middle: Int64
) -> tuple[Float, Int, Int, Int]:
    """Return uv and node with midpoints added, each face's three midpoints (-1: none), and their parents."""
    halves = np.full(faces.shape, -1, dtype=np.int32)
    where = marked[edge]
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1)[where], axis=-1).astype(np.int64)
    keys, first, index = np.unique(
        ends[:, 0] * len(node) + ends[:, 1], return_index=True, return_inverse=True
    )
    halves[where] = len(node) + index.ravel()
    parents = np.column_stack([keys // len(node), keys % len(node)]).astype(np.int32)
    added = uv[parents].mean(axis=1)
    nodes = middle[edge[where]][first]
    return np.concatenate([uv, added]), np.concatenate([node, nodes]).astype(np.int32), halves, parents


def _split(faces: Int, halves: Int, parent: Int) -> tuple[Int, Int]:
    """Return the split faces and their parents; edge 0 of every face is its longest."""
    a, b, c = faces.T
    ab, bc, ca = halves.T
    whole = ab < 0
    left, right = (ab >= 0) & (ca >= 0), (ab >= 0) & (bc >= 0)
    pieces = [
        (whole, (a, b, c)),
        ((ab >= 0) & (ca < 0), (a, ab, c)),
        (left, (a, ab, ca)),
        (left, (ab, c, ca)),
        ((ab >= 0) & (bc < 0), (ab, b, c)),
        (right, (ab, b, bc)),
        (right, (ab, bc, c)),
    ]
    made = np.concatenate([np.column_stack(corners)[where] for where, corners in pieces])
    source = np.concatenate([np.flatnonzero(where) for where, _ in pieces])
    order = np.argsort(source, kind="stable")
    return np.ascontiguousarray(made[order], dtype=np.int32), parent[source[order]]
