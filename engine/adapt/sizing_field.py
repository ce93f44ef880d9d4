"""How fine a cloth wants its mesh to be, read off its present state."""

from functools import reduce

import numpy as np

from toile.collide.near_surface import heights_above
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Float
from toile.remesh.mesh.cloth_mesh import ClothMesh
from toile.remesh.sizing.plane_tensor import smallest_dominating
from toile.remesh.sizing.sizing import (
    SizingOptions,
    clamped,
    compression_metric,
    curvature_metric,
    obstacle_metric,
    velocity_metric,
)
from toile.remesh.sizing.smooth_curvature import smoothed_curvature


def face_metrics(mesh: ClothMesh, stepper: ClothStepper, options: SizingOptions) -> Float:
    """Return the metric [1/m^2] that every face wants, in its warp and weft directions, shape (t, 2, 2).

    The smallest that dominates those of curvature, compression, motion where there is any, and of an avatar
    where it is near.
    """
    x = stepper.x
    deformation = stepper.membrane.gradient(x)
    metrics = []
    curvature = np.zeros((len(mesh.faces), 2, 2))
    if stepper.bending is not None:
        bent = stepper.bending.curvature(x)
        curvature[:, 0, 0], curvature[:, 1, 1] = bent[:, 0], bent[:, 1]
        curvature[:, 0, 1] = curvature[:, 1, 0] = bent[:, 2]
        curvature = smoothed_curvature(mesh, curvature, options)
        metrics.append(curvature_metric(curvature, options.refine_angle))
    metrics.append(compression_metric(deformation, curvature, options.refine_compression))
    if stepper.v.any():
        metrics.append(
            velocity_metric(deformation, stepper.membrane.gradient(stepper.v), options.refine_velocity)
        )
    if stepper.avatar is not None:
        metrics.append(_near_avatar(stepper))
    return clamped(reduce(smallest_dominating, metrics), options)


NEAR = 5.0
"""Cloth within this many contact radii of the avatar follows it closely."""


def _near_avatar(stepper: ClothStepper) -> Float:
    """Metric of faces near the avatar, by how their height above it changes; zero elsewhere."""
    assert stepper.avatar is not None
    radius = float(stepper.radius_body.max())
    height = heights_above(stepper.avatar, stepper.x, NEAR * radius)
    near = np.asarray(np.isfinite(height)[stepper.faces].all(axis=1))
    height = np.maximum(np.where(np.isfinite(height), height, 0.0), radius)
    slope = stepper.membrane.gradient(height[:, None])[:, 0]
    metric = obstacle_metric(slope, height[stepper.faces].mean(axis=1))
    return np.where(near[:, None, None], metric, 0.0)
