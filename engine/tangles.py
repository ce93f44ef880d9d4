"""Tangles: cloth that could not be sewn without crossing itself passes through until it is pulled smooth."""

import numpy as np

from toile.engine.drape_state import DrapeState
from toile.engine.step_request import StepRequest
from toile.geometry.arrays import Bool, Int


def around(drape: DrapeState, nodes: Int, widening: float = 1.0) -> Bool:
    """Mark material vertices within `widening` jam radii of nodes, along the cloth, shape (m,)."""
    faces = drape.stepper.faces
    marked = node_mask(len(drape.stepper.x), nodes)
    edge = float(np.sqrt(2.0 * drape.cloth.rest_area.mean()))
    for _ in range(int(np.ceil(widening * drape.plan.jam_radius / edge))):
        marked[faces[marked[faces].any(axis=1)].ravel()] = True
    return np.asarray(marked[drape.cloth.node])


def let_pass(drape: DrapeState, ghost: Bool) -> None:
    """Let marked material vertices, shape (m,), pass through each other until they are disentangled."""
    drape.ghost = ghost
    drape.stepper.let_pass(node_mask(len(drape.stepper.x), drape.cloth.node[ghost]))


def disentangle(drape: DrapeState, effort: float = 1.0) -> bool:
    """Make cloth that no longer crosses itself solid again; return whether all of it is.

    The patch that stays passable around a crossing grows with the square root of `effort`.
    """
    if not drape.ghost.any():
        return True
    stepper = drape.stepper
    crossing = drape.audit().cloth
    if len(crossing):
        let_pass(drape, around(drape, stepper.faces[crossing.ravel()].ravel(), np.sqrt(effort)))
        return False
    let_pass(drape, np.zeros_like(drape.ghost))
    return True


def relax_tangles(drape: DrapeState) -> None:
    """Pull tangled cloth smooth, without gravity, until nothing crosses any more.

    Whatever resists is pulled harder, over a wider patch, from frame to frame.
    """
    plan = drape.plan
    effort = 1.0
    while not drape.stopped() and not disentangle(drape, effort):
        for _ in range(plan.steps_per_frame):
            if drape.stopped():
                return
            drape.take(
                StepRequest(
                    h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False,
                    stitch_stiffness=plan.late_stiffness, tighten_stiffness=effort * plan.tighten_stiffness,
                    cg_tolerance=plan.cg_tolerance,
                )
            )  # fmt: skip
        effort = min(2.0 * effort, 16.0)


def node_mask(count: int, nodes: Int) -> Bool:
    """Mark nodes in an array of `count`."""
    mask = np.zeros(count, bool)
    mask[nodes] = True
    return mask
