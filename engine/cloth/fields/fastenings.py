"""Rows of points of cloth that are fastened to each other: buttons in their holes, snaps, hooks, zips."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from toile.engine.cloth.fields.keyed import Keyed, later, value_at
from toile.geometry.arrays import Float, Int


@dataclass(frozen=True, kw_only=True)
class Fastening:
    """A row of pairs of points, in the order in which it closes.

    It is kept as points in rest space: which faces they lie in can be told on every mesh.

    Attributes
    ----------
    over, under
        Garment and panel of the two sides.
    over_points, under_points
        Points of the two sides in rest space [m], shape (k, 3).
    side
        1 where `over` lies on the right side of `under`, -1 where on its wrong side; 0: points are drawn
        together from any direction.
    distance
        How far the points are apart when fastened [m]: along the normal of `under`, or, if `side` is 0, at
        most.
    stiffness
        Force per distance from there of every pair [N/m], shape (k,).
    most
        Largest force of every pair [N], shape (k,): beyond it gives way.
    closed
        Share of the row that is closed, from its first pair on.
    """

    over: tuple[int, int]
    under: tuple[int, int]
    over_points: Float
    under_points: Float
    side: int
    distance: float
    stiffness: Float
    most: Float
    closed: float | Keyed

    def of_garment(self, number: int) -> "Fastening":
        """Return the row with both sides in a garment of that number."""
        return replace(self, over=(number, self.over[1]), under=(number, self.under[1]))

    def later(self, seconds: float) -> "Fastening":
        """Return the row in a film whose frame 0 is at a time [s]."""
        return replace(self, closed=later(self.closed, seconds))

    def acting(self, seconds: float) -> Float:
        """Return how much of every pair's stiffness acts at a time [s], shape (k,): pair by pair."""
        count = len(self.over_points)
        return np.clip(value_at(self.closed, seconds) * count - np.arange(count), 0.0, 1.0)


class FoundPoints(NamedTuple):
    """Points on a mesh: face, shape (k,), and weights of its corners, shape (k, 3)."""

    face: Int
    weights: Float


def found_points(points: Float, chosen: Int, corners: Float) -> FoundPoints:
    """Return where points in rest space [m], shape (k, 3), lie on a mesh.

    `chosen` are the faces to look in, shape (c,), `corners` all corners in rest space [m], shape (t, 3, 3).
    A point that rounding has put beside them is taken to the nearest.
    """
    a = corners[chosen, 0]
    sides = corners[chosen, 1:] - a[:, None]
    gram = np.einsum("cai,cbi->cab", sides, sides)
    face = np.empty(len(points), np.int32)
    weights = np.empty((len(points), 3))
    for number, point in enumerate(points):
        share = np.linalg.solve(gram, np.einsum("cai,ci->ca", sides, point - a)[..., None])[..., 0]
        all_three = np.column_stack([1.0 - share.sum(axis=1), share])
        clipped = np.maximum(all_three, 0.0)
        clipped /= clipped.sum(axis=1, keepdims=True)
        there = np.einsum("cq,cqi->ci", clipped, corners[chosen])
        best = int(np.linalg.norm(there - point, axis=1).argmin())
        face[number], weights[number] = chosen[best], clipped[best]
    return FoundPoints(face, weights)
