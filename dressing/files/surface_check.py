"""Check that a surface can be simulated; errors name the faces at fault."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from toile.dressing.files.corner_surface import Surface
from toile.dressing.files.surface_mend import exactly_welded, named, without_area
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.errors import InputError


def check_vertex_numbers(path: Path, faces: npt.NDArray[np.integer], count: int, remedy: str) -> None:
    """Raise InputError with the first face that refers to none of `count` vertices, and what to do."""
    outside = np.flatnonzero(((faces < 0) | (faces >= count)).any(axis=1))
    if len(outside):
        raise InputError(
            f"{path}: face {outside[0]} refers to a vertex that does not exist; {remedy}", outside, file=path
        )


def checked_surface(path: Path, surface: Surface) -> Surface:
    """Return the surface [m] welded, consistently oriented and without unused nodes.

    Where more than two faces meet at an edge, a piece is sewn on (a belt loop, a pocket): they stay joined,
    and which way the piece faces is its own matter. Raises InputError naming degenerate faces and one-sided
    surfaces.
    """
    positions, faces = surface.positions, exactly_welded(surface.positions, surface.faces)
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


def _refuse_degenerate(path: Path, positions: Float, faces: Int, file_face: Int) -> None:
    """Raise InputError naming faces that repeat a vertex or have no area."""
    bad = np.flatnonzero(without_area(positions, faces))
    if len(bad):
        raise InputError(
            f"{path}: {named(file_face[bad], 'has', 'have')} no area; delete or merge them",
            file_face[bad],
            file=path,
        )


def _faces_to_flip(path: Path, faces: Int, file_face: Int) -> Int:
    """Return the faces to turn over so that neighbours agree; in each piece the majority stays as it is.

    Faces at an edge of more than two are no neighbours. Raises InputError for surfaces with one side
    (Moebius).
    """
    key, owner, upward = _sides(faces)
    pair = np.flatnonzero(key[1:] == key[:-1])
    crowded = np.isin(key[pair], key[2:][key[2:] == key[:-2]])
    pair = pair[~crowded]
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
            f"{path}: {named(file_face[bad], 'has', 'have')} no consistent right side (a Moebius strip)",
            file_face[bad],
            file=path,
        )
    return np.flatnonzero(turned).astype(np.int32)


def crowded_faces(faces: Int) -> Int:
    """Return the faces at edges of more than two faces, sorted."""
    key, owner, _ = _sides(faces)
    first = np.flatnonzero(key[2:] == key[:-2])
    return np.asarray(np.unique(owner[np.concatenate([first, first + 1, first + 2])]), np.int32)


def _sides(faces: Int) -> tuple[npt.NDArray[np.int64], Int, Bool]:
    """Sides of all faces in the order of their edges: key of the edge, face, whether it runs upwards."""
    count = int(faces.max()) + 1
    start, end = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel().astype(np.int64)
    key = np.minimum(start, end) * count + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    return key[order], np.asarray(order // 3, np.int32), np.asarray((start < end)[order])
