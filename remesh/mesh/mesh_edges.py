"""Edges between nodes, with their one or two sides in the panels."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import types

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import (
    F64_2,
    I32_1,
    I32_2,
    OUT_BOOL_1,
    OUT_I8_1,
    OUT_I32_1,
    OUT_I32_2,
    helper,
    kernel,
)

INNER, SEAM, BORDER, TANGLED = 0, 1, 2, 3
"""Two faces of one panel; two faces of different panels; one face; more faces, or only one node."""

FLATNESS = 1e-7
"""Two faces are one plane in rest space if the far corner is at most so high above it, per its distance."""


@dataclass
class MeshEdges:
    """Edges of a mesh. Flips keep them up to date in place; splits and collapses build them anew.

    Attributes
    ----------
    nodes
        Both ends, lower node first, shape (e, 2).
    kind
        INNER, SEAM, BORDER or TANGLED, shape (e,).
    faces
        The one or two faces, -1 where there is none, shape (e, 2); of a tangled edge the first one only.
    sides
        Which side of each face it is (side k lies opposite to corner k), shape (e, 2).
    face_edges
        Edge of every side, shape (t, 3).
    creased
        True for inner edges whose faces do not lie in one plane of rest space, shape (e,).
    frozen
        True for edges that must stay as they are, shape (e,).
    keys
        Sorted keys of all node pairs that are edges, or were before a flip since the edges were built.
    """

    nodes: Int
    kind: npt.NDArray[np.int8]
    faces: Int
    sides: Int
    face_edges: Int
    creased: Bool
    frozen: Bool
    keys: npt.NDArray[np.int64]

    def add_keys(self, keys: npt.NDArray[np.int64]) -> None:
        """Note node pairs that have become edges, shape (k,)."""
        keys = np.sort(keys)
        self.keys = np.insert(self.keys, np.searchsorted(self.keys, keys), keys)


def pair_keys(a: Int, b: Int) -> npt.NDArray[np.int64]:
    """Return one number per unordered pair; sorted numbers are sorted pairs, lower entry first."""
    low, high = np.minimum(a, b).astype(np.int64), np.maximum(a, b).astype(np.int64)
    return np.asarray(low << 32 | high)


def in_sorted(values: npt.NDArray[np.int64], ordered: npt.NDArray[np.int64]) -> Bool:
    """Tell which values occur in a sorted array."""
    if not len(ordered):
        return np.zeros(len(values), bool)
    place = np.minimum(np.searchsorted(ordered, values), len(ordered) - 1)
    return np.asarray(ordered[place] == values)


def corner_after(faces: Int, face: Int, corner: Int, steps: int) -> Int:
    """Return the entry of `faces` some corners after `corner`, shape (k,)."""
    flat = 3 * face.astype(np.intp) + (corner + steps) % 3
    return np.asarray(faces.ravel().take(flat))


def build_edges(
    faces: Int,
    node: Int,
    region: Int,
    rest: Float,
    normals: Float,
    frozen_keys: npt.NDArray[np.int64],
) -> MeshEdges:
    """Build the edges of faces (t, 3) of material vertices that belong to nodes `node`, shape (m,).

    `normals` are the unit normals of the faces in rest space, shape (t, 3).
    """
    most = 3 * len(faces)
    nodes, at_faces, sides = np.empty((3, most, 2), np.int32)
    face_edges, kind, creased = (
        np.empty((len(faces), 3), np.int32),
        np.empty(most, np.int8),
        np.empty(most, bool),
    )
    highest = int(node.max(initial=-1)) + 1
    count = _link_sides(
        faces, node, region, rest, normals, np.zeros(highest + 1, np.int32), np.empty((most, 2), np.int32),
        nodes, kind, at_faces, sides, face_edges, creased,
    )  # fmt: skip
    nodes = nodes[:count].copy()
    keys = pair_keys(nodes[:, 0], nodes[:, 1])
    return MeshEdges(
        nodes=nodes,
        kind=kind[:count].copy(),
        faces=at_faces[:count].copy(),
        sides=sides[:count].copy(),
        face_edges=face_edges,
        creased=creased[:count].copy(),
        frozen=in_sorted(keys, frozen_keys),
        keys=keys,
    )


@helper
def _is_creased(faces, rest, normals, t, k, u, j):  # type: ignore[no-untyped-def]
    """Tell whether face u, across side k of face t and side j of its own, lies in another plane."""
    b, far = faces[t, (k + 1) % 3], faces[u, j]
    x, y, z = rest[far, 0] - rest[b, 0], rest[far, 1] - rest[b, 1], rest[far, 2] - rest[b, 2]
    height = abs(x * normals[t, 0] + y * normals[t, 1] + z * normals[t, 2])
    along = normals[t, 0] * normals[u, 0] + normals[t, 1] * normals[u, 1] + normals[t, 2] * normals[u, 2]
    return along <= 0.0 or height > FLATNESS * math.sqrt(x * x + y * y + z * z)


@kernel(
    types.int64(
        I32_2, I32_1, I32_1, F64_2, F64_2, OUT_I32_1, OUT_I32_2, OUT_I32_2, OUT_I8_1, OUT_I32_2, OUT_I32_2,
        OUT_I32_2, OUT_BOOL_1,
    )
)  # fmt: skip
def _link_sides(  # type: ignore[no-untyped-def]
    faces, node, region, rest, normals, place, entries, nodes, kind, at_faces, sides, face_edges, creased
):
    """Fill the arrays of `MeshEdges`, edges by lower, then by higher node; returns how many there are.

    Work space: `place` (n + 1,), all 0, and `entries` (3 t, 2).
    """
    # The sides by their lower node, in order of their faces: (higher node, side).
    for t in range(len(faces)):
        for k in range(3):
            p, q = node[faces[t, (k + 1) % 3]], node[faces[t, (k + 2) % 3]]
            place[min(p, q) + 1] += 1
    for i in range(1, len(place)):
        place[i] += place[i - 1]
    for t in range(len(faces)):
        for k in range(3):
            p, q = node[faces[t, (k + 1) % 3]], node[faces[t, (k + 2) % 3]]
            low = min(p, q)
            entries[place[low], 0] = max(p, q)
            entries[place[low], 1] = 3 * t + k
            place[low] += 1
    count = 0
    begin = 0
    for low in range(len(place) - 1):
        end = place[low]
        for row in range(begin + 1, end):
            high, side = entries[row, 0], entries[row, 1]
            before = row
            while before > begin and entries[before - 1, 0] > high:
                entries[before, 0], entries[before, 1] = entries[before - 1, 0], entries[before - 1, 1]
                before -= 1
            entries[before, 0], entries[before, 1] = high, side
        row = begin
        while row < end:
            high = entries[row, 0]
            after = row
            while after < end and entries[after, 0] == high:
                face_edges[entries[after, 1] // 3, entries[after, 1] % 3] = count
                after += 1
            t, k = entries[row, 1] // 3, entries[row, 1] % 3
            nodes[count, 0], nodes[count, 1] = low, high
            at_faces[count, 0], sides[count, 0] = t, k
            at_faces[count, 1], sides[count, 1] = -1, 0
            creased[count] = False
            kind[count] = BORDER
            if after - row > 2 or low == high:
                kind[count] = TANGLED
            elif after - row == 2:
                u, j = entries[row + 1, 1] // 3, entries[row + 1, 1] % 3
                if u == t:
                    kind[count] = TANGLED
                else:
                    at_faces[count, 1], sides[count, 1] = u, j
                    same = faces[u, (j + 2) % 3] == faces[t, (k + 1) % 3]
                    same = same and faces[u, (j + 1) % 3] == faces[t, (k + 2) % 3]
                    if same and region[t] == region[u]:
                        kind[count] = INNER
                        creased[count] = _is_creased(faces, rest, normals, t, k, u, j)
                    else:
                        kind[count] = SEAM
            count += 1
            row = after
        begin = end
    return count
