"""Unpicking: when tangles do not come loose, seams that closed by passing through cloth are opened again.

Before cloth is first let pass through itself the drape is remembered. From there a second attempt is made,
more gently. If that fails too, what closes without a crossing is kept, and cloth never passes again: a
garment with an open seam is worth more than one that crosses itself.
"""

import numpy as np

from toile.engine.drape.merging import merge
from toile.engine.drape.sewing import close_jams
from toile.engine.drape.state import OPEN_REACH, DrapeState


def sew_again(drape: DrapeState) -> None:
    """Go back to the jammed seams, and close them again, more gently."""
    _go_back(drape)
    drape.gentle = True
    close_jams(drape)


def leave_open(drape: DrapeState) -> None:
    """Go back to the jammed seams, and close only what needs no passing."""
    _go_back(drape)
    drape.before_passing = None
    drape.solid = True
    drape.reach = OPEN_REACH
    merge(drape)


def _go_back(drape: DrapeState) -> None:
    """Restore the drape as it was before cloth was let pass."""
    start = drape.before_passing
    assert start is not None
    drape.phase = "sewing"
    drape.pins_hold = False
    if start.avatar is not None and drape.stepper.collisions is not None:
        drape.stepper.collisions.put_avatar(start.avatar)
        drape.auditor = None
    drape.ghost, drape.avatar_ghost = np.zeros(len(start.cloth.node), bool), None
    drape.restart(start.cloth)
