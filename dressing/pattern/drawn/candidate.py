"""A seam that pieces may have, and what edges have in common."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from toile.dressing.pattern.drawn.piece import MIRRORED, Piece
from toile.dressing.pattern.seam import EdgePart, Seam

LENGTH_TOLERANCE, LEAST_TOLERANCE = 0.01, 0.0015
"""How much the sides of a seam may differ: as a share, and at least [m]."""

EdgeKey = tuple[str, int]


@dataclass(frozen=True, eq=False)
class Walk:
    """A drawn edge walked along its drawn loop (way 1) or against it (-1), mirrored or not."""

    piece: Piece
    edge: int
    way: int
    mirrored: bool = False

    @property
    def key(self) -> EdgeKey:
        """The drawn edge."""
        return self.piece.name, self.edge

    def turned(self) -> "Walk":
        """Return the walk back."""
        return replace(self, way=-self.way)

    @property
    def with_loop(self) -> bool:
        """Whether the walk runs with the loop of the panel, which a mirror image turns around."""
        return (self.way > 0) != self.mirrored

    @property
    def part(self) -> EdgePart:
        """The same as a part of a seam."""
        part = EdgePart(self.piece.name + (MIRRORED if self.mirrored else ""), self.edge)
        return part if self.with_loop else part.turned()


@dataclass(frozen=True, eq=False)
class Candidate:
    """A seam that may be: its kind, its walks of both sides, and what about it is a choice, if anything."""

    kind: str
    walks: tuple[tuple[Walk, ...], tuple[Walk, ...]]
    doubt: str = ""

    @property
    def seam(self) -> Seam:
        """The seam, its left side walked with the loop."""
        a, b = self.walks
        return Seam(tuple(walk.part for walk in a), tuple(walk.part for walk in b))

    @property
    def edges(self) -> frozenset[EdgeKey]:
        """Every drawn edge that it takes."""
        return frozenset(walk.key for side in self.walks for walk in side)

    def turned(self) -> "Candidate":
        """Return the same seam walked from its other end."""
        a, b = (tuple(walk.turned() for walk in reversed(side)) for side in self.walks)
        return replace(self, walks=(a, b))

    def with_doubt(self, doubt: str) -> "Candidate":
        """Return it with what is open about it."""
        return replace(self, doubt=doubt)


def candidate_of(kind: str, a: Sequence[Walk], b: Sequence[Walk]) -> Candidate | None:
    """Return the seam of two walks, mirrored sides chosen so that right sides of the cloth face each other.

    The walks of `b` keep their sides relative to each other. None if that would need the mirrored side of a
    piece that has none.
    """
    for mirror_a, mirror_b in ((False, False), (False, True), (True, False), (True, True)):
        sides = _mirrored(a, mirror_a), _mirrored(b, mirror_b)
        walks = [walk for side in sides for walk in side]
        if any(walk.mirrored and not walk.piece.mirrors for walk in walks):
            continue
        if len({(walk.key, walk.mirrored) for walk in walks}) < len(walks):
            continue
        if all(walk.with_loop for walk in sides[0]) and not any(walk.with_loop for walk in sides[1]):
            return Candidate(kind, (tuple(sides[0]), tuple(sides[1])))
        if all(walk.with_loop for walk in sides[1]) and not any(walk.with_loop for walk in sides[0]):
            return Candidate(kind, (tuple(sides[0]), tuple(sides[1]))).turned()
    return None


def _mirrored(walks: Sequence[Walk], mirror: bool) -> list[Walk]:
    return [replace(walk, mirrored=walk.mirrored != mirror) for walk in walks]


def edges_alike(p: Piece, i: int, q: Piece, j: int) -> bool:
    """Tell whether two edges are of one length."""
    a, b = p.length(i), q.length(j)
    return abs(a - b) <= max(LENGTH_TOLERANCE * max(a, b), LEAST_TOLERANCE)


def neighbour(piece: Piece, edge: int, step: int) -> int:
    """Return the edge before (-1) or after (1) another."""
    return (edge + step) % len(piece.edges)


def meets_fold(piece: Piece, edge: int) -> bool:
    """Tell whether an edge ends on the fold."""
    return piece.fold in (neighbour(piece, edge, -1), neighbour(piece, edge, 1))


def is_central(piece: Piece, edge: int) -> bool:
    """Tell whether a whole piece is symmetric about the middle of an edge, by the lengths of all others."""
    if piece.fold is not None:
        return False
    count = len(piece.edges)
    return all(
        edges_alike(piece, (edge - step) % count, piece, (edge + step) % count)
        for step in range(1, count // 2 + 1)
    )


def turn_after(piece: Piece, edge: int) -> float:
    """Return the turn of the outline at the end of an edge [rad], to the left positive."""
    a, b = piece.edges[edge], piece.edges[neighbour(piece, edge, 1)]
    back, ahead = a[-1] - a[-2], b[1] - b[0]
    return float(np.arctan2(back[0] * ahead[1] - back[1] * ahead[0], back @ ahead))
