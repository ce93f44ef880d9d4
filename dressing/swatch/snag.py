"""A crossing caught and pulled out of the cloth: its yarns are drawn in from both sides."""

import numpy as np

from toile.dressing.swatch.curve import Curve, Watch, say_nothing, settled
from toile.dressing.swatch.specimen import checked_count, specimen
from toile.dressing.weave.woven import Woven

STEPS = 10


def snag(
    cloth: Woven,
    *,
    crossings: int = 15,
    friction: float = 0.3,
    lift: float = 1.0,
    watch: Watch = say_nothing,
) -> Curve:
    """Pull the middle crossing of a square held at its corners out of its plane, by so many spacings."""
    count = checked_count(crossings)
    patch = specimen(cloth, np.ones((count, count), bool), friction=friction, flat=False)
    net = patch.net
    corners = net.grid[[0, 0, -1, -1], [0, -1, 0, -1]]
    patch.free[corners] = False
    middle = net.grid[count // 2, count // 2]
    patch.free[middle] = False
    before = patch.state[net.crossings :, :2].copy()
    spacing = min(strand.spacing for strand in net.strands)
    rows: list[tuple[float, ...]] = []
    notes: list[str] = []
    for step in range(1, STEPS + 1):
        height = lift * spacing * step / STEPS
        patch.state[middle, 2] = height
        if not settled(patch, f"{1e3 * height:.2f} mm", notes, watch):
            break
        slid = float(np.abs(patch.state[net.crossings :, :2] - before).max())
        rows.append((1e3 * height, 1e3 * float(patch.reactions()[middle, 2]), 1e6 * slid))
    return Curve(
        f"a crossing pulled out of {count} x {count}",
        ("lift [mm]", "force [mN]", "yarn drawn through a crossing [um]"),
        tuple(rows), (0, 1), tuple(notes), patch, STEPS,
    )  # fmt: skip
