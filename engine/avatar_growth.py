"""The avatar of a stepper on its way to another shape."""

import numpy as np

from toile.collide.guard import safe_factors
from toile.engine.step import ClothStepper
from toile.geometry.arrays import Float


def grow_avatar(stepper: ClothStepper, target: Float, longest: float) -> float:
    """Move avatar vertices toward `target`, shape (v, 3), by at most `longest` [m] and as far as is safe.

    The contact radius against the avatar is growth_radius while it grows and radius_body once it has arrived.
    Returns the largest distance left [m].
    """
    avatar, search = stepper.avatar, stepper.search
    if avatar is None or search is None:
        return 0.0
    wanted = target - avatar.vertices
    length = np.linalg.norm(wanted, axis=1)
    if length.max() == 0.0:
        stepper.set_body_radius(stepper.options.radius_body)
        return 0.0
    stepper.set_body_radius(stepper.options.growth_radius)
    share = np.minimum(1.0, longest / np.maximum(length, 1e-300))
    avatar.motion = length * share
    search.search(stepper.x, np.zeros(len(stepper.x)), body_only=True)
    move = np.zeros_like(search.positions)
    move[len(stepper.x) :] = wanted * share[:, None]
    factor = safe_factors(search.positions, move, *search.body)[len(stepper.x) :]
    done = share * factor
    # Full moves land on the target itself, so that the avatar ends exactly in its true shape.
    put_avatar(stepper, np.where(done[:, None] == 1.0, target, avatar.vertices + wanted * done[:, None]))
    return float(np.linalg.norm(target - avatar.vertices, axis=1).max())


def put_avatar(stepper: ClothStepper, vertices: Float) -> None:
    """Put the avatar's vertices somewhere [m], shape (v, 3), whatever cloth is there."""
    assert stepper.avatar is not None and stepper.search is not None
    stepper.avatar.move_to(np.ascontiguousarray(vertices))
    stepper.avatar.motion = np.zeros(len(vertices))
    stepper.anchor[len(stepper.x) :] = vertices
    stepper.search.expire()
