"""Seams that a drawn pattern may have, by lengths, corners, folds, twins and sums of edges.

A seam is sure if no other candidate wants one of its edges and nothing about it was a choice between equals.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from toile.dressing.pattern.drawn.candidate import (
    Candidate,
    EdgeKey,
    Walk,
    candidate_of,
    edges_alike,
    is_central,
    meets_fold,
    neighbour,
    turn_after,
)
from toile.dressing.pattern.drawn.piece import DrawnPattern, Piece
from toile.dressing.pattern.drawn.place import place_by_words
from toile.dressing.pattern.drawn.sums import CURVED, curvature, free_edges, marks_on, summed_edges
from toile.dressing.pattern.seam import Seam

DART_TURN = np.radians(100.0)
"""Turn to the right at the tip of a dart, at least."""
UNLIKE_ENDS = 0.6
"""Sum of the logarithms of ratios of the lengths beside a seam's ends from which it is in doubt."""


@dataclass(frozen=True)
class Suggestions:
    """All candidates, those that are sure, and questions about the rest, a sentence each."""

    candidates: tuple[Candidate, ...]
    sure: tuple[Seam, ...]
    questions: tuple[str, ...]


def suggest_seams(drawn: DrawnPattern) -> Suggestions:
    """Return the seams that the pieces of a pattern may have."""
    pieces = {piece.name: piece for piece in drawn.pieces}
    darts = [c for piece in drawn.pieces for c in _darts(piece)]
    taken = {key for dart in darts for key in dart.edges}
    pairs = [c for p, q in combinations(drawn.pieces, 2) for c in _pairs(p, q) if not c.edges & taken]
    sums = [c for c in summed_edges(drawn.pieces, pairs, _legs(darts)) if not c.edges & taken]
    summed = {key for c in sums for key in c.edges}
    pairs = [c for c in pairs if not any(c.edges <= s.edges for s in sums) and not _takes_a_target(c, sums)]
    pairs = [c for c in pairs if not _joins_two_sleeves(c, sums)]
    own = [c for c in _own_mirrors(pieces, pairs) if not c.edges & summed]
    mirrored = {key for c in own for key in c.edges}
    pairs = [c for c in pairs if not c.edges & mirrored]
    used = {key for c in (*pairs, *sums, *own, *darts) for key in c.edges}
    tubes = [c for piece in drawn.pieces for c in _tubes(piece) if not c.edges & used]
    candidates = (*darts, *own, *sums, *pairs, *tubes)
    doubtful = _runs_around_corners(pairs, pieces)
    sure, questions = [], []
    for candidate in candidates:
        rivals = [c for c in candidates if c is not candidate and c.edges & candidate.edges]
        if candidate.doubt:
            questions.append(f"{candidate.seam.name}   ({candidate.doubt})")
        elif rivals:
            questions.append(f"{candidate.seam.name}   (or {', '.join(c.seam.name for c in rivals)})")
        elif candidate in doubtful:
            questions.append(f"{candidate.seam.name}   (an opening, such as an armhole, is as likely)")
        else:
            sure.append(candidate.seam)
    questions += _about_pieces(drawn, candidates)
    return Suggestions(candidates, tuple(sure), tuple(questions))


def _about_pieces(drawn: DrawnPattern, candidates: Sequence[Candidate]) -> list[str]:
    """Return what is open about pieces: those that nothing fits, and which may be halves on the fold."""
    questions = []
    for piece in drawn.pieces:
        if any(piece.name == name for c in candidates for name, _ in c.edges):
            continue
        said = f"piece {piece.name}: nothing matches its edges"
        fold = None if piece.mirrors else _likely_fold(piece)
        questions.append(said if fold is None else f"{said}; if it is a half, say fold = {fold} below")
    return questions


def _likely_fold(piece: Piece) -> int | None:
    """Return the longest straight edge along the grain, None if there is none."""
    warp = np.radians(piece.warp_degrees)
    across = np.array([np.cos(warp), np.sin(warp)])
    straight = []
    for n, edge in enumerate(piece.edges):
        chord = edge[-1] - edge[0]
        length = float(np.linalg.norm(chord))
        if piece.length(n) < 1.0005 * length and abs(float(chord @ across)) < 0.02 * length:
            straight.append((length, n))
    return max(straight)[1] if straight else None


def _darts(piece: Piece) -> list[Candidate]:
    """Return neighbouring edges of one length between which the outline turns back: the legs of a dart."""
    found = []
    for n in free_edges(piece):
        after = (n + 1) % len(piece.edges)
        if after != piece.fold and edges_alike(piece, n, piece, after) and turn_after(piece, n) < -DART_TURN:
            found.append(candidate_of("dart", [Walk(piece, n, 1)], [Walk(piece, after, -1)]))
    return [c for c in found if c is not None]


def _pairs(p: Piece, q: Piece) -> list[Candidate]:
    """Return edges of two pieces that are of one length, none from fold to fold nor across both middles."""
    found = []
    for i in free_edges(p):
        for j in free_edges(q):
            both_folded = meets_fold(p, i) and meets_fold(q, j)
            both_central = is_central(p, i) and is_central(q, j)
            if not edges_alike(p, i, q, j) or both_folded or both_central:
                continue
            same = _end_cost(p, i, q, j, same=True)
            other = _end_cost(p, i, q, j, same=False)
            directions = (1, -1) if same <= other else (-1, 1)
            options = [candidate_of("pair", [Walk(p, i, 1)], [Walk(q, j, d)]) for d in directions]
            # The worse direction stands in only where cloth cannot be sewn the better way.
            best = options[0] or (options[1] if abs(same - other) < 0.1 else None)
            if best is not None:
                sleeve = "sleeve" in (place_by_words(p.words), place_by_words(q.words))
                doubt = "what follows at its ends differs" if sleeve or min(same, other) > UNLIKE_ENDS else ""
                found.append(best.with_doubt(doubt))
    return found


def _end_cost(p: Piece, i: int, q: Piece, j: int, *, same: bool) -> float:
    """Return how badly the ends of two edges match by what follows there, their starts together or not."""
    total = 0.0
    for step in (-1, 1):
        a, b = neighbour(p, i, step), neighbour(q, j, step if same else -step)
        if (a == p.fold) != (b == q.fold):
            total += 1.0
        elif a != p.fold:
            total += abs(float(np.log(p.length(a) / q.length(b))))
    marks_p = marks_on(p, i)
    marks_q = marks_on(q, j) if same else [p.length(i) - m for m in reversed(marks_on(q, j))]
    if marks_p and len(marks_p) == len(marks_q):
        total += 10.0 * max(abs(a - b) for a, b in zip(marks_p, marks_q, strict=True))
    return total


def _legs(darts: Sequence[Candidate]) -> dict[EdgeKey, int]:
    """Return the other leg of the dart of every leg."""
    legs: dict[EdgeKey, int] = {}
    for dart in darts:
        (a,), (b,) = dart.walks
        legs |= {a.key: b.edge, b.key: a.edge}
    return legs


def _takes_a_target(pair: Candidate, sums: Sequence[Candidate]) -> bool:
    """Tell whether a pair wants the edge that a sum fits."""
    return any(walk.key in pair.edges for total in sums for walk in total.walks[0])


def _joins_two_sleeves(pair: Candidate, sums: Sequence[Candidate]) -> bool:
    """Tell whether a pair joins two pieces that fit the same edges, as both sleeves fit the armholes."""
    (a,), (b,) = pair.walks
    fits = [
        {frozenset(c.edges - {key}) for c in sums for key in c.edges if key[0] == walk.piece.name}
        for walk in (a, b)
    ]
    return bool(fits[0] & fits[1])


def _own_mirrors(pieces: dict[str, Piece], pairs: Sequence[Candidate]) -> list[Candidate]:
    """Return seams of pieces to their own twins: of two pairs, the most curved edges that match."""
    found: list[Candidate] = []
    twins = [
        (a, b) for pair in pairs for (a,), (b,) in [pair.walks] if a.piece.pair and b.piece.pair
        and "sleeve" not in (place_by_words(a.piece.words), place_by_words(b.piece.words))
    ]  # fmt: skip
    for names in sorted({(a.piece.name, b.piece.name) for a, b in twins}):
        both = [(a, b) for a, b in twins if (a.piece.name, b.piece.name) == names]
        for side in range(2):
            walk = max((pair[side] for pair in both), key=curvature)
            if curvature(walk) > CURVED:
                own = candidate_of("twin", [Walk(walk.piece, walk.edge, 1)], [Walk(walk.piece, walk.edge, 1)])
                if own is not None and own.edges not in [c.edges for c in found]:
                    found.append(own)
    return found


def _tubes(piece: Piece) -> list[Candidate]:
    """Return edges of one piece that are of one length and mirror each other, as under the arm."""
    found = []
    count = len(piece.edges)
    for i, j in combinations(free_edges(piece), 2):
        apart = (j - i) % count not in (1, count - 1)
        if piece.fold is None and apart and edges_alike(piece, i, piece, j):
            middles = [(i + j) // 2 if (i + j) % 2 == 0 else -1]
            if any(m >= 0 and is_central(piece, m) for m in middles):
                found.append(candidate_of("tube", [Walk(piece, i, 1)], [Walk(piece, j, -1)]))
    tubes = [c for c in found if c is not None]
    return tubes if len(tubes) < 2 else [c.with_doubt("it may be the other way around") for c in tubes]


def _runs_around_corners(pairs: Sequence[Candidate], pieces: dict[str, Piece]) -> list[Candidate]:
    """Return seams of the same two pieces that follow each other around a corner.

    Of three in a row the middle one is in doubt, of two both.
    """
    doubtful = []
    for pair in pairs:
        (a,), (b,) = pair.walks
        sides = []
        for end in (-1, 1):
            beside = {
                (a.piece.name, neighbour(a.piece, a.edge, end)),
                (b.piece.name, neighbour(b.piece, b.edge, end * b.way)),
            }
            sides.append(next((other for other in pairs if other.edges == beside), None))
        neighbours = [other for other in sides if other is not None]
        if len(neighbours) == 2 or (neighbours and not _is_end_of_three(pair, neighbours[0], pairs)):
            doubtful.append(pair)
    return doubtful


def _is_end_of_three(pair: Candidate, middle: Candidate, pairs: Sequence[Candidate]) -> bool:
    """Tell whether a seam's neighbour has a neighbour on its other side as well."""
    (a,), (b,) = middle.walks
    for end in (-1, 1):
        beside = {
            (a.piece.name, neighbour(a.piece, a.edge, end)),
            (b.piece.name, neighbour(b.piece, b.edge, end * b.way)),
        }
        if any(other.edges == beside for other in pairs if other is not pair):
            return True
    return False
