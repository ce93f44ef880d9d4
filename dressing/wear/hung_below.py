"""Panels that hang from those on the shoulders start right below them, where their seams will lie.

Patterns leave room between tiers: between bodice, waistband and legs, or sleeve and cuff. Seams that meet half way
pull the upper tier down with the lower one up, and the bodice's shoulder seams into the shoulders. What hangs
from the shoulders has its height from them, so the lower tiers move instead, before anything is sewn.
"""

from dataclasses import replace

import numpy as np

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import connected

ROOM = 0.01
"""Room that stays between the edges of two tiers [m]."""
LEAST = 0.005
"""Shifts below this are left out [m]."""


def hung_below(mesh: GarmentMesh, shoulder: float) -> tuple[GarmentMesh, tuple[str, ...]]:
    """Move the tiers of a garment that reaches above the shoulders, at a height [m], to those they hang from.

    Pieces of a tier that hang together move as one, seen from the front, by the mean distance of the seams that
    join them to the tier above. Returns the garment and one sentence for each piece that moved.
    """
    if not mesh.flat or not len(mesh.stitches) or not np.isfinite(shoulder):
        return mesh, ()
    count = len(mesh.panel_names)
    owner = np.zeros(len(mesh.positions), np.int32)
    owner[mesh.faces.ravel()] = np.repeat(mesh.panel, 3)
    top = np.full(count, -np.inf)
    np.maximum.at(top, owner, mesh.positions[:, 1])
    ends = owner[mesh.stitches]
    positions = mesh.positions.copy()
    done: Bool = top >= shoulder
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
            shift = _shift(positions, mesh.stitches[joins], own[ends[joins]])
            if np.linalg.norm(shift) < LEAST:
                continue
            positions[own[owner]] += shift
            names = ", ".join(np.array(mesh.panel_names)[own])
            notes.append(
                f"garment {mesh.name}: {names} start {100.0 * np.linalg.norm(shift):.0f} cm nearer to what they "
                "hang from"
            )
        done |= tier
    return (replace(mesh, positions=positions), tuple(notes)) if notes else (mesh, ())


def _shift(positions: Float, stitches: Int, own: Bool) -> Float:
    """How far a piece moves, in x and y, so that its side of stitches, marked in `own` (s, 2), meets the other."""
    mine, other = positions[stitches[own]], positions[stitches[:, ::-1][own]]
    way = (other - mine).mean(axis=0)
    way[2] = 0.0
    length = float(np.linalg.norm(way))
    return np.asarray(way * max(0.0, 1.0 - ROOM / max(length, 1e-12)))
