"""Conservation of linear and angular momentum when velocities move to another mesh."""

from typing import NamedTuple

import numpy as np

from toile.geometry.arrays import Bool, Float, Int
from toile.remesh.sizing.row_products import row_cross


class Motion(NamedTuple):
    """Nodes in motion.

    Attributes
    ----------
    positions
        [m], shape (n, 3).
    velocities
        [m/s], shape (n, 3).
    mass
        [kg], shape (n,).
    component
        Number of the connected piece that each node belongs to, shape (n,).
    """

    positions: Float
    velocities: Float
    mass: Float
    component: Int


def with_momentum_of(before: Motion, after: Motion) -> Float:
    """Return the velocities of `after` [m/s], shape (n, 3), with each component's momentum as `before`.

    Adds to each component the one rigid motion that restores linear and angular momentum; of all corrections
    it is the smallest, weighted by mass. A piece without extent across some axis takes no spin about it.
    """
    velocities = after.velocities.copy()
    for component in np.unique(after.component):
        old, new = before.component == component, after.component == component
        mass, offset = after.mass[new], after.positions[new]
        centre = np.einsum("n,ni->i", mass, offset) / mass.sum()
        offset = offset - centre
        linear, angular = _momentum(before, old, centre)
        linear_now, angular_now = _momentum(after, new, centre)
        squared = np.einsum("ni,ni,n->", offset, offset, mass)
        inertia = squared * np.eye(3) - np.einsum("ni,nj,n->ij", offset, offset, mass)
        spin = np.linalg.pinv(inertia, rcond=1e-12, hermitian=True) @ (angular - angular_now)
        shift = (linear - linear_now) / mass.sum()
        velocities[new] += shift + np.cross(spin, offset)
    return velocities


def _momentum(motion: Motion, nodes: Bool, centre: Float) -> tuple[Float, Float]:
    """Linear [kg m/s] and angular momentum [kg m^2/s] of some nodes about a point, shapes (3,)."""
    momentum = motion.mass[nodes, None] * motion.velocities[nodes]
    return momentum.sum(axis=0), row_cross(motion.positions[nodes] - centre, momentum).sum(axis=0)
