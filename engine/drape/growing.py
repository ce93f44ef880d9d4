"""Growing: the avatar takes on its true shape while the sewn garment gives way."""

import numpy as np

from toile.engine.drape.avatar_growth import grow_avatar
from toile.engine.drape.merging import merge_late
from toile.engine.drape.passable import let_pass_crossings
from toile.engine.drape.state import DrapeState
from toile.engine.drape.tangles import disentangle
from toile.engine.forces.step_request import StepRequest
from toile.geometry.arrays import Float

LEFT_BEHIND = 0.002
"""Share of the avatar's vertices that may be put in their places although cloth is there."""
TIGHT_AFTER = 6
"""Steps in a row in which the avatar waits before cloth counts as tight: carrying it along costs searches."""


def grow(drape: DrapeState, target: Float, per_step: float) -> None:
    """Let the avatar take on its true shape while the cloth gives way.

    It grows evenly: where cloth holds it back the rest waits, or its free parts would form a ledge
    around the cloth; tight cloth is carried along. Cloth that holds it back for long is caught, between toes,
    say: then the rest grows on, at last the few vertices that are left take their places, and cloth that they
    cut passes through and is drawn out.
    """
    plan = drape.plan
    assert drape.surface is not None
    start = drape.surface.vertices.copy()
    longest = max(float(np.linalg.norm(target - start, axis=1).max()), 1e-12)
    share = 0.0
    left = 0.0
    waited = finishing = in_a_row = 0
    tight = False
    while not drape.stopped():
        # Nothing may start to cross while the avatar pushes: it would be drawn apart against it.
        merge_late(drape, clean=True)
        waiting = left >= plan.growth_lag or share == 1.0
        in_a_row = in_a_row + 1 if waiting else 0
        tight = tight or in_a_row > TIGHT_AFTER
        if left < plan.growth_lag or waited > plan.growth_patience:
            share = min(1.0, share + per_step / longest)
        else:
            waited += 1
        if share == 1.0:
            finishing += 1
        if finishing > plan.growth_patience and not drape.solid and _few_left(drape, target):
            assert drape.stepper.collisions is not None
            drape.stepper.collisions.put_avatar(target)
            drape.auditor = None
            let_pass_crossings(drape, drape.audit())
            break
        shape = target if share == 1.0 else start + share * (target - start)
        now = drape.clock.now()
        left = grow_avatar(drape.stepper, shape, 2.0 * per_step, carry=waiting and tight)
        drape.clock.add("avatar", now)
        drape.auditor = None
        drape.take(
            StepRequest(
                h=plan.sewing_step, at_rest=True, gravity=0.0, friction=False,
                stitch_stiffness=plan.late_stiffness, stitch_reach=drape.reach,
                untangle_stiffness=plan.untangle_stiffness,
                cg_tolerance=plan.cg_tolerance,
            )
        )  # fmt: skip
        if share == 1.0 and left == 0.0:
            break
        if drape.record.steps % plan.steps_per_frame == 0:
            disentangle(drape)
    grow_avatar(drape.stepper, target, 0.0)


def _few_left(drape: DrapeState, target: Float) -> bool:
    """Whether only a few vertices are still away from their places."""
    assert drape.surface is not None
    left = np.abs(target - drape.surface.vertices).max(axis=1) > 0.0
    return bool(left.mean() < LEFT_BEHIND)
