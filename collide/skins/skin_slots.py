"""Slots for cloth between skins of an avatar that meet, in the armpit for example.

Cloth between two skins that touch or overlap has no feasible place. Baraff, Witkin and Kass (2003) stick it
to both ("flypapering"); here the flesh gives way instead: both skins retreat until a slot is left. Which skin
meets which is read off segments through every vertex near cloth, along its normal.
"""

import numpy as np
from scipy.sparse import coo_array, csr_array

from toile.collide.skins.segment_hits import SegmentHits
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.normals import vertex_normals
from toile.geometry.topology import triangle_topology

SLOT = 0.020
"""Room that is left between two skins in motion [m]."""
DEEPEST = 0.06
"""Overlap up to which two skins are told apart [m]."""
NEIGHBOURHOOD = 0.02
"""Skin this far along the surface is the same skin [m]."""
FACING = -0.5
"""Cosine between the normals of two skins that face each other, at most."""
FAR = 3.0
"""Length of the segments that count how often a point is inside [m]: longer than any body is thick."""
OUTWARD = 1e-4
SMOOTHINGS = 6


class SkinSlots:
    """Holds the skins of one avatar apart, in any pose."""

    def __init__(self, vertices: Float, faces: Int) -> None:
        self.faces = faces
        self._body = SegmentHits(vertices, faces)
        self._count = count = len(vertices)
        edges = triangle_topology(faces).edges
        ones = np.ones(len(edges))
        near = coo_array((ones, (edges[:, 0], edges[:, 1])), shape=(count, count)).tocsr()
        near = ((near + near.T) > 0).astype(np.float64)
        self._mean: csr_array = csr_array(near.multiply(1.0 / np.maximum(near.sum(axis=1), 1.0)[:, None]))
        mean_edge = float(np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1).mean())
        rings = near.copy()
        for _ in range(int(np.ceil(NEIGHBOURHOOD / mean_edge)) - 1):
            rings = ((rings @ near + rings) > 0).astype(np.float64)
        row, column = rings.nonzero()
        # Pairs of vertices of the same skin, as one sorted number each.
        self._same = np.sort(row.astype(np.int64) * count + column)

    def retreat(self, vertices: Float, near: Bool, slot: float = SLOT) -> Float:
        """Retreat of every vertex against its normal [m], shape (v, 3).

        Parameters
        ----------
        vertices
            The pose [m], shape (v, 3).
        near
            Vertices that cloth may come to, shape (v,): others need no slot.
        slot
            Room between two skins [m].
        """
        chosen = np.flatnonzero(near)
        if not len(chosen):
            return np.zeros_like(vertices)
        normals = vertex_normals(vertices, self.faces)
        body = self._body
        body.pose(vertices)
        start, direction = vertices[chosen], normals[chosen]
        row, face = body.hits(start - DEEPEST * direction, start + slot * direction).T
        face_normals = self._face_normals(vertices, face)
        facing = np.einsum("ki,ki->k", direction[row], face_normals)
        other = facing < FACING
        other[other] = ~self._same_skin(chosen[row[other]], face[other])
        row, face, facing, face_normals = row[other], face[other], facing[other], face_normals[other]
        height = np.einsum("ki,ki->k", vertices[self.faces[face, 0]] - start[row], face_normals)
        gap = height / facing
        # An opposite skin behind a vertex is the other side of its own limb unless it is inside another one.
        behind = np.unique(row[gap < 0.0])
        inside = np.zeros(len(chosen), bool)
        if len(behind):
            outside = start[behind] + OUTWARD * direction[behind]
            inside[behind] = self._winding(vertices, outside, direction[behind]) > 0
        met = (gap >= 0.0) | inside[row]
        wanted = np.zeros(len(vertices))
        np.maximum.at(wanted, chosen[row[met]], 0.5 * (slot - gap[met]))
        for _ in range(SMOOTHINGS):
            wanted = np.maximum(wanted, self._mean @ wanted)
        return np.asarray(-wanted[:, None] * normals)

    def held_apart(self, vertices: Float, near: Bool) -> Float:
        """Return the pose with its skins apart [m], shape (v, 3)."""
        return vertices + self.retreat(vertices, near)

    def _same_skin(self, vertex: Int, face: Int) -> Bool:
        """Whether faces, shape (k,), lie in the neighbourhood of vertices, shape (k,)."""
        same = np.zeros(len(vertex), bool)
        for corner in range(3):
            pair = vertex.astype(np.int64) * self._count + self.faces[face, corner]
            place = np.minimum(np.searchsorted(self._same, pair), len(self._same) - 1)
            same |= self._same[place] == pair
        return same

    def _face_normals(self, vertices: Float, face: Int) -> Float:
        """Return unit normals of some faces, shape (k,), in a pose [m], shape (k, 3)."""
        a, b, c = (vertices[self.faces[face, corner]] for corner in range(3))
        normals = np.cross(b - a, c - a)
        return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None])

    def _winding(self, vertices: Float, points: Float, direction: Float) -> Int:
        """How often the body surrounds points, shape (n, 3): skins left less skins entered on the way out."""
        row, face = self._body.hits(points, points + FAR * direction).T
        leaves = np.sign(np.einsum("ki,ki->k", direction[row], self._face_normals(vertices, face)))
        return np.asarray(np.rint(np.bincount(row, weights=leaves, minlength=len(points))), np.int32)
