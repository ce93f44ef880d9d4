"""A square in a frame whose sides turn: its yarns keep their length, until they touch their neighbours."""

import math

import numpy as np

from toile.dressing.swatch.curve import Curve, Watch, say_nothing, settled
from toile.dressing.swatch.specimen import checked_count, specimen
from toile.dressing.weave.woven import Woven

STEP = math.radians(2.0)
BEYOND = math.radians(3.0)
"""How far shear goes beyond the angle at which yarns touch."""
STEEPEST = math.radians(80.0)


def shear_in_frame(cloth: Woven, *, crossings: int = 12, watch: Watch = say_nothing) -> Curve:
    """Shear a square of so many crossings, past the angle at which its yarns touch."""
    count = checked_count(crossings)
    patch = specimen(cloth, np.ones((count, count), bool), friction=0.0, flat=True)
    net, rest = patch.net, patch.state[: patch.net.crossings].copy()
    grid = net.grid
    border = np.unique(np.concatenate([grid[0], grid[-1], grid[:, 0], grid[:, -1]]))
    patch.free[border] = False
    area = float(np.ptp(rest[:, 0]) * np.ptp(rest[:, 1]))
    last = min(cloth.locking + BEYOND, STEEPEST)
    inside = np.setdiff1d(np.arange(net.crossings), border)
    rows: list[tuple[float, ...]] = []
    notes = [f"yarns touch at {math.degrees(cloth.locking):.1f} degrees by their width"]
    angles = np.arange(STEP, last + 0.5 * STEP, STEP)
    for angle in angles:
        turned = np.column_stack([rest[:, 0] + rest[:, 1] * math.sin(angle), rest[:, 1] * math.cos(angle)])
        patch.state[border, :2] = turned[border]
        if not rows:
            patch.state[inside, :2] = turned[inside]
        if not settled(patch, f"{math.degrees(angle):.0f} degrees", notes, watch):
            break
        motion = np.column_stack([rest[:, 1] * math.cos(angle), -rest[:, 1] * math.sin(angle)])
        force = float((patch.reactions()[border, :2] * motion[border]).sum() / area)
        rows.append((math.degrees(angle), force, force / angle))
    return Curve(
        f"{count} x {count} crossings sheared in a frame",
        ("shear angle [deg]", "shear force [N/m]", "force over angle [N/m]"),
        tuple(rows), (0, 1), tuple(notes), patch, len(angles),
    )  # fmt: skip
