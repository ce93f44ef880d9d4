"""Settling: the garment slides into place, then friction holds it and it steps to equilibrium."""

import numpy as np

from toile.engine.drape.merging import merge_late
from toile.engine.drape.state import DrapeState
from toile.engine.drape.tangles import relax_tangles
from toile.engine.forces.hold import Holds
from toile.engine.forces.step_request import MOTION_MAX, StepRequest
from toile.engine.step.options import StepOutcome
from toile.geometry.arrays import Float

LONG = 0.5
"""Steps that are long enough for equilibrium, on average over a frame, as a share of the longest."""
CALMER, LEAST_SHARE = 0.8, 0.25
"""Factor on the share of a displacement that is carried out when steps undo each other, and its least."""
FARTHER, LEAST_MOTION = 2.0, 1e-3
"""Longest motion of a node that a step may ask for, in that of the step before, and at least [m]: contacts
are searched for all that it asks for, and it is cut down then to what lowers the energy."""
FALLING, CALM = 2e-3, 6
"""Motion in a step of a tenth of the nodes from which cloth still falls [m]; how many steps in a row must be
calmer until it hangs."""
UNDOING = 0.2
"""Correlation with the last step from which a step is said to undo it."""


def ease(drape: DrapeState, more: int = 0) -> None:
    """Let the garment slide into place before friction holds it; waistbands stay at their height.

    It goes on for up to that many steps `more` while cloth falls.
    """
    plan = drape.plan
    stepper = drape.stepper
    waist = drape.cloth.waist
    # Where the vertices of a node started, on average: there the seams met.
    start = np.zeros_like(stepper.x)
    np.add.at(start, drape.cloth.node, drape.cloth.start_positions)
    start /= np.bincount(drape.cloth.node, minlength=len(start))[:, None]
    stepper.hold(Holds(waist, start[waist], np.tile([0.0, 1.0, 0.0], (len(waist), 1))))
    h, motion_max, calm = plan.sewing_step, MOTION_MAX, 0
    for count in range(plan.easing_steps + more):
        if drape.stopped():
            return
        outcome = drape.take(
            StepRequest(
                h=h, at_rest=True, friction=False, hold_stiffness=plan.waist_stiffness,
                stitch_stiffness=plan.late_stiffness, stitch_reach=drape.reach,
                cg_tolerance=plan.cg_tolerance, motion_max=motion_max,
            )
        )  # fmt: skip
        motion_max = _may_move(outcome)
        h = min(1.2 * h, plan.longest_step)
        # Steps are cut short now and then: a single one says little.
        calm = calm + 1 if np.quantile(outcome.moved, 0.9) < FALLING else 0
        if count >= plan.easing_steps and calm >= CALM:
            break
    stepper.hold(None)


def settle(drape: DrapeState) -> None:
    """Step to equilibrium: no node moves any more over a whole frame of steps."""
    plan, record = drape.plan, drape.record
    h, motion_max = plan.settling_step, MOTION_MAX
    before = drape.stepper.x.copy()
    here, last = before, np.zeros_like(before)
    span, share = 0.0, 1.0
    farthest = 0.0
    while not drape.stopped():
        if merge_late(drape):
            drape.phase = "sewing"
            relax_tangles(drape)
            drape.phase = "settling"
            before, span = drape.stepper.x.copy(), 0.0
            here, last = before, np.zeros_like(before)
        outcome = drape.take(
            StepRequest(
                h=h, at_rest=True, stitch_stiffness=plan.late_stiffness, stitch_reach=drape.reach,
                cg_tolerance=plan.cg_tolerance, move_share=share, motion_max=motion_max,
            )
        )  # fmt: skip
        motion_max = _may_move(outcome)
        if not drape.keep_mesh(float(outcome.moved.max()) - farthest):
            record.converged = True
            break
        farthest = float(outcome.moved.max())
        peak = float(np.quantile(outcome.moved, 0.999))
        span += share * h
        undone = _undoes(drape.stepper.x - here, last)
        last, here = drape.stepper.x - here, drape.stepper.x.copy()
        share = max(CALMER * share, LEAST_SHARE) if undone else min(share / CALMER, 1.0)
        if peak > 0.025:
            h = max(h / 1.5, plan.settling_step)
        elif peak < 0.01:
            h = min(h * 1.2, plan.longest_step)
        if record.steps % plan.steps_per_frame == 0:
            motion = np.linalg.norm(drape.stepper.x - before, axis=1)
            before = drape.stepper.x.copy()
            record.rms_motion = float(np.sqrt(np.mean(motion**2)))
            record.peak_motion = float(np.quantile(motion, 0.999))
            # Short and shared steps move less: what they may move is less in proportion.
            full = min(1.0, span / (plan.steps_per_frame * LONG * plan.longest_step))
            record.converged = (
                record.rms_motion < full * plan.rms_motion and record.peak_motion < full * plan.peak_motion
            )
            span = 0.0
            settled = record.converged
            if drape.needs_remeshing(settled) and drape.remesh(settled):
                before, record.converged = drape.stepper.x.copy(), False
                here, last = before, np.zeros_like(before)
            if record.converged:
                break


def _may_move(last: StepOutcome) -> float:
    """Longest motion of a node that the next step may ask for [m]."""
    return min(MOTION_MAX, max(LEAST_MOTION, FARTHER * float(last.moved.max())))


def _undoes(move: Float, last: Float) -> bool:
    """Whether a step takes back a good part of the one before, both shape (n, 3): contacts open and close."""
    return float(np.sum(move * last)) < -UNDOING * float(np.sqrt(np.sum(move**2) * np.sum(last**2)))
