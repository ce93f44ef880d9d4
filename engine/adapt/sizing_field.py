"""The sizing field of a cloth in its present state."""

from functools import reduce

import numpy as np

from toile.collide.avatar_surface import AvatarSurface
from toile.collide.near_surface import heights_above
from toile.engine.forces.bend import Bending
from toile.engine.forces.membrane import Membrane
from toile.engine.step.collisions import Collisions
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


def face_metrics(
    mesh: ClothMesh, stepper: ClothStepper, options: SizingOptions, scale: Float | None = None
) -> Float:
    """Return the metric [1/m^2] that every face wants, in its warp and weft directions, shape (t, 2, 2).

    The smallest that dominates those of curvature, compression, motion where there is any, and of an avatar
    where it is near. `scale` is that of the rest shape on every face, shape (t, 2), or None.
    """
    x, membrane, bending = stepper.x, stepper.force(Membrane), stepper.force(Bending)
    assert membrane is not None
    deformation = membrane.gradient(x)
    metrics, natural = [], []
    curvature = np.zeros((len(mesh.faces), 2, 2))
    if bending is not None:
        bent = bending.curvature(x)
        curvature[:, 0, 0], curvature[:, 1, 1] = bent[:, 0], bent[:, 1]
        curvature[:, 0, 1] = curvature[:, 1, 0] = bent[:, 2]
        curvature = smoothed_curvature(mesh, curvature, options)
        metrics.append(curvature_metric(curvature, options.refine_angle))
    natural.append(compression_metric(deformation, curvature, options.refine_compression))
    if stepper.v.any():
        natural.append(velocity_metric(deformation, membrane.gradient(stepper.v), options.refine_velocity))
    if stepper.collisions is not None and stepper.collisions.avatar is not None:
        natural.append(_near_avatar(stepper.collisions, stepper.collisions.avatar, membrane, x))
    if scale is not None:
        # The mesh is measured as it was cut, the membrane as it is without force.
        natural = [metric * scale[:, :, None] * scale[:, None] for metric in natural]
    return clamped(reduce(smallest_dominating, [*metrics, *natural]), options)


NEAR = 5.0
"""Cloth within this many contact radii of the avatar follows it closely."""


def _near_avatar(collisions: Collisions, avatar: AvatarSurface, membrane: Membrane, x: Float) -> Float:
    """Metric of faces near the avatar, by how their height above it changes; zero elsewhere."""
    faces = membrane.faces
    radius = float(collisions.radius_body.max())
    height = heights_above(avatar, x, NEAR * radius)
    near = np.asarray(np.isfinite(height)[faces].all(axis=1))
    height = np.maximum(np.where(np.isfinite(height), height, 0.0), radius)
    slope = membrane.gradient(height[:, None])[:, 0]
    metric = obstacle_metric(slope, height[faces].mean(axis=1))
    return np.where(near[:, None, None], metric, 0.0)
