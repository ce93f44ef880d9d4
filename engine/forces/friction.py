"""Coulomb friction of contacts, smoothed, from the normal forces and slips at the end of the step.

Friction pulls against the tangential slip u with mu * lambda * f(|u|), f rising smoothly from 0 to 1 at
|u| = slip (Li et al. 2020, section 5), linear in u by the secant to the slip at the end of the step.

Cloth lies on a surface within a micrometre of the contact radius. A node that lands presses for one step with
hundreds of times its weight, and one that slides has slipped far by the end of the step: friction by what is
known at its start grips hundreds of times too much or as if it stuck. So the step is solved once more with
the normal forces and slips of its first solution, and again while friction changes.
"""

from typing import NamedTuple

import numpy as np
from numba import types

from toile.collide.pair_distance import length
from toile.engine.forces.contact import Contacts
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_1, F64_2, I32_2, OUT_F64_1, kernel


class Friction(NamedTuple):
    """Friction of all contacts of one linear solve.

    Attributes
    ----------
    load
        Normal forces [N], shape (c,): contacts without are let go.
    grip
        Friction per slip [N/m], shape (c,).
    reach
        Slip at the end of the step, about [m], shape (c,).
    """

    load: Float
    grip: Float
    reach: Float

    def differs(self, known: "Friction", share: float) -> bool:
        """Whether another friction would change forces at the end of the step by more than a share of all."""
        change = float((np.abs(self.grip - known.grip) * self.reach).sum())
        return change > share * float((self.grip * self.reach).sum())


def friction_at_start(contacts: Contacts, slip: float) -> Friction:
    """Friction if nothing moved: normal forces and slips as they are."""
    reach = np.sqrt(np.einsum("ci,ci->c", contacts.slid, contacts.slid))
    load = np.maximum(contacts.push, 0.0)
    grip = _grip(contacts.friction * load, reach, slip)
    # Contacts ahead hold without a force yet.
    return Friction(np.full(len(load), np.inf), grip, reach)


def friction_after(contacts: Contacts, known: Friction, move: Float, inertia: Float, slip: float) -> Friction:
    """Friction of the forces and slips that a solution of the step brings about.

    Parameters
    ----------
    contacts
        Contacts of the step, without friction.
    known
        The friction that the solution is for.
    move
        The solution [m], shape (n, 3).
    inertia
        Mass of every node over the square of the time step [N/m], shape (n,); infinite for pins.
    slip
        Slip at which friction is fully mobilised [m].
    """
    load, reach = np.empty(contacts.count), np.empty(contacts.count)
    _predict(
        contacts.nodes, contacts.weights, contacts.normal, contacts.push, contacts.hard, contacts.slid,
        contacts.friction, known.grip, move, inertia, slip, load, reach,
    )  # fmt: skip
    grip = _grip(contacts.friction * load, reach, slip)
    return Friction(load, grip, reach)


def rubbed(contacts: Contacts, friction: Friction) -> Contacts:
    """Return the contacts that hold, with their friction."""
    held = friction.load > 0.0
    push, hard = np.where(held, contacts.push, 0.0), np.where(held, contacts.hard, 0.0)
    return contacts.pressing(push, hard, friction.grip)


def _grip(limit: Float, reach: Float, slip: float) -> Float:
    """Secant of friction of at most `limit` [N] at slips `reach` [m], shape (c,): [N/m]."""
    far = 1.0 / np.maximum(reach, slip)
    return np.asarray(limit * np.where(reach < slip, (2.0 - reach / slip) / slip, far))


@kernel(
    types.void(
        I32_2, F64_2, F64_2, F64_1, F64_1, F64_2, F64_1, F64_1, F64_2, F64_1, types.float64, OUT_F64_1,
        OUT_F64_1,
    )
)  # fmt: skip
def _predict(  # type: ignore[no-untyped-def]
    nodes: Int, weights, normal, push, hard, slid, friction, grip, move, inertia, slip, load, reach
):  # fmt: skip
    """Write normal forces [N] and slips [m] at the end of a step from a solution.

    A pair by itself of mass M h^2: M (s - s_free) + mu load f(s) = 0, where the solution has s_free from
    M (s - s_free) + grip s = 0.
    """
    for c in range(nodes.shape[0]):
        soft = 0.0
        x, y, z = 0.0, 0.0, 0.0
        for q in range(4):
            i = nodes[c, q]
            if i >= 0:
                soft += weights[c, q] * weights[c, q] / inertia[i]
                x += weights[c, q] * move[i, 0]
                y += weights[c, q] * move[i, 1]
                z += weights[c, q] * move[i, 2]
        opened = x * normal[c, 0] + y * normal[c, 1] + z * normal[c, 2]
        load[c] = max(push[c] - hard[c] * opened, 0.0)
        x += slid[c, 0] - opened * normal[c, 0]
        y += slid[c, 1] - opened * normal[c, 1]
        z += slid[c, 2] - opened * normal[c, 2]
        slipped = length(x, y, z)
        limit = friction[c] * load[c]
        if soft <= 0.0:
            reach[c] = slipped
            continue
        heavy = 1.0 / soft
        drive = (heavy + grip[c]) * slipped
        if drive >= limit + heavy * slip:
            reach[c] = max((drive - limit) / heavy, slipped)
        else:
            # heavy s + limit (2 s / slip - s^2 / slip^2) = drive.
            half = 0.5 * heavy * slip + limit
            rest = max(half * half - limit * drive, 0.0)
            reach[c] = max(slip * drive / (half + np.sqrt(rest)), slipped)
