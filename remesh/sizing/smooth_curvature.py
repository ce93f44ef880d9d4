"""Curvature, averaged at the scale of the mesh that it will ask for.

Second derivatives of a mesh are as sharp as the mesh: noise of the nodes grows with the inverse square of the
edge length, a crease gets sharper with every split. Averaged with their sign over the surroundings of a face
they are a property of the surface: noise cancels, and a crease counts with the angle by which it turns. The
radius is half the edge length that the average itself asks for, so that what needs fine edges stays sharp.
"""

import math

import numpy as np
from numba import types

from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_1, F64_2, F64_3, I32_2, OUT_F64_2, OUT_I32_1, helper, kernel
from toile.geometry.topology import triangle_topology
from toile.remesh.mesh.cloth_mesh import ClothMesh
from toile.remesh.sizing.packed_tensor import in_plane, lifted
from toile.remesh.sizing.sizing import SizingOptions

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
    _smooth(
        mesh.frames, weight, neighbour, area, options.refine_angle, options.size_min, options.size_max,
        np.arange(len(area), dtype=np.int32), np.empty_like(tensors), tensors,
    )  # fmt: skip
    return in_plane(mesh.frames, tensors)


@helper
def _along(tensors, t, ax, ay, az, bx, by, bz):  # type: ignore[no-untyped-def]
    """Inner product of two vectors in a packed tensor."""
    straight = tensors[t, 0] * ax * bx + tensors[t, 1] * ay * by + tensors[t, 2] * az * bz
    mixed = tensors[t, 3] * (ay * bz + az * by) + tensors[t, 4] * (az * bx + ax * bz)
    return straight + (mixed + tensors[t, 5] * (ax * by + ay * bx))


@kernel(
    types.void(
        F64_3,
        F64_2,
        I32_2,
        F64_1,
        types.float64,
        types.float64,
        types.float64,
        OUT_I32_1,
        OUT_F64_2,
        OUT_F64_2,
    )
)
def _smooth(  # type: ignore[no-untyped-def]
    frames, weight, neighbour, area, refine_angle, size_min, size_max, going_on, average, tensors
):
    """Average packed `tensors` (t, 6) in place; work space: `going_on` (t,), all faces, and `average`."""
    count = len(going_on)
    for step in range(1, MAX_STEPS + 1):
        for row in range(count):
            t = going_on[row]
            for entry in range(6):
                total = weight[t, 3] * tensors[t, entry]
                for side in range(3):
                    total += weight[t, side] * tensors[neighbour[t, side], entry]
                average[t, entry] = total
        left = 0
        for row in range(count):
            t = going_on[row]
            px, py, pz = frames[t, 0, 0], frames[t, 1, 0], frames[t, 2, 0]
            fx, fy, fz = frames[t, 0, 1], frames[t, 1, 1], frames[t, 2, 1]
            uu = _along(average, t, px, py, pz, px, py, pz)
            vv = _along(average, t, fx, fy, fz, fx, fy, fz)
            uv = _along(average, t, px, py, pz, fx, fy, fz)
            mean, half = 0.5 * (uu + vv), 0.5 * (uu - vv)
            length = math.sqrt(half * half + uv * uv)
            sharpest = max(abs(mean - length), abs(mean + length), 1e-300)
            size = min(max(refine_angle / sharpest, size_min), size_max)
            if step * SQUARED_RADIUS_PER_STEP * area[t] <= 0.25 * size * size:
                for entry in range(6):
                    tensors[t, entry] = average[t, entry]
                going_on[left] = t
                left += 1
        count = left


def _neighbour_weights(mesh: ClothMesh, area: Float) -> tuple[Float, Int]:
    """Weights of a face's neighbours and of itself (t, 4), by area; neighbours (t, 3), itself where none."""
    neighbour = triangle_topology(mesh.faces).neighbours
    own = np.arange(len(mesh.faces), dtype=np.int32)[:, None]
    real = (neighbour >= 0) & (mesh.region[neighbour] == mesh.region[:, None])
    neighbour = np.where(real, neighbour, own).astype(np.int32)
    weight = np.concatenate([np.where(real, area[neighbour], 0.0), area[:, None]], axis=1)
    return weight / weight.sum(axis=1, keepdims=True), neighbour
