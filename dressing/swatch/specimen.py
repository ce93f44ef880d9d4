"""Specimens: pieces of a weave as patches of crossings."""

import math

import numpy as np

from toile.dressing.weave.crossing import System
from toile.dressing.weave.woven import Woven
from toile.engine.swatch.equilibrium import Patch
from toile.engine.swatch.net import Strand, woven_net
from toile.geometry.arrays import Bool
from toile.geometry.errors import InputError

SQUEEZE = 1e6
"""Stiffness of yarns pressed together side by side [N/m^2]: 1 N/m of yarn gives by a micrometre."""
FEWEST, MOST = 4, 200
"""Crossings along a side of a specimen."""


def strands(cloth: Woven) -> tuple[Strand, Strand]:
    """Return what the yarns of a weave are, warp and weft."""
    warp, weft = (_strand(system) for system in cloth.systems)
    return warp, weft


def _strand(system: System) -> Strand:
    yarn = system.yarn
    return Strand(
        yarn.stiffness, yarn.bending, yarn.linear_density, yarn.width, system.spacing, system.wave, system.set
    )


def specimen(cloth: Woven, there: Bool, *, friction: float, flat: bool) -> Patch:
    """Return a piece of a weave at rest, whose places are free and whose yarns are fixed at their ends.

    Parameters
    ----------
    cloth
        The weave.
    there
        Which crossings it has, shape (ends, picks).
    friction
        Coefficient between its yarns. They slide through crossings if it is above zero: without friction a
        weave falls apart.
    flat
        Whether it stays in its plane.
    """
    if not (math.isfinite(friction) and 0.0 <= friction <= 2.0):
        raise InputError(f"friction between yarns is 0 to 2, got {friction:g}", field="friction")
    net, state = woven_net(cloth.top, there, strands(cloth), cloth.shear, SQUEEZE)
    free = np.ones_like(state, dtype=np.bool_)
    free[: net.crossings, 2] = not flat
    free[net.crossings :, :2] = ~net.yarn_ends() if friction > 0.0 else False
    return Patch(net, state, free, friction=friction)


def checked_count(count: int) -> int:
    """Return a number of crossings along a side. Raises InputError if a specimen would be none."""
    if not FEWEST <= count <= MOST:
        raise InputError(
            f"a swatch has {FEWEST} to {MOST} crossings along a side, got {count}", field="crossings"
        )
    return count
