"""Forces on vertices as a pressure: spread over a length, none of them lost."""

import numpy as np
from scipy.sparse import coo_array, csc_array, diags_array
from scipy.sparse.linalg import splu

from toile.geometry.arrays import Float, Int
from toile.geometry.normals import area_normals

SPREAD = 0.01
"""Length over which forces are spread [m]: about an edge of cloth or body."""


def vertex_areas(positions: Float, faces: Int) -> Float:
    """Return a third of the area of the faces around every vertex [m^2], shape (n,)."""
    area = 0.5 * np.linalg.norm(area_normals(positions[faces]), axis=1)
    return np.asarray(np.bincount(faces.ravel(), np.repeat(area / 3.0, 3), len(positions)), dtype=np.float64)


def spread_pressure(force: Float, positions: Float, faces: Int, length: float = SPREAD) -> Float:
    """Return the pressure [Pa], shape (n,), of forces on vertices [N], shape (n,), spread over `length` [m].

    Contacts act where vertices of one mesh meet faces of the other: single vertices say little. The pressure
    p solves A p - length^2 lap p = force with free borders, so its integral is the sum of the forces; it is
    nowhere negative, since weights of obtuse corners are left out.
    """
    count = len(positions)
    corners = positions[faces]
    rows, columns, weights = [], [], []
    for k in range(3):
        here, there = faces[:, (k + 1) % 3], faces[:, (k + 2) % 3]
        u, v = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        across = np.linalg.norm(np.cross(u, v), axis=1)
        weight = 0.5 * np.maximum((u * v).sum(axis=1), 0.0) / np.maximum(across, 1e-300)
        rows += [here, there]
        columns += [there, here]
        weights += [weight, weight]
    link = coo_array(
        (np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))), (count, count)
    )
    area = np.maximum(vertex_areas(positions, faces), 1e-12)
    matrix = diags_array(area + length**2 * np.asarray(link.sum(axis=1))) - length**2 * link
    # Symmetric, with a dominant diagonal: the order that fills least, and no pivots.
    factor = splu(
        csc_array(matrix), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    return np.asarray(np.maximum(factor.solve(np.ascontiguousarray(force)), 0.0))
