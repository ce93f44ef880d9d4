"""Safe moves of cloth in motion, and of the avatar with it."""

from typing import NamedTuple

import numpy as np

from toile.collide.avatar_surface import AvatarSurface
from toile.collide.guard import safe_factors
from toile.collide.search import ContactSearch
from toile.geometry.arrays import Bool, Float

MOTION_AHEAD = 1.1
LEAST_ALLOWANCE = 1e-3
"""Candidates cover MOTION_AHEAD times the last motion and LEAST_ALLOWANCE [m]: fewer searches."""
SPREAD = 2e-3
"""Room that avatar vertices have beside their common motion [m]: where the guard stops some, others pass."""
LAG = 1e-3
"""Room that avatar vertices on a known way have beside it [m]: cloth holds them back a little."""
FEW = 0.02
"""Share of nodes that may miss contacts ahead for want of candidates rather than search anew."""
SOME = 0.3
"""Share of nodes for which candidates against a moving avatar are completed rather than all searched anew.
Within cloth that let a crumpled sheet stretch by 12 % instead of 3 %."""
STEPS_AHEAD = 3.0
"""Candidates within cloth in motion cover this many steps."""
ATTEMPTS = 5
"""Searches at most for one move."""
TAKEN_BACK = 0.3
"""Share of what the guard took back once that it may take back the next time."""


class SafeMove(NamedTuple):
    """Displacements of nodes, shape (n, 3), and avatar vertices, (v, 3), [m]; nodes held back, shape (n,)."""

    cloth: Float
    avatar: Float
    limited: Bool


def expect(search: ContactSearch, x: Float, ahead: Float, allowed: Float) -> None:
    """Make candidates cover the expected motion of the nodes beside a still avatar, for most nodes.

    Candidates that miss some contacts ahead are safe: what the step then asks for is searched.

    Parameters
    ----------
    x, ahead
        Nodes and how far they will move, about [m], shape (n, 3).
    allowed
        Room that nodes have beside that motion [m], shape (n,).
    """
    _expect_in_cloth(search, x, ahead, allowed)
    few = FEW * len(x)
    if not search.covers_body(x) or np.count_nonzero(search.left_with_body(x + ahead) < 0.0) > few:
        search.search_body(x, allowed, drift=STEPS_AHEAD * ahead)


def _expect_in_cloth(search: ContactSearch, x: Float, ahead: Float, allowed: Float) -> None:
    """Do the part of `expect` and `expect_avatar` that is about pairs within the cloth."""
    missing = search.left_in_cloth(x + ahead) < 0.0
    if not search.covers_cloth(x) or np.count_nonzero(missing) > FEW * len(x):
        search.search_cloth(x, allowed, drift=STEPS_AHEAD * ahead)


def _search_body(
    search: ContactSearch, avatar: AvatarSurface | None, motion: Float | None, x: Float, ahead: Float,
    allowed: Float,
) -> None:  # fmt: skip
    """Search pairs with the avatar for a few steps of the nodes, and of its vertices where those move.

    Where it is known what they are bound for, all go on until they are there.
    """
    steps = STEPS_AHEAD
    if avatar is not None and motion is not None:
        drift, room = steps * motion, np.full(len(motion), SPREAD)
        if avatar.bound_for is not None:
            drift, room = avatar.bound_for - avatar.vertices, LAG + avatar.off_course
            steps = max(1.0, float((drift * motion).sum()) / max(float((motion * motion).sum()), 1e-300))
        avatar.expect(room, drift)
    search.search_body(x, allowed, drift=steps * ahead)


def expect_avatar(
    search: ContactSearch, avatar: AvatarSurface, motion: Float, x: Float, ahead: Float, allowed: Float
) -> None:
    """Make candidates cover the expected motion of avatar and nodes, for most of them, as `expect` does.

    Candidates of an earlier iteration or step often still do: they cover a few steps like this one.

    Parameters
    ----------
    motion, ahead
        How far the avatar's vertices will move [m], shape (v, 3), and the nodes about, shape (n, 3).
    x
        Nodes [m], shape (n, 3).
    allowed
        Room that nodes have beside their expected motion [m], shape (n,).
    """
    _expect_in_cloth(search, x, ahead, allowed)
    if avatar.drift is not None and (search.left_with_body(x, avatar.vertices) >= 0.0).all():
        there, avatar_there = x + ahead, avatar.vertices + motion
        left = search.left_with_body(there, avatar_there)
        few_miss = (left[len(x) :] >= 0.0).all() and np.count_nonzero(left[: len(x)] < 0.0) <= FEW * len(x)
        if few_miss or search.widen_body(there, avatar_there, LEAST_ALLOWANCE, int(SOME * len(x))):
            return
    _search_body(search, avatar, motion, x, ahead, allowed)


def safe_in_motion(
    search: ContactSearch, x: Float, wanted: Float, allowed: Float, avatar: AvatarSurface | None,
    avatar_wanted: Float | None, common: Float | None,
) -> SafeMove:  # fmt: skip
    """Shorten displacements to what is safe.

    Candidates for a common drift leave out pairs that move together. Where the guard tears such a pair apart,
    they are searched again with room for what it held back.

    Parameters
    ----------
    search
        Candidates, with distances as measured at x; searched again where they are incomplete.
    x, wanted
        Nodes and their displacements [m], shape (n, 3).
    allowed
        Room that a new search gives nodes beside their drift [m], shape (n,).
    avatar, avatar_wanted
        The avatar, and how far its vertices shall move [m], shape (v, 3), where it does.
    common
        Motion of the whole scene [m], shape (3,), or None: displacements are shortened to it, not to nothing,
        so that what is jammed travels along.
    """
    count = len(x)
    start = None if avatar is None or avatar_wanted is None else avatar.vertices
    move = np.zeros_like(search.positions)
    move[:count] = wanted
    if avatar_wanted is not None:
        move[count:] = avatar_wanted

    def covered(done: Float) -> bool:
        return search.covers(x + done[:count], None if start is None else start + done[count:])

    few = int(FEW * count)
    if not (search.covers_cloth(x) and search.widen_cloth(x + wanted, LEAST_ALLOWANCE, few)):
        search.search_cloth(x, allowed, drift=STEPS_AHEAD * wanted)
    there = None if start is None else start + move[count:]
    complete = (search.left_with_body(x, start) >= 0.0).all()
    some = few if there is None else int(SOME * count)
    if not (complete and search.widen_body(x + wanted, there, LEAST_ALLOWANCE, some)):
        _search_body(search, avatar, avatar_wanted, x, wanted, allowed)
    limited = np.zeros(len(move), bool)
    for attempt in range(ATTEMPTS):
        search.place(x)
        own = move if common is None else move - common
        factor = safe_factors(search.positions, own, *search.pairs, search.distances)
        cut = factor < 1.0
        limited |= cut
        done = np.where(cut[:, None], move - (1.0 - factor)[:, None] * own, move)
        if covered(done):
            return SafeMove(done[:count], done[count:], limited[:count])
        # From here on to where the guard let them come, with room for the little that it may take back yet.
        lost = np.linalg.norm(done - move, axis=1)
        if attempt == ATTEMPTS - 2:
            lost = MOTION_AHEAD * (np.linalg.norm(own, axis=1) + np.linalg.norm(done, axis=1)) / TAKEN_BACK
        move = done
        room = LEAST_ALLOWANCE + TAKEN_BACK * lost
        if not search.covers_cloth(x + done[:count]):
            search.search_cloth(x, room[:count], drift=done[:count])
        if avatar is not None and start is not None:
            if attempt == 0 and search.widen_body(
                x + done[:count], start + done[count:], LEAST_ALLOWANCE, some
            ):
                continue
            avatar.expect(room[count:], done[count:])
        search.search_body(x, room[:count], drift=done[:count])
    still = np.zeros_like(move)
    return SafeMove(still[:count], still[count:], np.ones(count, bool))
