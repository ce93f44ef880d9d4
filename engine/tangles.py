"""Tangles: where cloth crosses itself or the avatar it passes through, until it is drawn apart."""

import numpy as np

from toile.collide.audit import Crossings
from toile.engine.drape_state import DrapeState, node_mask
from toile.engine.merging import merge_late
from toile.engine.step_request import StepRequest
from toile.geometry.arrays import Bool, Int

BODY_RINGS = 3
"""Rings of avatar faces around a crossing that let cloth pass."""


def around(drape: DrapeState, nodes: Int, widening: float = 1.0) -> Bool:
    """Mark material vertices within `widening` jam radii of nodes, along the cloth, shape (m,)."""
    faces = drape.stepper.faces
    marked = node_mask(len(drape.stepper.x), nodes)
    edge = float(np.sqrt(2.0 * drape.cloth.rest_area.mean()))
    for _ in range(int(np.ceil(widening * drape.plan.jam_radius / edge))):
        marked[faces[marked[faces].any(axis=1)].ravel()] = True
    return np.asarray(marked[drape.cloth.node])


def disentangle(drape: DrapeState, effort: float = 1.0) -> bool:
    """Make cloth that crosses nothing any more solid again; return whether all of it is.

    The patch that stays passable around a crossing grows with the square root of `effort`.
    """
    if not drape.ghost.any():
        return True
    let_pass_crossings(drape, drape.audit(), np.sqrt(effort))
    return not drape.ghost.any()


def let_pass_crossings(drape: DrapeState, found: Crossings, widening: float = 1.0) -> None:
    """Let cloth pass through what it crosses, and nothing else."""
    crossed = [found.avatar[:, 0]] + ([found.cloth.ravel()] if drape.plan.step.self_contact else [])
    crossing = drape.stepper.faces[np.concatenate(crossed)].ravel()
    body: Bool | None = None
    if drape.surface is not None and len(found.avatar):
        body = np.zeros(len(drape.surface.vertices), bool)
        body[drape.surface.faces[found.avatar[:, 1]].ravel()] = True
        for _ in range(BODY_RINGS):
            body[drape.surface.faces[body[drape.surface.faces].any(axis=1)].ravel()] = True
    drape.let_pass(around(drape, crossing, widening), body)


def relax_tangles(drape: DrapeState) -> None:
    """Draw tangled cloth apart, without gravity, until nothing crosses any more or patience ends.

    Whatever resists is drawn harder, over a wider patch, from frame to frame.
    """
    plan = drape.plan
    effort = 1.0
    for _ in range(plan.tangle_frames):
        if drape.stopped() or disentangle(drape, effort):
            return
        for _ in range(plan.steps_per_frame):
            if drape.stopped():
                return
            merge_late(drape)
            drape.take(
                StepRequest(
                    h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False,
                    stitch_stiffness=plan.late_stiffness, bending_factor=plan.sewing_bending,
                    untangle_stiffness=effort * plan.untangle_stiffness, cg_tolerance=plan.cg_tolerance,
                )
            )  # fmt: skip
        effort = min(2.0 * effort, 16.0)
    disentangle(drape)
