"""Growth of a stepper's avatar to another shape."""

import numpy as np

from toile.collide.carry import carried_along
from toile.collide.guard import safe_factors
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Float

CARRIED = 2e-3
"""Cloth this close to an avatar vertex that it blocks is carried along [m]."""
FARTHEST_CARRIED = 5e-3
"""How far cloth is carried in one step at most [m]."""
BLOCKED = 0.5
"""Share of its motion below which a vertex counts as blocked."""


def grow_avatar(stepper: ClothStepper, target: Float, longest: float, carry: bool = False) -> float:
    """Move avatar vertices toward `target`, shape (v, 3), by at most `longest` [m] and as far as is safe.

    With `carry`, cloth that blocks the avatar moves along with it: tight cloth need not give way by itself.
    The contact radius against the avatar is growth_radius while it grows and radius_body once it has arrived.
    Returns the largest distance left [m].
    """
    collisions = stepper.collisions
    if collisions is None or collisions.avatar is None:
        return 0.0
    avatar, search = collisions.avatar, collisions.search
    wanted = target - avatar.vertices
    length = np.linalg.norm(wanted, axis=1)
    if length.max() == 0.0:
        collisions.set_body_radius(stepper.options.radius_body)
        return 0.0
    collisions.set_body_radius(stepper.options.growth_radius)
    share = np.minimum(1.0, longest / np.maximum(length, 1e-300))
    avatar.expect(length * share)
    count = len(stepper.x)
    search.search_body(stepper.x, np.zeros(count))
    move = np.zeros_like(search.positions)
    move[count:] = wanted * share[:, None]
    factor = safe_factors(search.positions, move, *search.body)
    if carry:
        blocked = factor < BLOCKED
        blocked[:count] = False
        carried = carried_along(search.positions, move, blocked, *search.body, count, CARRIED)
        size = np.linalg.norm(carried, axis=1)
        move[:count] = carried * np.minimum(1.0, FARTHEST_CARRIED / np.maximum(size, 1e-300))[:, None]
        search.search(stepper.x, np.minimum(size, FARTHEST_CARRIED))
        factor = safe_factors(search.positions, move, *search.pairs)
        stepper.put(stepper.x + move[:count] * factor[:count, None], stepper.v, stepper.memory)
    done = share * factor[count:]
    # Full moves land on the target itself, so that the avatar ends exactly in its true shape.
    collisions.put_avatar(np.where(done[:, None] == 1.0, target, avatar.vertices + wanted * done[:, None]))
    return float(np.linalg.norm(target - avatar.vertices, axis=1).max())
