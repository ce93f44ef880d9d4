"""Merging: the two nodes of a stitch that has closed become one."""

from dataclasses import replace

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.drape.passable import let_pass_crossings
from toile.engine.drape.state import DrapeState

ARRIVED = 3e-4
"""Distance from its meeting place at which a node is put there [m], whatever is in between: that is found."""
ARRIVED_SOLID = 1e-5
"""The same where no cloth may pass: less than any two pieces keep apart, so that nothing is in between."""


def join_touching(drape: DrapeState) -> None:
    """Merge stitches that are closed from the start, such as those along the texture seams of a mesh."""
    if not len(drape.cloth.stitches):
        return
    touching = drape.cloth.stitch_length < 1e-9
    if touching.any():
        drape.restart(drape.cloth.merged(touching))
    if not len(drape.cloth.stitches):
        drape.phase = "growing" if drape.growth else "settling"


def merge(drape: DrapeState, clean: bool = False) -> None:
    """Move the nodes of closed stitches together as far as is safe, and merge those that arrived.

    What crosses then may pass through itself. Where no cloth may, or if `clean`, stitches at fault stay open.
    """
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
    arrived = ARRIVED_SOLID if drape.solid else ARRIVED
    late[weld[np.linalg.norm(target - stepper.x, axis=1) >= arrived]] = True
    closed = near & ~late[weld[cloth.stitches[:, 0]]]
    cloth = replace(cloth, positions=stepper.x.copy())
    radius = None if stepper.collisions is None else stepper.collisions.least_body_radius
    while closed.any():
        restart_near(drape, cloth.merged(closed), radius)
        # What was between, or crossed unseen across the open seam, is found now.
        crossings = drape.audit()
        if not (len(crossings.avatar) or len(crossings.cloth)):
            return
        if not (drape.solid or clean):
            let_pass_crossings(drape, crossings)
            return
        crossing = np.concatenate([crossings.avatar[:, 0], crossings.cloth.ravel()])
        at_fault = np.isin(weld[cloth.stitches], weld[cloth.face_nodes[crossing]]).any(axis=1)
        closed = closed & ~at_fault if (closed & at_fault).any() else np.zeros_like(closed)
        restart_near(drape, cloth, radius)


def restart_near(drape: DrapeState, cloth: Cloth, body_radius: float | None) -> None:
    """Continue with a cloth of another topology, at the same least distance [m] from the avatar."""
    drape.restart(cloth)
    if drape.stepper.collisions is not None and body_radius is not None:
        drape.stepper.collisions.set_body_radius(body_radius)


def merge_late(drape: DrapeState, clean: bool = False) -> bool:
    """Every few steps, merge stitches that have closed since; return whether any were.

    If `clean`, none is merged with cloth in between.
    """
    if not len(drape.cloth.stitches) or drape.record.steps % drape.plan.steps_per_frame:
        return False
    count = len(drape.cloth.stitches)
    if (drape.gaps() < drape.plan.merge_gap).any():
        merge(drape, clean)
    return len(drape.cloth.stitches) < count
