"""A square pulled along warp or weft, its other sides free."""

import math

import numpy as np

from toile.dressing.swatch.curve import Curve, Watch, say_nothing, settled
from toile.dressing.swatch.specimen import checked_count, specimen
from toile.dressing.weave.woven import Woven
from toile.engine.swatch.net import WARP, WEFT

TENSIONS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 250.0, 500.0, 1000.0)
"""[N/m]."""


def pull_uniaxially(
    cloth: Woven,
    *,
    axis: int = WARP,
    crossings: int = 20,
    friction: float = 0.0,
    tensions: tuple[float, ...] = TENSIONS,
    watch: Watch = say_nothing,
) -> Curve:
    """Pull a square of so many crossings along warp (0) or weft (1); strains are those of its middle."""
    count = checked_count(crossings)
    patch = specimen(cloth, np.ones((count, count), bool), friction=friction, flat=True)
    net = patch.net
    grid = net.grid if axis == WARP else net.grid.T
    patch.free[grid[:, 0], axis] = False
    patch.free[grid[count // 2, 0], 1 - axis] = False
    own, other = (net.strands[axis], net.strands[1 - axis])
    # Over whole repeats of the weave: floats stretch less than where yarns change sides.
    repeat = math.lcm(*cloth.top.shape)
    span = min(repeat * max(count // (2 * repeat), 1), count - 1)
    low, middle = (count - 1 - span) // 2, count // 2
    high = low + span
    rows: list[tuple[float, ...]] = []
    notes: list[str] = []
    for tension in tensions:
        patch.pull[grid[:, -1], axis] = tension * other.spacing
        if not settled(patch, f"{tension:g} N/m", notes, watch):
            break
        places = patch.state[: net.crossings]
        along = places[grid[middle, high], axis] - places[grid[middle, low], axis]
        across = places[grid[high, middle], 1 - axis] - places[grid[low, middle], 1 - axis]
        c = patch.state[net.crossings + grid[middle, middle], 2]
        rows.append(
            (
                tension,
                100.0 * (along / ((high - low) * own.spacing) - 1.0),
                100.0 * (across / ((high - low) * other.spacing) - 1.0),
                1e3 * (net.half_height + (c if axis == WARP else -c)),
                1e3 * float(patch.contact_forces()[grid[middle, middle]].mean()),
            )
        )
    name = ("warp", "weft")[axis]
    if rows:
        notes.insert(0, f"stiffness at {rows[0][0]:g} N/m: {100.0 * rows[0][0] / rows[0][1]:.4g} N/m")
    return Curve(
        f"{count} x {count} crossings pulled along the {name}",
        (
            "tension [N/m]", "strain along [%]", "strain across [%]", "wave of the pulled yarn [mm]",
            "force between yarns [mN]",
        ),
        tuple(rows), (1, 0), tuple(notes), patch, len(tensions),
    )  # fmt: skip


AXES = {"warp": WARP, "weft": WEFT}
"""Directions by their names."""
