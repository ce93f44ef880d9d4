"""Edges as long as several others together: a sleeve cap and its armhole, a waistband and a skirt."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from toile.dressing.pattern.drawn.candidate import (
    Candidate,
    EdgeKey,
    Walk,
    candidate_of,
    meets_fold,
    neighbour,
)
from toile.dressing.pattern.drawn.piece import Piece
from toile.dressing.pattern.drawn.place import place_by_words
from toile.geometry.arrays import Float

CAP_EASE = 0.10
"""How much a sleeve cap may differ from its armhole."""
SUM_TOLERANCE = 0.01
CURVED = 1.03
"""Length over chord of a crotch seam, at least."""
CLEARLY_LONGER = 1.5
"""Side seam over shoulder seam from which it is clear which is which."""
ALIKE = 0.003
"""Shapes and notches that differ by less are no evidence [m]."""
LEAST = 0.015
"""Shorter edges are not sewn by length [m]."""


@dataclass(frozen=True, eq=False)
class _Chain:
    """Edges of several pieces one after the other, and how long the seams are at whose ends they meet [m]."""

    walks: tuple[Walk, ...]
    joints: tuple[float, ...]

    @property
    def length(self) -> float:
        return sum(walk.piece.length(walk.edge) for walk in self.walks)

    def followed_by(self, other: "_Chain") -> "_Chain | None":
        """Return both as one, if the last edge of this is the first of the other and no other is in both."""
        last, first = self.walks[-1], other.walks[0]
        walks = (*self.walks, *other.walks[1:])
        if (last.key, last.way) != (first.key, first.way) or len({w.key for w in walks}) < len(walks):
            return None
        return _Chain(walks, (*self.joints, *other.joints))


def _chains(pairs: Sequence[Candidate], legs: Mapping[EdgeKey, int]) -> list[_Chain]:
    """Return runs of edges of two or three pieces that other seams join at their corners."""
    chains = []
    for pair in pairs:
        (a,), _ = pair.walks
        for into, out in _beside(pair):
            walks = (*_past_darts(into, -1, legs), *_past_darts(out, 1, legs))
            chains.append(_Chain(walks, (a.piece.length(a.edge),)))
    longer = [first.followed_by(second) for first in chains for second in chains]
    return chains + [chain for chain in longer if chain is not None]


def summed_edges(
    pieces: Sequence[Piece], pairs: Sequence[Candidate], legs: Mapping[EdgeKey, int]
) -> list[Candidate]:
    """Return edges as long as two or three others together, which other seams join at their corners."""
    chains = _chains(pairs, legs)
    found: list[Candidate] = []
    for target in pieces:
        for edge in free_edges(target):
            fitting: dict[frozenset[EdgeKey], list[_Chain]] = {}
            for chain in chains:
                if _fits(target, edge, chain):
                    fitting.setdefault(frozenset(walk.key for walk in chain.walks), []).append(chain)
            found += [c for same in fitting.values() if (c := _joined_best(target, edge, same)) is not None]
    # Three beat two of them: a yoke between front and back.
    return [c for c in found if not any(c.edges < other.edges for other in found)]


def _fits(target: Piece, edge: int, chain: _Chain) -> bool:
    """Tell whether an edge is as long as a chain of others and ends on the fold if that does."""
    walks = chain.walks
    if any(walk.piece is target for walk in walks):
        return False
    ends_folded = any(meets_fold(walk.piece, walk.edge) for walk in (walks[0], walks[-1]))
    is_cap = place_by_words(target.words) == "sleeve" and curvature(Walk(target, edge, 1)) > CURVED
    off = abs(chain.length - target.length(edge)) / target.length(edge)
    return ends_folded == meets_fold(target, edge) and off < (CAP_EASE if is_cap else SUM_TOLERANCE)


def _joined_best(target: Piece, edge: int, chains: Sequence[_Chain]) -> Candidate | None:
    """Return the seam of an edge to edges that may be joined at either end.

    Those of an armhole meet at shoulder and side: the ends of a cap go to the longer of these seams.
    """
    options = [(chain, c) for chain in chains if (c := _sum(target, edge, list(chain.walks))) is not None]
    if not options:
        return None
    options.sort(key=lambda option: max(option[0].joints))
    (_, candidate), shortest = options[0], max(options[0][0].joints)
    joints = [
        max(chain.joints) for chain, _ in options if not np.isclose(max(chain.joints), shortest, rtol=0.02)
    ]
    if joints and min(joints) < CLEARLY_LONGER * shortest and not candidate.doubt:
        return candidate.with_doubt("its ends may lie at the other end of these edges")
    return candidate


def _beside(pair: Candidate) -> list[tuple[Walk, Walk]]:
    """Return walks from one piece into the other past the ends of a seam, along the edges beside it."""
    (a,), (b,) = pair.walks
    chains = []
    for end in (-1, 1):
        first, second = neighbour(a.piece, a.edge, end), neighbour(b.piece, b.edge, end * b.way)
        if first == a.piece.fold or second == b.piece.fold:
            continue
        # Towards the corner where the seam ends, then away from it on the other piece.
        into = Walk(a.piece, first, -end, a.mirrored)
        out = Walk(b.piece, second, end * b.way, b.mirrored)
        chains.append((into, out))
        chains.append((out.turned(), into.turned()))
    return chains


def _sum(target: Piece, edge: int, chain: list[Walk]) -> Candidate | None:
    """Return the seam of an edge to a chain of others, in the direction that notches ask for."""
    way = _way_along(target, edge, chain)
    doubt = ""
    if way == 0:
        front_first = place_by_words(chain[0].piece.words) != "back"
        way = 1 if front_first else -1
        if _asymmetry(target.edges[edge]) > ALIKE:
            doubt = "which end of it is the front is a guess: its notches do not say"
    if way < 0:
        chain = [walk.turned() for walk in reversed(chain)]
    found = candidate_of("sum", [Walk(target, edge, 1)], chain)
    return None if found is None else found.with_doubt(doubt)


def _way_along(target: Piece, edge: int, chain: list[Walk]) -> int:
    """Return in which direction an edge's notches match those of a chain; 0 if they do not say."""
    walked = 0.0
    theirs: list[tuple[float, bool]] = []
    for walk in chain:
        length = walk.piece.length(walk.edge)
        for notch in walk.piece.notches:
            if notch.edge == walk.edge:
                theirs.append((walked + (notch.along if walk.way > 0 else length - notch.along), notch.back))
        walked += length
    ours = [(notch.along, notch.back) for notch in target.notches if notch.edge == edge]
    if not ours or len(ours) != len(theirs):
        return 0
    scale = target.length(edge) / walked
    wanted = sorted((along * scale, back) for along, back in theirs)
    forwards, back = (
        max(
            abs(a - b) + (kind_a != kind_b)
            for (a, kind_a), (b, kind_b) in zip(sorted(way), wanted, strict=True)
        )
        for way in (ours, [(target.length(edge) - along, kind) for along, kind in ours])
    )
    return 0 if abs(forwards - back) < ALIKE else (1 if forwards < back else -1)


def _asymmetry(edge: Float) -> float:
    """Return how far an edge is from its own mirror image [m]."""
    walked = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(edge, axis=0), axis=1))])
    at = np.linspace(0.0, walked[-1], 65)
    points = np.column_stack([np.interp(at, walked, edge[:, axis]) for axis in (0, 1)])
    chord = points[-1] - points[0]
    along = (points - points[0]) @ chord / np.linalg.norm(chord)
    off = (points - points[0]) @ np.array([-chord[1], chord[0]]) / np.linalg.norm(chord)
    return float(max(np.abs(off - off[::-1]).max(), np.abs(along + along[::-1] - along[-1]).max()))


def _past_darts(walk: Walk, step: int, legs: Mapping[EdgeKey, int]) -> list[Walk]:
    """Return a walk and what follows it (step 1) or comes before it (-1) once darts are closed."""
    found = [walk]
    while True:
        edge = neighbour(walk.piece, found[-1].edge, step * walk.way)
        if (walk.piece.name, edge) not in legs:
            return found if step > 0 else found[::-1]
        beyond = neighbour(walk.piece, edge, 2 * step * walk.way)
        found.append(Walk(walk.piece, beyond, walk.way, walk.mirrored))


def free_edges(piece: Piece) -> list[int]:
    """Return the edges that may be sewn: off the fold, and not too short to tell by length."""
    return [n for n in range(len(piece.edges)) if n != piece.fold and piece.length(n) > LEAST]


def marks_on(piece: Piece, edge: int) -> list[float]:
    """Return the notches of an edge [m]."""
    return [notch.along for notch in piece.notches if notch.edge == edge]


def curvature(walk: Walk) -> float:
    """Return the length of an edge over that of its chord."""
    edge = walk.piece.edges[walk.edge]
    return walk.piece.length(walk.edge) / float(np.linalg.norm(edge[-1] - edge[0]))
