"""A strip of four warp yarns held level at one end: it bends under its weight."""

import numpy as np

from toile.dressing.swatch.curve import Curve, Watch, say_nothing, settled
from toile.dressing.swatch.specimen import checked_count, specimen
from toile.dressing.weave.woven import Woven

GRAVITY = 9.81
STEPS = 10
ENDS = 4


def bend_cantilever(
    cloth: Woven, *, crossings: int = 41, weight: float = 1.0, watch: Watch = say_nothing
) -> Curve:
    """Let a strip with so many crossings hang over, its weight rising to so many times its own."""
    count = checked_count(crossings)
    patch = specimen(cloth, np.ones((ENDS, count), bool), friction=0.0, flat=False)
    net = patch.net
    patch.free[net.grid[:, :2].ravel()] = False
    warp = net.strands[0]
    # The yarn is clamped from its first crossing to its second and free to turn from half a piece beyond.
    overhang = (count - 1.5) * warp.spacing
    clamp = 0.5 * warp.spacing
    per_spacing = sum(
        lines * system.yarn.linear_density * system.length
        for lines, system in zip((ENDS, ENDS - 1), cloth.systems, strict=True)
    )
    per_area = per_spacing * GRAVITY * weight / (ENDS * net.strands[1].spacing * warp.spacing)
    predicted = cloth.warp.bending
    notes = [
        f"by its yarns its bending rigidity is {1e6 * predicted:.3g} uN m: "
        f"weight per area times length cubed over it is {per_area * overhang**3 / predicted:.3g}"
    ]
    rows: list[tuple[float, ...]] = []
    for step in range(1, STEPS + 1):
        patch.gravity = np.array([0.0, 0.0, -GRAVITY * weight * step / STEPS])
        if not settled(patch, f"{step} of {STEPS}", notes, watch):
            break
        tip = patch.state[net.grid[1, -1]]
        drop, reach = -float(tip[2]), float(tip[0]) - clamp
        rows.append((per_area * step / STEPS, 1e3 * drop, 1e3 * reach, drop / reach))
    return Curve(
        f"a strip of {ENDS} warp yarns, {1e3 * overhang:.1f} mm free, under its weight",
        ("weight per area [N/m2]", "drop [mm]", "reach [mm]", "drop over reach"), tuple(rows), (0, 3),
        tuple(notes), patch, STEPS,
    )  # fmt: skip
