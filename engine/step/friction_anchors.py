"""Anchors of friction: where a node would be without the elastic slip of the contacts that hold it."""

import numpy as np

from toile.engine.forces.contact import Contacts
from toile.geometry.arrays import Float


def slid_anchors(
    x: Float, anchors: Float, contacts: Contacts, slip: float, avatar_motion: Float | None
) -> Float:
    """Return anchors that followed a step [m], shape (n, 3): free nodes take them along, others drag them.

    Parameters
    ----------
    x, anchors
        Nodes after the step and their anchors before it [m], shape (n, 3).
    contacts
        Contacts of the step.
    slip
        Longest elastic slip [m].
    avatar_motion
        How the avatar's vertices moved in the step [m], shape (v, 3), or None: no slip of the nodes that they
        carry, whose anchors travel along.
    """
    touching = contacts.touched(len(x))
    offset = x - anchors
    if avatar_motion is not None:
        offset -= _carried(contacts, len(x), avatar_motion)
    length = np.linalg.norm(offset, axis=1)
    keep = np.where(touching, np.minimum(1.0, slip / np.maximum(length, 1e-300)), 0.0)
    return np.asarray(x - offset * keep[:, None])


def _carried(contacts: Contacts, count: int, motion: Float) -> Float:
    """Return how the avatar under every node in contact with it moved, mean by force [m], shape (n, 3)."""
    vertices, weights = contacts.vertices[: contacts.body], contacts.weights[: contacts.body]
    push = np.linalg.norm(contacts.force[: contacts.body], axis=1)
    own = vertices < count
    share = np.where(own, 0.0, np.abs(weights))
    moved = np.einsum("cq,cqi->ci", share, motion[np.where(own, 0, vertices - count)])
    total, weight = np.zeros((count, 3)), np.zeros(count)
    for corner in range(4):
        real = own[:, corner]
        nodes, load = vertices[real, corner], np.abs(weights[real, corner]) * push[real]
        weight += np.bincount(nodes, weights=load, minlength=count)
        for axis in range(3):
            total[:, axis] += np.bincount(nodes, weights=load * moved[real, axis], minlength=count)
    return np.asarray(total / np.maximum(weight, 1e-300)[:, None])
