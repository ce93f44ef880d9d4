"""Metrics of material vertices from metrics of faces."""

import numpy as np

from toile.geometry.arrays import Float
from toile.remesh.mesh.cloth_mesh import ClothMesh
from toile.remesh.sizing.packed_tensor import lifted, unpacked


def vertex_tensors(mesh: ClothMesh, metrics: Float) -> Float:
    """Average face metrics (t, 2, 2) [1/m^2] by area; per material vertex, in rest space, shape (m, 3, 3).

    Each face has its own directions, so tensors are lifted to rest space first. Vertices without faces get 0.
    """
    area = np.abs(mesh.rest_area)
    weighted = lifted(mesh.frames, metrics) * area[:, None]
    corners, count = mesh.faces.ravel(), len(mesh.rest)
    share = np.bincount(corners, weights=np.repeat(area, 3), minlength=count)
    sums = [np.bincount(corners, weights=np.repeat(entry, 3), minlength=count) for entry in weighted.T]
    return unpacked(np.stack(sums, axis=1) / np.maximum(share, 1e-300)[:, None])
