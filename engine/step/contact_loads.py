"""What cloth and avatar do to each other at equilibrium: forces of the contacts, on nodes and vertices."""

from dataclasses import dataclass

import numpy as np

from toile.collide.avatar_surface import AvatarSurface
from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.contact import Contacts
from toile.engine.forces.friction import friction_at_start, rubbed
from toile.engine.step.collisions import Collisions
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float, Int


@dataclass(frozen=True, kw_only=True)
class ContactLoads:
    """Forces between a cloth and an avatar, friction included.

    Attributes
    ----------
    press_nodes, press_avatar
        Normal forces of all contacts with the other, added up without their directions [N], shapes (n,) and
        (v,): over the area they are the pressure.
    on_nodes
        Forces of the avatar on the nodes [N], shape (n, 3).
    on_avatar
        Forces of the cloth on the avatar's vertices [N], shape (v, 3).
    """

    press_nodes: Float
    press_avatar: Float
    on_nodes: Float
    on_avatar: Float


def contact_loads(
    cloth: Cloth, avatar: tuple[Float, Int], options: StepOptions, anchors: Float | None = None
) -> ContactLoads:
    """Return the forces between a cloth at rest and an avatar: vertices [m], (v, 3), and faces, (t, 3).

    `anchors` are where friction holds the nodes [m], shape (n, 3), as the stepper left them; without them
    nothing rubs. Pressure follows from the gaps alone.
    """
    collisions = Collisions(cloth, AvatarSurface(*avatar), options)
    count = len(cloth.positions)
    if anchors is not None:
        collisions.anchor[:count] = anchors
    contacts = collisions.detect(cloth.positions)
    return _loads(rubbed(contacts, friction_at_start(contacts, options.slip)), count, len(avatar[0]))


def presses_of_nodes(contacts: Contacts, count: int) -> Float:
    """Return the normal forces on nodes [N], shape (n,): of the avatar, and of cloth on itself."""
    press = np.zeros(count)
    for corner in range(4):
        at = contacts.vertices[:, corner]
        own = at < count
        press += np.bincount(at[own], np.abs(contacts.weights[own, corner]) * contacts.push[own], count)[
            :count
        ]
    return press


def _loads(contacts: Contacts, count: int, others: int) -> ContactLoads:
    """Add up the contacts with an avatar of `others` vertices at its vertices and at `count` nodes."""
    rows = slice(0, contacts.body)
    vertices, weights = contacts.vertices[rows], contacts.weights[rows]
    push, force = contacts.push[rows], contacts.force[rows]
    whole = count + others
    press, on = np.zeros(whole), np.zeros((whole, 3))
    for corner in range(4):
        at = vertices[:, corner]
        press += np.bincount(at, np.abs(weights[:, corner]) * push, whole)
        for axis in range(3):
            on[:, axis] += np.bincount(at, weights[:, corner] * force[:, axis], whole)
    return ContactLoads(
        press_nodes=press[:count], press_avatar=press[count:], on_nodes=on[:count], on_avatar=on[count:]
    )
