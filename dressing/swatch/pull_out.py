"""One yarn drawn out of a patch that is held."""

import numpy as np

from toile.dressing.swatch.curve import Curve, Watch, say_nothing, settled
from toile.dressing.swatch.specimen import checked_count, specimen
from toile.dressing.weave.woven import Woven
from toile.geometry.errors import InputError

STEPS = 40
ACROSS = 9
"""Warp yarns of the patch; the middle one is drawn."""
STRETCH = 0.01
"""By how much the patch is held stretched: without any, finished yarns would not press on each other."""
SLIDING = 0.999
"""Share of the most that friction holds from which yarn is said to slide."""


def pull_yarn_out(
    cloth: Woven,
    *,
    crossings: int = 20,
    friction: float = 0.3,
    drawn: float = 0.02,
    watch: Watch = say_nothing,
) -> Curve:
    """Draw the middle warp yarn out of a held patch by a share of the spacing."""
    count = checked_count(crossings)
    if friction <= 0.0:
        raise InputError("a yarn is drawn against friction: give one above 0", field="friction")
    patch = specimen(cloth, np.ones((ACROSS, count), bool), friction=friction, flat=True)
    net = patch.net
    yarn = net.grid[ACROSS // 2]
    patch.state[: net.crossings] *= 1.0 + STRETCH
    patch.free[:] = False
    patch.free[net.crossings :, 2] = True
    patch.settle()
    patch.pressed = patch.contact_forces()
    patch.free[net.crossings + yarn[:-1], 0] = True
    end = net.crossings + yarn[-1]
    step = drawn * net.strands[0].spacing / STEPS
    rows: list[tuple[float, ...]] = []
    notes: list[str] = []
    for number in range(1, STEPS + 1):
        patch.state[end, 0] -= step
        if not settled(patch, f"{1e6 * step * number:.2f} um drawn", notes, watch):
            break
        most = friction * patch.pressed[yarn, 0]
        held = np.abs(patch.state[net.crossings + yarn, 0] - patch.anchors[yarn, 0]) * patch.grip
        rows.append(
            (
                1e3 * step * number, -1e3 * float(patch.reactions()[end, 0]), 1e3 * float(most.sum()),
                float((held > SLIDING * most).sum()),
            )
        )  # fmt: skip
    return Curve(
        f"a warp yarn drawn out of {ACROSS} x {count} crossings held {100.0 * STRETCH:g} % stretched",
        ("drawn [mm]", "force [mN]", "friction at most [mN]", "crossings that slide"),
        tuple(rows), (0, 1), tuple(notes), patch, STEPS,
    )  # fmt: skip
