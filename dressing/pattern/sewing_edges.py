"""Edge lengths of the triangles in which a garment is sewn, before its mesh adapts."""

from typing import NamedTuple

SEWING_COARSENESS = 1.75, 2.0, 1.6, 2.25, 1.85
"""Edges in which a garment is sewn, in the finest ones, or in longer ones where those are below `SEWN`; the
next if seams jam. None makes many more triangles than the first: what decides is not how fine they are."""
SEWN = 0.024
"""Edges in which seams close as surely as in shorter ones, in two thirds of the time [m]."""
COARSEST_SEWN = 4.0
"""The same in finest edges at most: garments for dolls are small all over."""


class SewingEdges(NamedTuple):
    """Edge length of a garment that is sewn, and least length of the sides of its curved edges [m]."""

    length: float
    curves: float


def sewing_edges(finest: float, longest: float) -> list[SewingEdges]:
    """Return the edges to sew in, one after the other until seams close.

    `finest` and `longest` are the shortest and longest edges that the mesh takes on later [m].
    """
    base = max(finest, min(SEWN, COARSEST_SEWN * finest) / SEWING_COARSENESS[0])
    edges = [
        SewingEdges(min(factor * base, longest), min(factor * finest, longest))
        for factor in SEWING_COARSENESS
    ]
    return list(dict.fromkeys(edges))
