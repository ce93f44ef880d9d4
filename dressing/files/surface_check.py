"""Check that a surface can be simulated; errors name the faces at fault."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from toile.dressing.files.corner_surface import Surface
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

SMALLEST_AREA = 1e-11
"""Faces below this area [m^2] count as degenerate: (3 micrometres)^2 is no cloth."""
SMALLEST_HEIGHT = 1e-5
"""Smallest height of a triangle over its longest edge, relative to that edge: thinner is degenerate."""


def check_vertex_numbers(path: Path, faces: npt.NDArray[np.integer], count: int, remedy: str) -> None:
    """Raise InputError with the first face that refers to none of `count` vertices, and what to do."""
    outside = np.flatnonzero(((faces < 0) | (faces >= count)).any(axis=1))
    if len(outside):
        raise InputError(
            f"{path}: face {outside[0]} refers to a vertex that does not exist; {remedy}", outside, file=path
        )


def checked_surface(path: Path, surface: Surface) -> Surface:
    """Return the surface [m] welded, consistently oriented and without unused nodes.

    Raises InputError naming degenerate faces, edges with more than two faces, and one-sided surfaces.
    """
    positions, faces = _welded(surface.positions, surface.faces)
    _refuse_degenerate(path, positions, faces, surface.file_face)
    flipped = _faces_to_flip(path, faces, surface.file_face)
    faces, uv_faces = faces.copy(), surface.uv_faces.copy()
    faces[flipped], uv_faces[flipped] = faces[flipped][:, ::-1], uv_faces[flipped][:, ::-1]
    used, index = np.unique(faces, return_inverse=True)
    return replace(
        surface,
        positions=np.ascontiguousarray(positions[used]),
        faces=np.ascontiguousarray(index.reshape(-1, 3), dtype=np.int32),
        uv_faces=np.ascontiguousarray(uv_faces),
    )


def _welded(positions: Float, faces: Int) -> tuple[Float, Int]:
    """Merge border vertices at the same place: exporters split a vertex for each texture coordinate.

    Vertices inside a layer are left alone, so that two layers that touch do not grow together.
    """
    start, end = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel().astype(np.int64)
    keys, counts = np.unique(
        np.minimum(start, end) * len(positions) + np.maximum(start, end), return_counts=True
    )
    lone = keys[counts == 1]
    border = np.unique(np.concatenate([lone // len(positions), lone % len(positions)]))
    target = np.arange(len(positions), dtype=np.int32)
    if len(border):
        _, first, index = np.unique(positions[border], axis=0, return_index=True, return_inverse=True)
        target[border] = border[first][index.ravel()]
    return positions, target[faces]


def _refuse_degenerate(path: Path, positions: Float, faces: Int, file_face: Int) -> None:
    """Raise InputError naming faces that repeat a vertex or have no area."""
    corners = positions[faces]
    doubled = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    bad = np.flatnonzero((doubled < 2.0 * SMALLEST_AREA) | (doubled < SMALLEST_HEIGHT * longest**2))
    if len(bad):
        raise InputError(
            f"{path}: {_named(file_face[bad])} no area; delete or merge them", file_face[bad], file=path
        )


def _faces_to_flip(path: Path, faces: Int, file_face: Int) -> Int:
    """Return the faces to turn over so that neighbours agree; in each piece the majority stays as it is.

    Raises InputError for edges with more than two faces, and for surfaces with one side (Moebius).
    """
    count = int(faces.max()) + 1
    start, end = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel().astype(np.int64)
    key = np.minimum(start, end) * count + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    key, owner, upward = key[order], order // 3, (start < end)[order]
    crowded = np.flatnonzero(key[2:] == key[:-2])
    if len(crowded):
        bad = np.unique(owner[np.concatenate([crowded, crowded + 1, crowded + 2])])
        raise InputError(
            f"{path}: {_named(file_face[bad])} an edge with more than two faces; separate them",
            file_face[bad],
            file=path,
        )
    pair = np.flatnonzero(key[1:] == key[:-1])
    a, b, same = owner[pair], owner[pair + 1], upward[pair] == upward[pair + 1]
    if not same.any():
        return np.empty(0, dtype=np.int32)
    rows, columns = np.concatenate([a, b]), np.concatenate([b, a])
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(faces), len(faces))).tocsr()
    pieces, label = connected_components(graph, directed=False)
    disagrees = {(int(i), int(j)): bool(s) for i, j, s in zip(a, b, same, strict=True)}
    turned = np.zeros(len(faces), dtype=np.bool_)
    for piece in range(pieces):
        root = int(np.flatnonzero(label == piece)[0])
        visited, before = breadth_first_order(graph, root, directed=False)
        for face in visited[1:].tolist():
            parent = int(before[face])
            differ = disagrees[(parent, face) if (parent, face) in disagrees else (face, parent)]
            turned[face] = turned[parent] ^ differ
        if 2 * np.count_nonzero(turned[visited]) > len(visited):
            turned[visited] ^= True
    wrong = np.flatnonzero((turned[a] ^ turned[b]) != same)
    if len(wrong):
        bad = np.unique(np.concatenate([a[wrong], b[wrong]]))
        raise InputError(
            f"{path}: {_named(file_face[bad])} no consistent right side (a Moebius strip)",
            file_face[bad],
            file=path,
        )
    return np.flatnonzero(turned).astype(np.int32)


def _named(faces: Int) -> str:
    """Return "face 3 has" or "7 faces (3, 5, 9, ...) have", numbered from 0."""
    numbers = sorted({int(face) for face in faces})
    if len(numbers) == 1:
        return f"face {numbers[0]} has"
    listed = ", ".join(str(number) for number in numbers[:5]) + (", ..." if len(numbers) > 5 else "")
    return f"{len(numbers)} faces ({listed}) have"
