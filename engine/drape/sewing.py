"""Sewing: panels slide over their meeting places, then seams close."""

import numpy as np

from toile.engine.cloth.zipper import zipper_distance
from toile.engine.drape.merging import merge
from toile.engine.drape.passable import around
from toile.engine.drape.state import DrapeState
from toile.engine.forces.hold import SewingHolds
from toile.engine.forces.step_request import StepRequest
from toile.engine.forces.stitch import Stitches


def sew(drape: DrapeState) -> None:
    """Close all seams on schedule, and merge what has closed.

    Stitches that have not closed some time after they should have are jammed: cloth lies between them. The
    cloth around them may then pass through itself, and is drawn apart where it crosses.
    """
    close(drape)
    if not drape.stopped():
        drape.remember()
        close_jams(drape)


def close_jams(drape: DrapeState) -> None:
    """Close what is jammed by letting cloth pass, and merge what has closed."""
    plan = drape.plan
    pairs = drape.cloth.stitches
    stiffness = plan.stitch_stiffness * plan.stiffening ** (2 * plan.patience)
    jammed = drape.gaps() >= plan.merge_gap
    if jammed.any():
        drape.let_pass(around(drape, pairs[jammed].ravel(), plan.jam_radius))
    for _ in range(plan.patience if jammed.any() else 0):
        drape.take(
            StepRequest(
                h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False, stitch_stiffness=stiffness,
                bending_factor=plan.sewing_bending, untangle_stiffness=plan.untangle_stiffness,
                cg_tolerance=plan.cg_tolerance,
            )
        )  # fmt: skip
        if drape.stopped():
            return
        if (drape.gaps() < plan.closed_gap).all():
            break
    merge(drape)


def close(drape: DrapeState) -> None:
    """Close all seams on schedule, until all nodes of stitches have met or patience ends."""
    plan = drape.plan
    holds, stitches = drape.stepper.force(SewingHolds), drape.stepper.force(Stitches)
    assert holds is not None and stitches is not None
    slide_in_plane(drape)
    if drape.stopped():
        return
    gaps = drape.gaps()
    stitches.start_from(gaps)
    closing = max(1, int(np.ceil(gaps.max() / plan.closing_per_step)))
    pairs = drape.cloth.stitches
    cloth = drape.cloth
    delay = zipper_distance(cloth.positions, pairs, cloth.seam, cloth.weld) / plan.zipper_per_step
    total = closing + int(np.ceil(delay.max()))
    stiffness, hold = plan.stitch_stiffness, plan.hold_stiffness
    node_share = np.ones(len(drape.cloth.positions))
    for count in range(total + plan.patience):
        share = np.clip(1.0 - (count + 1 - delay) / closing, 0.0, 1.0)
        node_share[pairs[:, 0]] = share
        node_share[pairs[:, 1]] = share
        if count >= total:
            stiffness *= plan.stiffening
            hold *= 0.7
            if (drape.gaps() < plan.closed_gap).all():
                break
        holds.approach(node_share)
        drape.take(
            StepRequest(
                h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False, hold_stiffness=hold,
                stitch_share=share, stitch_stiffness=stiffness, bending_factor=plan.sewing_bending,
                cg_tolerance=plan.cg_tolerance,
            )
        )  # fmt: skip
        if drape.stopped():
            return


def slide_in_plane(drape: DrapeState) -> None:
    """Bring stitched nodes over their meeting places, each in the plane of its panel."""
    plan = drape.plan
    for _ in range(plan.sliding_steps):
        if drape.stopped():
            return
        outcome = drape.take(
            StepRequest(
                h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False,
                hold_stiffness=plan.sliding_stiffness, bending_factor=plan.sewing_bending,
                cg_tolerance=plan.cg_tolerance,
            )
        )  # fmt: skip
        if outcome.moved.max() < 0.1 * plan.closing_per_step:
            break
