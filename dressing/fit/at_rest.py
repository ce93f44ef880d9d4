"""Cloth brought closer to rest than a drape needs to be: until the forces on the body balance its weight."""

from dataclasses import replace

import numpy as np

from toile.dressing.fit.worn import Worn
from toile.engine.drape.drape import Drape
from toile.engine.drape.plan import DrapePlan, Frame
from toile.engine.step.contact_loads import contact_loads

MOST_STEPS = 400
CALM = 2e-6
"""RMS motion over a frame of steps that is rest [m]: what is seen to move is a hundred times that."""
STEADY = 0.004
"""Change of the force on the body over a frame, as a share of the weight, that is none."""
FRAMES, PATIENCE = 3, 20
"""Frames in a row over which it must not change; frames after which it need not be the weight: a floor or
pins may bear the rest."""
SOLVED = 1e-3
"""Relative residual of the linear solver."""


def at_rest(worn: Worn) -> Worn:
    """Return garments on the same mesh with their forces in equilibrium.

    A drape ends when nothing visible moves. The stiff directions of cloth are then still under way by
    micrometres, and with them its forces: contact may bear half as much again as the garment weighs.
    """
    cloth, body = worn.cloth, (worn.vertices, worn.faces)
    plan = DrapePlan(
        step=worn.step, max_steps=MOST_STEPS, rms_motion=CALM, peak_motion=10.0 * CALM, cg_tolerance=SOLVED
    )
    weight = float(cloth.mass.sum() * worn.step.gravity)
    carried: list[float] = []

    def moves(_: Frame) -> bool:
        now = replace(cloth, positions=run.stepper.x)
        carried.append(float(contact_loads(now, body, worn.step, run.anchors()).on_avatar[:, 1].sum()))
        last = np.array(carried[-FRAMES - 1 :])
        calm = len(last) > FRAMES and float(np.ptp(last)) <= STEADY * weight
        balanced = float(np.abs(last + weight).max()) <= STEADY * weight or len(carried) > PATIENCE
        return not (calm and balanced)

    run = Drape(cloth, body, [], plan, moves)
    if run.stepper.collisions is not None and worn.anchors is not None:
        run.stepper.collisions.anchor[: len(cloth.positions)] = worn.anchors
    run.hang()
    return replace(worn, cloth=run.cloth, anchors=run.anchors())
