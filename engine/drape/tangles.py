"""Tangles: cloth that crosses itself or the avatar may pass through until it is drawn apart."""

import numpy as np

from toile.engine.drape.merging import merge_late
from toile.engine.drape.passable import let_pass_crossings
from toile.engine.drape.state import DrapeState
from toile.engine.forces.step_request import StepRequest

LARGEST_EFFORT, GENTLE_EFFORT = 16.0, 4.0
"""Largest effort at the first attempt, which loosens most, and the second, which makes fewer new tangles."""

FEW, AGAIN = 10, 10
"""Crossings that are worth another try, and for how many frames."""


def disentangle(drape: DrapeState, effort: float = 1.0) -> bool:
    """Make cloth that crosses nothing any more solid again; return whether all of it is.

    The patch that stays passable around a crossing grows with the square root of `effort`.
    """
    if not drape.ghost.any():
        return True
    let_pass_crossings(drape, drape.audit(), np.sqrt(effort))
    return not drape.ghost.any()


def relax_tangles(drape: DrapeState) -> None:
    """Draw tangled cloth apart, without gravity, until nothing crosses any more or patience ends.

    Whatever resists is drawn harder, over a wider patch, from frame to frame. The last few crossings, which
    that only shifts about, are then drawn apart from the gentlest on once more.
    """
    plan = drape.plan
    effort = 1.0
    for count in range(plan.tangle_frames + AGAIN):
        if count == plan.tangle_frames:
            effort = 1.0
        if drape.stopped() or disentangle(drape, effort):
            return
        if count == plan.tangle_frames and sum(drape.record.crossings[-1]) > FEW:
            return
        _draw_apart(drape, effort)
        effort = min(2.0 * effort, GENTLE_EFFORT if drape.gentle else LARGEST_EFFORT)
    disentangle(drape)


def close_late(drape: DrapeState) -> None:
    """Close what is still open: cloth around it may pass through itself, and is then drawn apart.

    What is nearly closed may close without that.
    """
    gaps = drape.gaps()
    if not (drape.solid or drape.ghost.any()) and 0.0 < gaps.max(initial=0.0) < drape.plan.merge_gap:
        _draw_apart(drape, 1.0, clean=True)
        if (drape.gaps() < drape.plan.closed_gap).all():
            return
    for _ in range(0 if drape.solid else drape.plan.late_frames):
        if drape.stopped() or not len(drape.cloth.stitches):
            break
        let_pass_crossings(drape, drape.audit(), closing=drape.cloth.stitches.ravel())
        _draw_apart(drape, 1.0)
    relax_tangles(drape)


def _draw_apart(drape: DrapeState, effort: float, clean: bool = False) -> None:
    """Make a frame of steps in which tangled cloth is drawn apart and stitches close.

    If `clean`, none is merged with cloth in between.
    """
    plan = drape.plan
    for _ in range(plan.steps_per_frame):
        if drape.stopped():
            return
        merge_late(drape, clean)
        drape.take(
            StepRequest(
                h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False,
                stitch_stiffness=plan.late_stiffness, bending_factor=plan.sewing_bending,
                untangle_stiffness=effort * plan.untangle_stiffness, cg_tolerance=plan.cg_tolerance,
            )
        )  # fmt: skip
        if drape.audited == drape.record.steps and not any(drape.record.crossings[-1]):
            return  # Nothing crosses at this moment: it is seized.
