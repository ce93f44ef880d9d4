"""A patch of crossing yarns: which crossings follow each other along which yarn, and what the yarns are.

A crossing has six numbers: its place x, the lengths u and v of warp and weft that lie between it and the
beginning of their yarns, at rest, and the share c of the wave: the warp rises by D + c between crossings, the
weft by D - c. They are two nodes of three numbers: nodes 0 to n - 1 are places, n to 2 n - 1 are (u, v, c).
"""

from typing import NamedTuple

import numpy as np

from toile.geometry.arrays import Bool, Float, Int

WARP, WEFT = 0, 1
SIDES = (1.0, -1.0)
"""How the wave heights of warp and weft go with c."""


class Strand(NamedTuple):
    """What the yarns of one direction are.

    Attributes
    ----------
    stiffness, bending
        Axial [N] and bending stiffness [N m^2].
    linear_density
        [kg/m].
    width
        In the plane of the cloth [m].
    spacing
        Distance of the crossings along it [m].
    wave
        How high it rises from one side to the other at rest [m].
    set
        Share of its turns that it keeps without load.
    """

    stiffness: float
    bending: float
    linear_density: float
    width: float
    spacing: float
    wave: float
    set: float

    @property
    def slope(self) -> float:
        """Slope of the yarn at rest where it changes sides [rad]."""
        return float(np.arctan2(self.wave, self.spacing))


class Net(NamedTuple):
    """A patch of yarns.

    Attributes
    ----------
    crossings
        Number of crossings n.
    strands
        Yarns of warp and weft.
    shear
        Stiffness against shear without friction [N/m].
    squeeze
        Stiffness of yarns pressed together side by side [N/m^2].
    grid
        Crossing of every warp and weft yarn, -1 where there is none, shape (ends, picks).
    pieces
        Crossings a, b that follow each other along a yarn, shape (P, 2).
    piece_axis, piece_rises
        Whether each is of warp (0) or weft (1), and whether it changes sides, shape (P,).
    bends
        Crossings a, b, c that follow each other along a yarn, shape (B, 3).
    bend_axis, bend_rises
        As for pieces, shapes (B,) and (B, 2): the piece before b and the one behind it.
    corners
        A crossing, one that follows or precedes it along the warp, one along the weft, shape (C, 3).
    """

    crossings: int
    strands: tuple[Strand, Strand]
    shear: float
    squeeze: float
    grid: Int
    pieces: Int
    piece_axis: Int
    piece_rises: Bool
    bends: Int
    bend_axis: Int
    bend_rises: Bool
    corners: Int

    @property
    def half_height(self) -> float:
        """Distance D of the centre lines of two yarns that cross [m]."""
        return 0.5 * (self.strands[WARP].wave + self.strands[WEFT].wave)

    def of_axis(self, name: str, axis: Int) -> Float:
        """Return a number of the yarns' per piece or bend, shape like `axis`."""
        return np.array([getattr(strand, name) for strand in self.strands])[axis]

    def yarn_ends(self) -> Bool:
        """Return which crossings are the first or last of their warp, of their weft yarn, shape (n, 2)."""
        met = np.zeros((self.crossings, 2), np.int32)
        for k in (0, 1):
            np.add.at(met, (self.pieces[:, k], self.piece_axis), 1)
        return met < 2

    def slide(self, crossings: Int) -> Int:
        """Return the nodes of (u, v, c) of crossings."""
        return crossings + np.int32(self.crossings)


def woven_net(
    top: Bool, there: Bool, strands: tuple[Strand, Strand], shear: float, squeeze: float
) -> tuple[Net, Float]:
    """Return a piece of a weave at rest in the plane z = 0, and its six numbers, shape (2 n, 3).

    top: where the warp is on top, shape (ends, picks) of one repeat. there: which crossings of a grid the
    piece has, shape (ends, picks). Warp yarn i runs along x at y = i p_v, weft yarn j along y at x = j p_u.
    """
    ends, picks = there.shape
    index = np.where(there, np.cumsum(there).reshape(there.shape) - 1, -1).astype(np.int32)
    over = top[np.ix_(np.arange(ends) % top.shape[0], np.arange(picks) % top.shape[1])]
    lines, sides = (index, index.T), (over, over.T)
    runs = [_runs(line, 2) for line in lines]
    bend_runs = [_runs(line, 3) for line in lines]
    rises = [side[:, :-1] != side[:, 1:] for side in sides]
    net = Net(
        int(there.sum()), strands, shear, squeeze, index,
        np.concatenate([run for run, _ in runs]), _axis([run for run, _ in runs]),
        np.concatenate([rise[whole] for rise, (_, whole) in zip(rises, runs, strict=True)]),
        np.concatenate([run for run, _ in bend_runs]), _axis([run for run, _ in bend_runs]),
        np.concatenate(
            [
                np.stack([rise[:, :-1][whole], rise[:, 1:][whole]], 1)
                for rise, (_, whole) in zip(rises, bend_runs, strict=True)
            ]
        ),
        _corners(index),
    )  # fmt: skip
    state = np.zeros((2 * net.crossings, 3))
    i, j = np.nonzero(there)
    warp, weft = strands
    state[: net.crossings, 0], state[: net.crossings, 1] = j * warp.spacing, i * weft.spacing
    for axis, (strand, rise) in enumerate(zip(strands, rises, strict=True)):
        step = np.where(rise, np.hypot(strand.spacing, strand.wave), strand.spacing)
        along = np.concatenate([np.zeros((len(rise), 1)), np.cumsum(step, axis=1)], axis=1)
        state[net.crossings :, axis] = (along if axis == WARP else along.T)[i, j]
    state[net.crossings :, 2] = 0.5 * (warp.wave - weft.wave)
    return net, state


def _runs(line: Int, length: int) -> tuple[Int, Bool]:
    """Return crossings that follow each other along rows, shape (k, length), and where they begin there."""
    parts = [line[:, k : line.shape[1] - length + 1 + k] for k in range(length)]
    whole = np.logical_and.reduce([part >= 0 for part in parts])
    return np.stack([part[whole] for part in parts], axis=1), whole


def _axis(parts: list[Int]) -> Int:
    return np.repeat(np.arange(2, dtype=np.int32), [len(part) for part in parts])


def _corners(index: Int) -> Int:
    """Return all corners: a crossing, the one behind or before it along the warp, and along the weft."""
    padded = np.pad(index, 1, constant_values=-1)
    found = []
    for along in (1, -1):
        for across in (1, -1):
            warp = np.roll(padded, -along, axis=1)[1:-1, 1:-1]
            weft = np.roll(padded, -across, axis=0)[1:-1, 1:-1]
            whole = (index >= 0) & (warp >= 0) & (weft >= 0)
            found.append(np.stack([index[whole], warp[whole], weft[whole]], 1))
    return np.concatenate(found)
