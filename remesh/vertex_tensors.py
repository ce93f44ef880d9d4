"""From metrics of faces to metrics of material vertices."""

import numpy as np

from toile.geometry.arrays import Float
from toile.remesh.cloth_mesh import ClothMesh
from toile.remesh.packed_tensor import unpacked


def vertex_tensors(mesh: ClothMesh, metrics: Float) -> Float:
    """Average face metrics (t, 2, 2) [1/m^2] by area; per material vertex, in rest space, shape (m, 3, 3).

    Each face has its own directions, so tensors are lifted to rest space first. Vertices without faces get 0.
    """
    area = np.abs(mesh.rest_area)
    warp, weft = mesh.frames.transpose(2, 0, 1)
    xx, yy, xy = metrics[:, 0, 0], metrics[:, 1, 1], metrics[:, 0, 1]
    count = len(mesh.rest)
    total = np.zeros((count, 6))
    share = np.bincount(mesh.faces.ravel(), weights=np.repeat(area, 3), minlength=count)
    for entry, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))):
        mixed = warp[:, i] * weft[:, j] + weft[:, i] * warp[:, j]
        value = xx * warp[:, i] * warp[:, j] + yy * weft[:, i] * weft[:, j] + xy * mixed
        total[:, entry] = np.bincount(mesh.faces.ravel(), weights=np.repeat(area * value, 3), minlength=count)
    return unpacked(total / np.maximum(share, 1e-300)[:, None])
