"""Second derivatives of a function given at the nodes of a triangle mesh, constant per face.

Morley's plate triangle has a value at each corner and a slope across each side; its second derivatives follow
from the divergence theorem, A x_,ij = sum over sides of l g_i n_j, with g the gradient at the middle of the
side. It is exact on quadratics and, because both faces of a side use one slope, a constant moment is in
equilibrium at every inner node of any mesh: the two conditions for convergence. Here the slope is not an
unknown: it is the derivative at the middle of the side of the values at the nodes around it, with weights
that make it exact on quadratics (`slope_stencil`). So the derivatives at a face depend on its own nodes and
those of the two rings of faces around.

Sources: Morley 1968 (the triangle); Onate and Zarate 2000 (rotation-free triangles: slopes averaged from the
neighbours' planes, which is not exact on irregular meshes).
"""

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.slope_stencil import MAX_NODES, slope_stencils
from toile.geometry.topology import Topology


class Patches(NamedTuple):
    """Linear maps from node values to slopes and second derivatives.

    Attributes
    ----------
    areas
        Rest area of every face [m^2], shape (t,).
    sides
        The (face, side) that owns each slope: it points out of that face, shape (h, 2).
    side_slopes
        Slope index of every side, shape (t, 3).
    side_signs
        +1 where that slope points out of the face, -1 where into it, shape (t, 3).
    slopes
        Node values to slopes [1/m], sparse (h, n).
    corner_part
        Node values to the part of (uu, vv, uv) derivatives that corner values give [1/m^2], sparse (3 t, n).
    slope_part
        Slopes to the rest of it [1/m], sparse (3 t, h).
    """

    areas: Float
    sides: Int
    side_slopes: Int
    side_signs: Float
    slopes: sp.csr_array
    corner_part: sp.csr_array
    slope_part: sp.csr_array

    @property
    def second_derivatives(self) -> sp.csr_array:
        """Node values to (uu, vv, uv) second derivatives of each face [1/m^2], sparse (3 t, n)."""
        return sp.csr_array(self.corner_part + self.slope_part @ self.slopes)


def bending_patches(
    faces: Int, rest_corners: Float, topology: Topology, node_count: int, rigid: Bool | None = None
) -> Patches:
    """Return the maps for faces (t, 3) of nodes with rest corners (t, 3, 2) [m] in each face's own frame.

    Neighbours are unfolded across shared sides, so every face may have a frame of its own; where the two rest
    sides differ in length (a gathered seam) their middles and directions are aligned. Sides where more than
    two faces meet are treated as borders. At a border the slope is extrapolated from the nodes inside, again
    exact on quadratics.

    A `rigid` face (t,), one whose nodes are all held, prescribes the slopes at its sides: those of its own
    plane. So the line where a clamp ends is exactly the last held side. A face without area has no
    derivatives.
    """
    face_count = len(faces)
    neighbours, neighbour_sides = topology.neighbours, topology.neighbour_sides
    face_index = np.repeat(np.arange(face_count), 3).reshape(-1, 3)
    owner = (neighbours < 0) | (neighbours > face_index)
    sides = np.ascontiguousarray(np.argwhere(owner), dtype=np.int32)
    slope_count = len(sides)
    side_slopes = np.empty((face_count, 3), dtype=np.int32)
    side_slopes[owner] = np.arange(slope_count, dtype=np.int32)
    borrowed = ~owner
    side_slopes[borrowed] = side_slopes[neighbours[borrowed], neighbour_sides[borrowed]]
    side_signs = np.where(owner, 1.0, -1.0)

    counts = np.empty(slope_count, dtype=np.int32)
    nodes = np.empty((slope_count, MAX_NODES), dtype=np.int32)
    weights = np.empty((slope_count, MAX_NODES))
    held = np.zeros(face_count, dtype=bool) if rigid is None else rigid
    slope_stencils(faces, rest_corners, neighbours, neighbour_sides, held, sides, counts, nodes, weights)
    used = np.arange(MAX_NODES) < counts[:, None]
    used[used] = np.abs(weights[used]) > 1e-10 * np.repeat(np.abs(weights[:, :3]).max(axis=1), counts)
    offsets = np.concatenate(([0], np.cumsum(used.sum(axis=1)))).astype(np.int32)
    slopes = sp.csr_array((weights[used], nodes[used], offsets), shape=(slope_count, node_count))

    start, end = [1, 2, 0], [2, 0, 1]
    edge = rest_corners[:, end] - rest_corners[:, start]
    length = np.maximum(np.linalg.norm(edge, axis=2), 1e-300)
    twice_area = edge[:, 0, 0] * edge[:, 1, 1] - edge[:, 0, 1] * edge[:, 1, 0]
    area = 0.5 * np.abs(twice_area)
    t_u, t_v = edge[..., 0] / length, edge[..., 1] / length
    turn = np.sign(twice_area)[:, None]
    n_u, n_v = turn * t_v, -turn * t_u
    across = np.stack((n_u * n_u, n_v * n_v, n_u * n_v), axis=1)
    along = np.stack((t_u * n_u, t_v * n_v, 0.5 * (t_u * n_v + t_v * n_u)), axis=1)
    solid = area > 1e-9 * length.max(axis=1) ** 2
    per_area = np.divide(1.0, area, out=np.zeros(face_count), where=solid)
    slope_values = across * (side_signs * length * per_area[:, None])[:, None, :]
    # the difference of the end values of side k, spread on the corners: corner k+2 gets +, corner k+1 gets -
    corner_values = (along[:, :, [1, 2, 0]] - along[:, :, [2, 0, 1]]) * per_area[:, None, None]
    rows = np.arange(0, 9 * face_count + 1, 3, dtype=np.int32)
    slope_part = _three_per_row(slope_values, side_slopes, rows, slope_count)
    corner_part = _three_per_row(corner_values, faces, rows, node_count)
    return Patches(area, sides, side_slopes, side_signs, slopes, corner_part, slope_part)


def _three_per_row(values: Float, columns: Int, rows: Int, width: int) -> sp.csr_array:
    """Sparse (3 t, width) whose rows 3 t .. 3 t + 2 have `values[t]` at `columns[t]`."""
    repeated = np.repeat(columns, 3, axis=0).ravel()
    return sp.csr_array((values.ravel(), repeated, rows), shape=(len(rows) - 1, width))
