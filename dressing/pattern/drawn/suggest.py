"""Seams that a drawn pattern may have, by lengths, corners, folds, mirrored twins and sums of edges; which are sure.

A seam is sure if no other candidate wants one of its edges and nothing about it was a choice between equals.
"""

from collections.abc import Mapping, Sequence
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
from toile.dressing.pattern.seam import Seam
from toile.geometry.arrays import Float

LEAST = 0.015
"""Shorter edges are not sewn by length [m]."""
CAP_EASE = 0.10
"""How much a sleeve cap may differ from its armhole."""
SUM_TOLERANCE = 0.01
CURVED = 1.03
"""Length over chord of a crotch seam, at least."""
DART_TURN = np.radians(100.0)
"""Turn to the right at the tip of a dart, at least."""
UNLIKE_ENDS = 0.6
"""Sum of the logarithms of ratios of the lengths beside a seam's ends from which it is in doubt."""
CLEARLY_LONGER = 1.5
"""Side seam over shoulder seam from which it is clear which is which."""
ALIKE = 0.003
"""Shapes and notches that differ by less are no evidence [m]."""


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
    sums = [c for c in _sums(drawn.pieces, pairs, _legs(darts)) if not c.edges & taken]
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


def _free(piece: Piece) -> list[int]:
    return [n for n in range(len(piece.edges)) if n != piece.fold and piece.length(n) > LEAST]


def _darts(piece: Piece) -> list[Candidate]:
    """Return neighbouring edges of one length between which the outline turns back: the legs of a dart."""
    found = []
    for n in _free(piece):
        after = (n + 1) % len(piece.edges)
        if after != piece.fold and edges_alike(piece, n, piece, after) and turn_after(piece, n) < -DART_TURN:
            found.append(candidate_of("dart", [Walk(piece, n, 1)], [Walk(piece, after, -1)]))
    return [c for c in found if c is not None]


def _pairs(p: Piece, q: Piece) -> list[Candidate]:
    """Return edges of two pieces that are of one length, none from fold to fold nor across both middles."""
    found = []
    for i in _free(p):
        for j in _free(q):
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
    marks_p = _marks(p, i)
    marks_q = _marks(q, j) if same else [p.length(i) - m for m in reversed(_marks(q, j))]
    if marks_p and len(marks_p) == len(marks_q):
        total += 10.0 * max(abs(a - b) for a, b in zip(marks_p, marks_q, strict=True))
    return total


def _marks(piece: Piece, edge: int) -> list[float]:
    return [notch.along for notch in piece.notches if notch.edge == edge]


def _legs(darts: Sequence[Candidate]) -> dict[EdgeKey, int]:
    """Return the other leg of the dart of every leg."""
    legs: dict[EdgeKey, int] = {}
    for dart in darts:
        (a,), (b,) = dart.walks
        legs |= {a.key: b.edge, b.key: a.edge}
    return legs


def _past_darts(walk: Walk, step: int, legs: Mapping[EdgeKey, int]) -> list[Walk]:
    """Return a walk and what follows it (step 1) or comes before it (-1) once darts are closed."""
    found = [walk]
    while True:
        edge = neighbour(walk.piece, found[-1].edge, step * walk.way)
        if (walk.piece.name, edge) not in legs:
            return found if step > 0 else found[::-1]
        beyond = neighbour(walk.piece, edge, 2 * step * walk.way)
        found.append(Walk(walk.piece, beyond, walk.way, walk.mirrored))


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


def _sums(
    pieces: Sequence[Piece], pairs: Sequence[Candidate], legs: Mapping[EdgeKey, int]
) -> list[Candidate]:
    """Return edges as long as two or three others together, which are joined at their corners by other seams."""
    chains = _chains(pairs, legs)
    found: list[Candidate] = []
    for target in pieces:
        for edge in _free(target):
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
    is_cap = place_by_words(target.words) == "sleeve" and _curvature(Walk(target, edge, 1)) > CURVED
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
    """Return the seam of an edge to a chain of others, in the direction that notches and front and back ask for."""
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


def _takes_a_target(pair: Candidate, sums: Sequence[Candidate]) -> bool:
    """Tell whether a pair wants the edge that a sum fits."""
    return any(walk.key in pair.edges for total in sums for walk in total.walks[0])


def _joins_two_sleeves(pair: Candidate, sums: Sequence[Candidate]) -> bool:
    """Tell whether a pair joins two pieces that fit the same edges of others, as both sleeves fit the armholes."""
    (a,), (b,) = pair.walks
    fits = [
        {frozenset(c.edges - {key}) for c in sums for key in c.edges if key[0] == walk.piece.name}
        for walk in (a, b)
    ]
    return bool(fits[0] & fits[1])


def _own_mirrors(pieces: dict[str, Piece], pairs: Sequence[Candidate]) -> list[Candidate]:
    """Return seams of pieces to their own twins: of two pairs, the most curved edges that match (the crotch)."""
    found: list[Candidate] = []
    twins = [
        (a, b) for pair in pairs for (a,), (b,) in [pair.walks] if a.piece.pair and b.piece.pair
        and "sleeve" not in (place_by_words(a.piece.words), place_by_words(b.piece.words))
    ]  # fmt: skip
    for names in sorted({(a.piece.name, b.piece.name) for a, b in twins}):
        both = [(a, b) for a, b in twins if (a.piece.name, b.piece.name) == names]
        for side in range(2):
            walk = max((pair[side] for pair in both), key=_curvature)
            if _curvature(walk) > CURVED:
                own = candidate_of("twin", [Walk(walk.piece, walk.edge, 1)], [Walk(walk.piece, walk.edge, 1)])
                if own is not None and own.edges not in [c.edges for c in found]:
                    found.append(own)
    return found


def _curvature(walk: Walk) -> float:
    edge = walk.piece.edges[walk.edge]
    return walk.piece.length(walk.edge) / float(np.linalg.norm(edge[-1] - edge[0]))


def _tubes(piece: Piece) -> list[Candidate]:
    """Return edges of one piece that are of one length and mirror each other: a sleeve's underarm seam."""
    found = []
    count = len(piece.edges)
    for i, j in combinations(_free(piece), 2):
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
