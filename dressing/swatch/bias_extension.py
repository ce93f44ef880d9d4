"""A strip cut at 45 degrees and pulled: yarns turn in the cloth and hardly stretch."""

import math

import numpy as np

from toile.dressing.swatch.curve import Curve, Watch, say_nothing, settled
from toile.dressing.swatch.specimen import checked_count, specimen
from toile.dressing.weave.woven import Woven
from toile.engine.swatch.corner import shear_terms
from toile.geometry.arrays import Bool, Float

SLENDER = 3.0
"""Height over width."""
STEPS = 10


def pull_on_bias(
    cloth: Woven,
    *,
    crossings: int = 24,
    friction: float = 0.0,
    elongation: float = 0.1,
    watch: Watch = say_nothing,
) -> Curve:
    """Pull a strip, as wide as so many spacings and three times as high, by a share of height less width."""
    count = checked_count(crossings)
    spacing = math.sqrt(cloth.systems[0].spacing * cloth.systems[1].spacing)
    width, height = count * spacing, SLENDER * count * spacing
    along, across, there = _cut(cloth, width, height)
    patch = specimen(cloth, there, friction=friction, flat=True)
    net, rest = patch.net, patch.state[: patch.net.crossings].copy()
    along, across = along[there], across[there]
    ends = np.abs(along) > np.abs(along).max() - 0.5 * spacing
    patch.free[: net.crossings][ends] = False
    direction = np.array([1.0, 1.0, 0.0]) / math.sqrt(2.0)
    high, wide = float(np.ptp(along)), float(np.ptp(across))
    rows: list[tuple[float, ...]] = []
    notes: list[str] = []
    for step in range(1, STEPS + 1):
        lift = step / STEPS * elongation * (high - wide)
        patch.state[: net.crossings][ends] = (
            rest[ends] + np.sign(along[ends])[:, None] * direction * lift / 2.0
        )
        if step == 1:
            inside = ~ends
            share = (along[inside] / (high / 2.0))[:, None]
            patch.state[: net.crossings][inside] += share * direction * lift / 2.0
        if not settled(patch, f"{100.0 * lift / high:.1f} %", notes, watch):
            break
        pulled = patch.reactions()[: net.crossings][ends & (along > 0.0)] @ direction
        middle = np.isin(net.corners[:, 0], np.flatnonzero(np.hypot(along, across) < 2.0 * spacing))
        sheared = shear_terms(net, patch.state).energy[middle]
        stiffness = 0.25 * net.shear * net.strands[0].spacing * net.strands[1].spacing
        angle = math.degrees(float(np.sqrt(2.0 * sheared / stiffness).mean()))
        rows.append((100.0 * lift / high, float(pulled.sum()) / wide, angle, patch.stored()))
        share_of_zones = patch.stored() / three_zones(net.shear, wide, high, lift)
    if rows:
        notes.insert(0, f"energy over that of three zones: {share_of_zones:.3f}")
    return Curve(
        f"a strip of {1e3 * wide:.1f} x {1e3 * high:.1f} mm pulled at 45 degrees",
        ("elongation [%]", "force per width [N/m]", "shear angle in the middle [deg]", "energy [J]"),
        tuple(rows), (0, 1), tuple(notes), patch, STEPS,
    )  # fmt: skip


def three_zones(shear: float, width: float, height: float, lift: float) -> float:
    """Return the energy of the zones that textbooks assume: full shear, half of it, none [J]."""
    angle = math.pi / 2.0 - 2.0 * math.acos((1.0 + lift / (height - width)) / math.sqrt(2.0))
    return 0.5 * shear * (width * (height - 1.5 * width) * angle**2 + width**2 * (angle / 2.0) ** 2)


def _cut(cloth: Woven, width: float, height: float) -> tuple[Float, Float, Bool]:
    """Return places of a grid of crossings along and across the strip [m], and which of them it has."""
    warp, weft = (system.spacing for system in cloth.systems)
    reach = (width + height) / math.sqrt(2.0)
    ends, picks = math.ceil(reach / weft) + 2, math.ceil(reach / warp) + 2
    y = (np.arange(ends) - (ends - 1) / 2.0)[:, None] * weft
    x = (np.arange(picks) - (picks - 1) / 2.0)[None, :] * warp
    along, across = (x + y) / math.sqrt(2.0), (x - y) / math.sqrt(2.0)
    there = (np.abs(along) <= height / 2.0 + 1e-9) & (np.abs(across) <= width / 2.0 + 1e-9)
    return along, across, there
