"""Passable cloth: where it crosses itself or the avatar it may pass, and nowhere else."""

import numpy as np

from toile.collide.audit import Crossings
from toile.engine.drape.state import DrapeState, node_mask
from toile.geometry.arrays import Bool, Int

GENTLY_NARROWER = 0.5
"""Factor on the radius around crossings at the second attempt."""
BODY_RINGS = 3
"""Rings of avatar faces around a crossing that let cloth pass."""


def around(drape: DrapeState, nodes: Int, radius: float) -> Bool:
    """Mark material vertices within about `radius` [m] of nodes, along the cloth, shape (m,)."""
    faces = drape.cloth.face_nodes
    marked = node_mask(len(drape.stepper.x), nodes)
    edge = float(np.sqrt(2.0 * drape.cloth.rest_area.mean()))
    for _ in range(int(np.ceil(radius / edge))):
        marked[faces[marked[faces].any(axis=1)].ravel()] = True
    return np.asarray(marked[drape.cloth.node])


def let_pass_crossings(
    drape: DrapeState, found: Crossings, widening: float = 1.0, closing: Int | None = None
) -> None:
    """Let cloth pass through what it crosses, and around `closing` nodes of open stitches; nothing else."""
    crossed = [found.avatar[:, 0]] + ([found.cloth.ravel()] if drape.plan.step.self_contact else [])
    crossing = drape.cloth.face_nodes[np.concatenate(crossed)].ravel()
    body: Bool | None = None
    if drape.surface is not None and len(found.avatar):
        body = np.zeros(len(drape.surface.vertices), bool)
        body[drape.surface.faces[found.avatar[:, 1]].ravel()] = True
        for _ in range(BODY_RINGS):
            body[drape.surface.faces[body[drape.surface.faces].any(axis=1)].ravel()] = True
    radius = widening * drape.plan.jam_radius * (GENTLY_NARROWER if drape.gentle else 1.0)
    passing = around(drape, crossing, radius)
    if closing is not None:
        passing |= around(drape, closing, drape.plan.jam_radius)
    drape.let_pass(passing, body)
