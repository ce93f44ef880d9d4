"""Curvature at the scale of the mesh that it will ask for.

Second derivatives of a mesh are as sharp as the mesh: noise of the nodes grows with the inverse square of the
edge length, a crease gets sharper with every split. Averaged with their sign over the surroundings of a face
they are a property of the surface: noise cancels, and a crease counts with the angle by which it turns. The
radius is half the edge length that the average itself asks for, so that what needs fine edges stays sharp.
"""

import numpy as np

from toile.geometry.arrays import Float, Int
from toile.geometry.topology import triangle_topology
from toile.remesh.cloth_mesh import ClothMesh
from toile.remesh.packed_tensor import in_plane, lifted
from toile.remesh.plane_tensor import eigenvalues
from toile.remesh.sizing import SizingOptions

MAX_STEPS = 16
"""Averaging steps at most: a radius of about four faces, over which noise has cancelled long since."""
SQUARED_RADIUS_PER_STEP = 1.16
"""Growth of the squared radius of a disk as wide as the average, per step and face area: a step adds 3/4 of
the squared distance of neighbouring centroids (equilateral triangles) to the squared width."""


def smoothed_curvature(mesh: ClothMesh, curvature: Float, options: SizingOptions) -> Float:
    """Average signed curvature tensors S [1/m] over radii of half the edge length they ask for.

    `curvature` is in the face's own warp and weft directions, shape (t, 2, 2), as the result. Averages cross
    no seam and no border of a region.
    """
    area = np.abs(mesh.rest_area)
    weight, neighbour = _neighbour_weights(mesh, area)
    tensors = lifted(mesh.frames, curvature)
    going_on = np.arange(len(area))
    for step in range(1, MAX_STEPS + 1):
        average = weight[going_on, 3, None] * tensors[going_on]
        for side in range(3):
            average += weight[going_on, side, None] * tensors[neighbour[going_on, side]]
        low, high = eigenvalues(in_plane(mesh.frames[going_on], average))
        sharpest = np.maximum(np.maximum(np.abs(low), np.abs(high)), 1e-300)
        size = np.clip(options.refine_angle / sharpest, options.size_min, options.size_max)
        wide = step * SQUARED_RADIUS_PER_STEP * area[going_on] <= 0.25 * size * size
        going_on = going_on[wide]
        tensors[going_on] = average[wide]
    return in_plane(mesh.frames, tensors)


def _neighbour_weights(mesh: ClothMesh, area: Float) -> tuple[Float, Int]:
    """Weights of a face's neighbours and of itself (t, 4), by area; neighbours (t, 3), itself where none."""
    neighbour = triangle_topology(mesh.faces).neighbours
    own = np.arange(len(mesh.faces), dtype=np.int32)[:, None]
    real = (neighbour >= 0) & (mesh.region[neighbour] == mesh.region[:, None])
    neighbour = np.where(real, neighbour, own).astype(np.int32)
    weight = np.concatenate([np.where(real, area[neighbour], 0.0), area[:, None]], axis=1)
    return weight / weight.sum(axis=1, keepdims=True), neighbour
