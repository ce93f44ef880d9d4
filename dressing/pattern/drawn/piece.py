"""A piece of a pattern as it is drawn: half if it is cut on the fold, once if it is cut as a pair."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from toile.dressing.pattern.pattern_outline import signed_area
from toile.dressing.pattern.seam import Seam
from toile.geometry.arrays import Float

MIRRORED = "~"
"""What follows the name of a piece where its mirrored half or its mirrored twin is meant."""


class Notch(NamedTuple):
    """A mark that seams match: its edge, its distance from the edge's start [m], whether it is a back's."""

    edge: int
    along: float
    back: bool = False


@dataclass(frozen=True, kw_only=True)
class Piece:
    """One piece.

    Attributes
    ----------
    name
        Unique in its pattern.
    edges
        One polyline [m] per edge, shape (p, 2), y up: a closed loop, counter-clockwise, the right side of the
        fabric towards the reader.
    fold
        Number of the edge that lies on the fold, or None.
    pair
        Whether it is cut twice, the second time mirrored.
    notches
        Marks to be matched.
    warp_degrees
        Direction of the grain line, counter-clockwise from +y.
    words
        What the file says about it: its name, category and annotations.
    lines, holes
        Lines inside, and outlines cut out of it [m]; they are shown, not sewn or cut.
    """

    name: str
    edges: tuple[Float, ...]
    fold: int | None = None
    pair: bool = False
    notches: tuple[Notch, ...] = ()
    warp_degrees: float = 0.0
    words: str = ""
    lines: tuple[Float, ...] = ()
    holes: tuple[Float, ...] = ()

    @property
    def outline(self) -> Float:
        """The whole loop [m], shape (n, 2), the first point not repeated."""
        return np.concatenate([edge[:-1] for edge in self.edges])

    @property
    def area(self) -> float:
        """Area as drawn [m^2]."""
        return signed_area(self.outline)

    @property
    def mirrors(self) -> bool:
        """Whether there is a mirrored half or twin beside what is drawn."""
        return self.pair or self.fold is not None

    def length(self, edge: int) -> float:
        """Length of an edge [m]."""
        return polyline_length(self.edges[edge])


@dataclass(frozen=True, kw_only=True)
class DrawnPattern:
    """Pieces of one garment, and the seams that are known, of pieces as drawn or mirrored (`MIRRORED`).

    `seams` is None while nobody has said what is sewn.
    """

    name: str
    pieces: tuple[Piece, ...]
    seams: tuple[Seam, ...] | None = None
    notes: tuple[str, ...] = ()


def polyline_length(points: Float) -> float:
    """Length [m] of a polyline."""
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
