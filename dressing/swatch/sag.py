"""A square that hangs by its four corners, which come nearer to each other."""

import numpy as np

from toile.dressing.swatch.cantilever import GRAVITY
from toile.dressing.swatch.curve import Curve, Watch, say_nothing, settled
from toile.dressing.swatch.specimen import checked_count, specimen
from toile.dressing.weave.woven import Woven

STEPS = 15
FIRST_SAG = 0.02
"""Depth of the bowl that the first equilibrium is sought from, as a share of the side."""


def let_sag(
    cloth: Woven, *, crossings: int = 20, drawn_in: float = 0.15, watch: Watch = say_nothing
) -> Curve:
    """Draw the corners of a square in by a share of its side, and let it sag."""
    count = checked_count(crossings)
    patch = specimen(cloth, np.ones((count, count), bool), friction=0.0, flat=False)
    net, rest = patch.net, patch.state[: patch.net.crossings].copy()
    corners = net.grid[[0, 0, -1, -1], [0, -1, 0, -1]]
    patch.free[corners] = False
    patch.gravity = np.array([0.0, 0.0, -GRAVITY])
    sides = np.ptp(rest, axis=0)[:2]
    bowl = np.prod(np.sin(np.pi * rest[:, :2] / sides), axis=1)
    patch.state[: net.crossings, 2] = -FIRST_SAG * sides.min() * bowl
    rows: list[tuple[float, ...]] = []
    notes: list[str] = []
    for step in range(1, STEPS + 1):
        share = drawn_in * step / STEPS
        patch.state[corners, :2] = sides / 2.0 + (rest[corners, :2] - sides / 2.0) * (1.0 - share)
        if not settled(patch, f"{100.0 * share:.0f} %", notes, watch):
            break
        rows.append((100.0 * share, -1e3 * float(patch.state[: net.crossings, 2].min())))
    return Curve(
        f"{count} x {count} crossings on four corners",
        ("drawn in [%]", "sag [mm]"),
        tuple(rows),
        (0, 1),
        tuple(notes),
        patch,
        STEPS,
    )
