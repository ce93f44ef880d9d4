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
    lifted = _lifted(mesh, curvature)
    for step in range(1, MAX_STEPS + 1):
        low, high = eigenvalues(_in_face(mesh, lifted))
        sharpest = np.maximum(np.abs(low), np.abs(high))
        size = np.clip(
            options.refine_angle / np.maximum(sharpest, 1e-300), options.size_min, options.size_max
        )
        wide = np.flatnonzero(step * SQUARED_RADIUS_PER_STEP * area <= 0.25 * size * size)
        if not len(wide):
            break
        around = weight[wide, 3, None] * lifted[wide]
        for side in range(3):
            around += weight[wide, side, None] * lifted[neighbour[wide, side]]
        lifted[wide] = around
    return _in_face(mesh, lifted)


def _neighbour_weights(mesh: ClothMesh, area: Float) -> tuple[Float, Int]:
    """Weights of a face's neighbours and of itself (t, 4), by area; neighbours (t, 3), itself where none."""
    neighbour = triangle_topology(mesh.faces).neighbours
    own = np.arange(len(mesh.faces), dtype=np.int32)[:, None]
    real = (neighbour >= 0) & (mesh.region[neighbour] == mesh.region[:, None])
    neighbour = np.where(real, neighbour, own).astype(np.int32)
    weight = np.concatenate([np.where(real, area[neighbour], 0.0), area[:, None]], axis=1)
    return weight / weight.sum(axis=1, keepdims=True), neighbour


def _lifted(mesh: ClothMesh, tensors: Float) -> Float:
    """Tensors in rest space, shape (t, 9)."""
    return np.asarray(np.einsum("tij,tjk,tlk->til", mesh.frames, tensors, mesh.frames).reshape(-1, 9))


def _in_face(mesh: ClothMesh, lifted: Float) -> Float:
    """Tensors in the faces' own directions, shape (t, 2, 2)."""
    return np.asarray(np.einsum("tji,tjk,tkl->til", mesh.frames, lifted.reshape(-1, 3, 3), mesh.frames))
