"""The way of a body from one pose to another that has the same faces: as rigid as it can be.

Each face turns from pose to pose by the rotation nearest to its deformation, and is stretched by what
is left. Both are taken in shares, and vertices follow the faces by least squares, weighted by area (Poisson's
equation of deformation gradients: Sumner and Popovic 2004, Xu et al. 2005).
"""

from typing import cast

import numpy as np
from scipy.sparse import coo_array, csc_array, identity
from scipy.sparse.csgraph import breadth_first_order
from scipy.sparse.linalg import splu
from scipy.spatial.transform import Rotation

from toile.geometry.arrays import Float, Int
from toile.geometry.connected import connected, connected_vertices
from toile.geometry.topology import triangle_topology

HELD = 1e-9
"""Weight, over that of its faces, by which each part of the body is held in its place."""


def way_to_pose(start: Float, end: Float, faces: Int, shares: Float) -> Float:
    """Return a body on its way from a pose to another.

    Parameters
    ----------
    start, end
        Vertices in both poses, shape (v, 3).
    faces
        Shape (f, 3).
    shares
        Of the way: 0 is the start, 1 the end, shape (k,).

    Returns
    -------
    ndarray
        Vertices, shape (k, v, 3). The middle of each connected part goes straight.
    """
    frame, other = _frames(start, faces), _frames(end, faces)
    deformation = other @ np.linalg.inv(frame)
    u, _, vt = np.linalg.svd(deformation)
    u[:, :, 2] *= np.linalg.det(u @ vt)[:, None]
    rotation = u @ vt
    stretch = rotation.transpose(0, 2, 1) @ deformation
    turn = _along_neighbours(Rotation.from_matrix(rotation).as_rotvec(), faces)
    solve = _Poisson(start, faces)
    found = np.empty((len(shares), *start.shape))
    for k, share in enumerate(shares):
        here = Rotation.from_rotvec(share * turn).as_matrix() @ ((1.0 - share) * np.eye(3) + share * stretch)
        found[k] = solve.vertices(here, (1.0 - share) * start + share * end)
    return found


def _frames(vertices: Float, faces: Int) -> Float:
    """Return two sides of each face and its normal, as columns, shape (f, 3, 3)."""
    corners = vertices[faces]
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(one, other)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    # As long as the sides are, so that the frame can be inverted whatever the unit; any axis for no area.
    normal = np.where(length > 0.0, normal, [0.0, 0.0, 1.0]) / np.sqrt(np.maximum(length, 1e-300))
    return np.stack([one, other, normal], axis=2)


def _along_neighbours(turn: Float, faces: Int) -> Float:
    """Return turns, shape (f, 3), in which neighbours turn the same way round even beyond half a turn.

    A rotation is one by its angle, by a turn more and by a turn less. From the face of each part that turns
    least outwards, each face takes the one nearest to its neighbour's.
    """
    pairs = triangle_topology(faces).neighbour_pairs
    graph = csc_array(coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(faces), len(faces))))
    turn = turn.copy()
    angle = np.linalg.norm(turn, axis=1)
    part = connected(pairs, len(faces))
    count = int(part.max()) + 1
    first = np.lexsort((angle, part))
    seeds = first[np.searchsorted(part[first], np.arange(count))]
    for seed in seeds:
        order, before = breadth_first_order(graph, seed, directed=False)
        for face in order[1:]:
            own, near = turn[face], turn[before[face]]
            size = np.sqrt(own @ own)
            if size < 1e-9:
                continue
            turns = np.rint((own @ near / size - size) / (2.0 * np.pi))
            if turns:
                turn[face] = own * (1.0 + 2.0 * np.pi * turns / size)
    return turn


class _Poisson:
    """Vertices from deformations of faces, by one factor for all."""

    def __init__(self, start: Float, faces: Int) -> None:
        count, corners = len(start), start[faces]
        sides = np.stack(
            [corners[:, 2] - corners[:, 1], corners[:, 0] - corners[:, 2], corners[:, 1] - corners[:, 0]]
        )
        area = 0.5 * np.linalg.norm(np.cross(sides[2], -sides[1]), axis=1)
        self._start, self._faces = start, faces
        # Weights of a face's sides: half the cotangents of the angles across.
        self._weights = np.stack(
            [-(sides[(k + 1) % 3] * sides[(k + 2) % 3]).sum(axis=1) for k in range(3)]
        ) / (4.0 * np.maximum(area, 1e-9 * area.max()))
        ends = [(faces[:, (k + 1) % 3], faces[:, (k + 2) % 3]) for k in range(3)]
        rows = np.concatenate([np.concatenate([a, b, a, b]) for a, b in ends])
        columns = np.concatenate([np.concatenate([b, a, a, b]) for a, b in ends])
        values = np.concatenate([np.concatenate([-w, -w, w, w]) for w in self._weights])
        laplacian = csc_array(coo_array((values, (rows, columns)), shape=(count, count)))
        self._part = connected_vertices(faces, count)
        self._size = np.bincount(self._part)
        self._held = HELD * float(np.abs(laplacian.diagonal()).max())
        self._factor = splu(csc_array(laplacian + self._held * identity(count)))

    def vertices(self, deformation: Float, near: Float) -> Float:
        """Return vertices whose faces are deformed so, each part's middle where that of `near` is."""
        load = self._held * near
        for k, weight in enumerate(self._weights):
            a, b = self._faces[:, (k + 1) % 3], self._faces[:, (k + 2) % 3]
            side = weight[:, None] * np.einsum("fij,fj->fi", deformation, self._start[b] - self._start[a])
            np.add.at(load, b, side)
            np.add.at(load, a, -side)
        found = cast(Float, self._factor.solve(load))
        off = np.stack([np.bincount(self._part, (near - found)[:, axis]) for axis in range(3)], axis=1)
        return np.asarray(found + (off / self._size[:, None])[self._part])
