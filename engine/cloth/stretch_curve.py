"""Tension of a thread direction over its strain, as a table of cubics for the kernels of the membrane.

A row of a table is one piece: the strain where it begins, energy [J/m^2] and tension [N/m] there, and the
coefficients of s, s^2, s^3 that tension gains at s beyond it. Tension is continuous with its slope and never
falls, so that the energy is convex and twice differentiable. The last piece is a straight line without end;
in compression the slope at zero holds.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from toile.geometry.arrays import Float

LOCKED = 20.0
"""Stiffness of cloth that has locked, as a multiple of that of its first stretch."""
FREE = 0.5
"""Share of the strain limit up to which it stretches as if there were none."""
SLACKEST = 0.2
"""Least slope at zero, as a share of that to the first point: no curve begins without stiffness."""


def straight(stiffness: float) -> Float:
    """Return the table of tension in proportion to strain, shape (1, 6)."""
    return np.array([[0.0, 0.0, 0.0, stiffness, 0.0, 0.0]])


def limited(stiffness: float, limit: float) -> Float:
    """Return the table of cloth of a stiffness [N/m] that locks at a strain, shape (3, 6).

    From half the limit on the slope rises with the square of the strain, to `LOCKED` times the stiffness.
    """
    begin = FREE * limit
    way = limit - begin
    third = stiffness * (LOCKED - 1.0) / (3.0 * way * way)
    return _with_energies(
        [0.0, begin, limit],
        [0.0, stiffness * begin, stiffness * limit + third * way**3],
        [[stiffness, 0.0, 0.0], [stiffness, 0.0, third], [LOCKED * stiffness, 0.0, 0.0]],
    )


def through(points: Sequence[Sequence[float]]) -> Float:
    """Return the table of the curve from zero through points (strain, tension [N/m]), shape (k + 1, 6).

    Both must rise from point to point. Between points it is the monotone cubic of Fritsch and Carlson (1980),
    with the slopes of Fritsch and Butland (1984): weighted harmonic means of those of the pieces beside.
    """
    strain, tension = np.concatenate(([[0.0, 0.0]], np.asarray(points, np.float64))).T
    width = np.diff(strain)
    secant = np.diff(tension) / width
    slope = np.empty(len(strain))
    before, after = width[:-1] + 2.0 * width[1:], 2.0 * width[:-1] + width[1:]
    slope[1:-1] = (before + after) / (before / secant[:-1] + after / secant[1:])
    if len(secant) == 1:
        slope[:] = secant[0]
    else:
        slope[0] = np.clip(1.5 * secant[0] - 0.5 * slope[1], SLACKEST * secant[0], 3.0 * secant[0])
        slope[-1] = np.clip(1.5 * secant[-1] - 0.5 * slope[-2], SLACKEST * secant[-1], 3.0 * secant[-1])
    second = (3.0 * secant - 2.0 * slope[:-1] - slope[1:]) / width
    third = (slope[:-1] + slope[1:] - 2.0 * secant) / width**2
    cubics = np.column_stack((slope[:-1], second, third))
    return _with_energies(strain, tension, [*cubics, [slope[-1], 0.0, 0.0]])


def _with_energies(
    strain: Sequence[float] | Float,
    tension: Sequence[float] | Float,
    cubics: Sequence[Sequence[float] | Float],
) -> Float:
    """Return the table of pieces, their energies added up."""
    rows = np.column_stack((strain, np.zeros(len(strain)), tension, np.asarray(cubics)))
    for before, row in pairwise(rows):
        s = row[0] - before[0]
        row[1] = before[1] + s * (before[2] + s * (before[3] / 2 + s * (before[4] / 3 + s * before[5] / 4)))
    return rows


def tension_at(table: Float, strain: float) -> float:
    """Return the tension [N/m] of a table at a strain; below zero that of its first slope."""
    row = table[max(int(np.searchsorted(table[:, 0], strain, "right")) - 1, 0)]
    s = strain - row[0]
    if strain < 0.0:
        return float(row[3] * s)
    return float(row[2] + s * (row[3] + s * (row[4] + s * row[5])))
