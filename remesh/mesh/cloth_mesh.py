"""The mesh that remeshing changes: nodes that move, material vertices that lie in panels."""

from dataclasses import dataclass

import numpy as np

from toile.geometry.arrays import Bool, Float, Int


@dataclass(frozen=True, kw_only=True)
class ClothMesh:
    """Nodes, material vertices, faces and what must stay of them.

    A flat panel's rest positions are (u, v, 0); a garment with a curved rest shape has the shape itself.

    Attributes
    ----------
    rest
        Rest position of every material vertex [m], shape (m, 3).
    node
        Node of every material vertex, shape (m,).
    faces
        Material vertices of every face, counter-clockwise about its frame's normal, shape (t, 3).
    frames
        Warp and weft direction of every face in rest space, orthonormal columns in the face's plane,
        shape (t, 3, 2).
    region
        Panel or fabric of every face, shape (t,): faces of different regions are never mixed.
    positions
        Position of every node [m], shape (n, 3).
    kept
        Nodes that are never removed, shape (n,).
    pinned
        Nodes that never move, shape (n,): removed only from straight rows of pinned nodes.
    frozen_edges
        Node pairs whose edges are neither split, flipped nor collapsed, shape (k, 2).
    """

    rest: Float
    node: Int
    faces: Int
    frames: Float
    region: Int
    positions: Float
    kept: Bool
    pinned: Bool
    frozen_edges: Int

    @property
    def face_nodes(self) -> Int:
        """Nodes of every face, shape (t, 3)."""
        return np.ascontiguousarray(self.node[self.faces])

    @property
    def rest_corners(self) -> Float:
        """Corners of every face from its first one, (warp, weft) [m], shape (t, 3, 2)."""
        sides = self.rest[self.faces] - self.rest[self.faces[:, :1]]
        return np.asarray(np.einsum("tci,tij->tcj", sides, self.frames))

    @property
    def rest_area(self) -> Float:
        """Rest area of every face [m^2], shape (t,); negative where a face is inverted."""
        corners = self.rest_corners
        u, v = corners[:, 1], corners[:, 2]
        return np.asarray(0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]))
