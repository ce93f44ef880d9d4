"""Sewing: panels slide over their meeting places, seams close, and the nodes of closed stitches merge."""

from dataclasses import replace

import numpy as np

from toile.engine.drape_state import DrapeState
from toile.engine.forces.hold import SewingHolds
from toile.engine.step_request import StepRequest
from toile.engine.tangles import around, let_pass
from toile.engine.zipper import zipper_distance


def join_touching(drape: DrapeState) -> None:
    """Merge stitches that are closed from the start, such as those along the texture seams of a mesh."""
    if not len(drape.cloth.stitches):
        return
    touching = drape.cloth.stitch_length < 1e-9
    if touching.any():
        drape.restart(drape.cloth.merged(touching))
    if not len(drape.cloth.stitches):
        drape.phase = "growing" if drape.growth else "settling"


def sew(drape: DrapeState) -> None:
    """Close all seams on schedule, and merge what has closed.

    Stitches that have not closed some time after they should have are jammed: the cloth around them may
    pass through itself.
    """
    plan = drape.plan
    holds = drape.stepper.holds
    assert isinstance(holds, SewingHolds)
    slide_in_plane(drape)
    if drape.stopped():
        return
    drape.stepper.stitch_length = drape.gaps()
    closing = max(1, int(np.ceil(drape.stepper.stitch_length.max() / plan.closing_per_step)))
    pairs = drape.cloth.stitches
    cloth = drape.cloth
    delay = zipper_distance(cloth.positions, pairs, cloth.seam, cloth.weld) / plan.zipper_per_step
    total = closing + int(np.ceil(delay.max()))
    stiffness, hold = plan.stitch_stiffness, plan.hold_stiffness
    node_share = np.ones(len(drape.cloth.positions))
    for count in range(total + 2 * plan.patience):
        share = np.clip(1.0 - (count + 1 - delay) / closing, 0.0, 1.0)
        node_share[pairs[:, 0]] = share
        node_share[pairs[:, 1]] = share
        if count == total + plan.patience:
            let_pass(drape, around(drape, pairs[drape.gaps() >= plan.closed_gap].ravel()))
        if count >= total:
            stiffness *= plan.stiffening
            hold *= 0.7
            if (drape.gaps() < plan.closed_gap).all():
                break
        holds.approach(node_share)
        drape.take(
            StepRequest(
                h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False, hold_stiffness=hold,
                stitch_share=share, stitch_stiffness=stiffness, cg_tolerance=plan.cg_tolerance,
            )
        )  # fmt: skip
        if drape.stopped():
            return
    merge(drape)


def slide_in_plane(drape: DrapeState) -> None:
    """Bring stitched nodes over their meeting places, each in the plane of its panel."""
    plan = drape.plan
    for _ in range(plan.sliding_steps):
        if drape.stopped():
            return
        outcome = drape.take(
            StepRequest(
                h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False,
                hold_stiffness=plan.sliding_stiffness, cg_tolerance=plan.cg_tolerance,
            )
        )  # fmt: skip
        if outcome.moved.max() < 0.1 * plan.closing_per_step:
            break


def merge(drape: DrapeState) -> None:
    """Move the nodes of closed stitches together as far as is safe, and merge those that arrived."""
    gaps = drape.gaps()
    near = gaps < drape.plan.merge_gap
    stepper = drape.stepper
    cloth = replace(drape.cloth, positions=stepper.x.copy(), velocities=stepper.v.copy())
    trial = cloth.merged(near)
    target = np.empty_like(stepper.x)
    target[cloth.node] = trial.positions[trial.node]
    for _ in range(30):
        wanted = target - stepper.x
        if np.abs(wanted).max() < 1e-12:
            break
        stepper.safe_move(wanted)
    # A node stands for all that are merged with it: one late node keeps its whole group open.
    weld = cloth.weld
    late = np.zeros(len(weld), bool)
    late[weld[np.linalg.norm(target - stepper.x, axis=1) >= 1e-9]] = True
    closed = near & ~late[weld[cloth.stitches[:, 0]]]
    if closed.any():
        radius = stepper.radius_body.copy()
        drape.restart(replace(cloth, positions=stepper.x.copy()).merged(closed))
        drape.stepper.set_body_radius(float(radius.max()))
        let_pass(drape, drape.ghost)


def merge_late(drape: DrapeState) -> bool:
    """Every few steps, merge stitches that have closed since; return whether any were."""
    if not len(drape.cloth.stitches) or drape.record.steps % drape.plan.steps_per_frame:
        return False
    count = len(drape.cloth.stitches)
    if (drape.gaps() < drape.plan.merge_gap).any():
        merge(drape)
    return len(drape.cloth.stitches) < count
