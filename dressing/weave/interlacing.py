"""How warp and weft interlace: which one is on top at every crossing of a repeat."""

import math
from typing import NamedTuple

import numpy as np

from toile.geometry.arrays import Bool
from toile.geometry.errors import InputError


class Interlacing(NamedTuple):
    """What the waves of one system of yarns depend on.

    Attributes
    ----------
    changes
        How often a yarn changes sides, per crossing: 1 in plain weave.
    turns
        Sum of the squares of its turns over the square of its slope, per crossing: 4 in plain weave, where
        it turns by twice its slope at every crossing.
    """

    changes: float
    turns: float


def weave_named(name: str) -> Bool:
    """Return where the warp is on top, shape (warp ends, weft picks) of one repeat.

    Names are plain, twill (2/2), satin (of five), or A/B for a twill in which the warp goes over A picks
    and under B.
    """
    if name == "plain":
        return _diagonal(np.array([True, False]), 1)
    if name == "twill":
        return _diagonal(np.array([True, True, False, False]), 1)
    if name == "satin":
        return _diagonal(np.array([True, True, True, True, False]), 2)
    over, slash, under = name.partition("/")
    if slash and over.isdecimal() and under.isdecimal() and 1 <= int(over) <= 16 and 1 <= int(under) <= 16:
        return _diagonal(np.arange(int(over) + int(under)) < int(over), 1)
    raise InputError(f"a weave is plain, twill, satin, or such as 2/1; got '{name}'", field="weave")


def _diagonal(row: Bool, shift: int) -> Bool:
    """Return a repeat in which every warp end goes as the last one, shifted."""
    return np.array([np.roll(row, shift * i) for i in range(len(row))])


def checked_weave(top: Bool) -> Bool:
    """Return a matrix of a weave. Raises InputError where a yarn never changes sides."""
    top = np.asarray(top, bool)
    if top.ndim != 2 or min(top.shape) < 2:
        raise InputError("a weave needs a repeat of at least 2 x 2 crossings", field="weave")
    for axis, system in ((1, "warp"), (0, "weft")):
        if (top.all(axis=axis) | (~top).all(axis=axis)).any():
            raise InputError(
                f"a {system} yarn of this weave never changes sides: it would fall out", field="weave"
            )
    return top


def interlacings(top: Bool) -> tuple[Interlacing, Interlacing]:
    """Return those of warp and weft of a weave, means over its repeat."""
    return _interlacing(top), _interlacing(top.T)


def _interlacing(rows: Bool) -> Interlacing:
    side = np.where(rows, 1, -1)
    slope = (np.roll(side, -1, axis=1) - side) // 2
    turn = slope - np.roll(slope, 1, axis=1)
    return Interlacing(float(np.abs(slope).mean()), float((turn**2).mean()))


def locking_angle(width: float, spacing: float) -> float:
    """Return the shear angle [rad] at which yarns of a width [m] touch their neighbours, a spacing apart."""
    return math.acos(min(width / spacing, 1.0))
