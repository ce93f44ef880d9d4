"""Panels that hang from those on the shoulders start right below them, where their seams will lie.

Patterns leave room between tiers: bodice, waistband and legs, or sleeve and cuff. Seams that meet half way
pull the upper tier down with the lower one up, and the bodice's shoulder seams into the shoulders. What
hangs from the shoulders has its height from them, so the lower tiers move instead, before anything is sewn.
"""

from dataclasses import replace

import numpy as np

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.arms import on_sleeves
from toile.dressing.wear.start.rings import BELOW, facing_of, is_flared, owner_of
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import connected

ROOM = 0.01
"""Room that stays between the edges of two tiers [m]."""
LEAST = 0.005
"""Shifts below this are left out [m]."""


def hung_below(mesh: GarmentMesh, shoulder: float, unit: float = 1.0) -> tuple[GarmentMesh, tuple[str, ...]]:
    """Move the tiers of a garment that reaches the shoulders, at a height [m], to those they hang from.

    Pieces of a tier that hang together move as one, seen from the front, by the mean distance of the seams
    that join them to the tier above. Flared pieces stay, whose edge lies straight only when it is sewn, and
    all stays where a piece has no front or no back. Returns one sentence for each piece that moved as well;
    `unit` is how many metres a unit of length is.
    """
    if not mesh.flat or not len(mesh.stitches) or not np.isfinite(shoulder):
        return mesh, ()
    count = len(mesh.panel_names)
    owner, facing = owner_of(mesh), facing_of(mesh)
    top = np.full(count, -np.inf)
    np.maximum.at(top, owner, mesh.positions[:, 1])
    ends = owner[mesh.stitches]
    positions, sleeve = mesh.positions.copy(), on_sleeves(mesh)
    done: Bool = top >= shoulder - BELOW
    notes = []
    while done.any() and not done.all():
        joins = done[ends[:, 0]] != done[ends[:, 1]]
        tier = np.zeros(count, bool)
        tier[ends[joins].ravel()] = True
        tier &= ~done
        if not tier.any():
            break
        within = ends[tier[ends].all(axis=1)]
        piece = connected(within, count)
        for number in np.unique(piece[tier]):
            own = tier & (piece == number)
            if facing[own].min() * facing[own].max() >= 0.0:
                # Half of a ring would come to lie elsewhere than the other one.
                return mesh, ()
            if is_flared(mesh, joins & own[ends].any(axis=1), own[ends]):
                continue
            # Legs and their cuffs stay where the body's legs are, seen from above.
            sideways = bool(sleeve[own[owner]].any())
            shift = _shift(positions, mesh.stitches[joins], own[ends[joins]], sideways)
            if np.linalg.norm(shift) < LEAST:
                continue
            positions[own[owner]] += shift
            names = ", ".join(np.array(mesh.panel_names)[own])
            notes.append(
                f"garment {mesh.name}: {names} start {100.0 * unit * np.linalg.norm(shift):.0f} cm nearer to "
                "what they hang from"
            )
        done |= tier
    return (replace(mesh, positions=positions), tuple(notes)) if notes else (mesh, ())


def _shift(positions: Float, stitches: Int, own: Bool, sideways: bool) -> Float:
    """How far a piece moves, in y and perhaps x, for its ends of stitches, marked, to meet the rest."""
    mine, other = positions[stitches[own]], positions[stitches[:, ::-1][own]]
    way = (other - mine).mean(axis=0)
    way[2] = 0.0
    if not sideways:
        way[0] = 0.0
    length = float(np.linalg.norm(way))
    return np.asarray(way * max(0.0, 1.0 - ROOM / max(length, 1e-12)))
