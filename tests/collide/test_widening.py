"""A list of candidates that is completed for a few nodes is what a search for all of them would give."""

import numpy as np
import pytest

from tests.collide.surfaces import crumpled, stacked
from tests.collide.test_candidates import RADIUS, listed
from toile.collide.avatar_surface import AvatarSurface
from toile.collide.search import ContactSearch
from toile.geometry.arrays import Float, Int

ROOM = 1e-3


def searched(
    x: Float,
    faces: Int,
    body: tuple[Float, Int],
    motion: Float,
    drift: Float | None,
    body_drift: Float | None,
) -> tuple[ContactSearch, AvatarSurface]:
    """Search two crumpled sheets and one that plays the avatar; three nodes are sewn into one."""
    weld = np.arange(len(x), dtype=np.int32)
    weld[[5, 20, 27]] = 5
    avatar = AvatarSurface(*body)
    avatar.motion, avatar.drift = np.full(len(body[0]), 0.004), body_drift
    search = ContactSearch(faces, weld, avatar, self_contact=True, radius_self=RADIUS, radius_body=RADIUS)
    search.search(x, motion, drift=drift)
    return search, avatar


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_a_list_widened_for_some_nodes_is_that_of_a_new_search(seed: int, moving: bool) -> None:
    generator = np.random.default_rng(seed)
    x, faces = stacked([crumpled(generator, 4, 0.02, 0.3) for _ in range(2)])
    body = crumpled(generator, 4, 0.03, 0.3)
    motion = generator.uniform(0.002, 0.006, size=len(x))
    along = np.array([0.02, 0.0, 0.0])
    drift = along + generator.normal(scale=1e-3, size=x.shape) if moving else None
    body_drift = along + generator.normal(scale=1e-3, size=body[0].shape) if moving else None
    search, avatar = searched(x, faces, body, motion, drift, body_drift)

    # Half-way of the drift three nodes are farther away from it than they may be.
    there = x.copy() if drift is None else x + 0.5 * drift
    then = body[0] if body_drift is None else body[0] + 0.5 * body_drift
    avatar.move_to(then)
    strayed = [3, 14, 30]
    there[strayed, 1:] += generator.normal(scale=0.03, size=(3, 2))
    left = search.left_in_cloth(there)
    assert (np.flatnonzero(left < 0.0) == strayed).all()
    assert not search.widen_cloth(there, ROOM, 2) and not search.widen_body(there, then, ROOM, 2)
    assert (search.left_in_cloth(there) == left).all()
    assert search.widen_cloth(there, ROOM, 3) and search.widen_body(there, then, ROOM, 3)
    assert search.left_in_cloth(there)[strayed] == pytest.approx(ROOM)
    assert (search.left_with_body(there, then) >= 0.0).all()

    wider = motion.copy()
    wider[strayed] += ROOM - left[strayed]
    new, _ = searched(x, faces, body, wider, drift, body_drift)
    for kind in (0, 1):
        assert listed(search.cloth[kind], kind) == listed(new.cloth[kind], kind)
        assert listed(search.body[kind], kind) == listed(new.body[kind], kind)
    old, _ = searched(x, faces, body, motion, drift, body_drift)
    assert len(new.cloth[0]) > len(old.cloth[0]) and len(new.body[1]) > len(old.body[1])


def test_a_list_that_does_not_hold_any_more_is_not_widened() -> None:
    generator = np.random.default_rng(0)
    x, faces = stacked([crumpled(generator, 4, 0.02, 0.3) for _ in range(2)])
    body = crumpled(generator, 4, 0.03, 0.3)
    search, _ = searched(x, faces, body, np.full(len(x), 0.004), None, None)
    rows = search.cloth[1].copy()
    assert search.widen_cloth(x, ROOM, 3) and search.widen_body(x, None, ROOM, 3)
    assert np.array_equal(search.cloth[1], rows)
    # An avatar that has strayed itself takes a new search.
    assert not search.widen_body(x, body[0] + 0.01, ROOM, 3)
    search.expire()
    assert not search.widen_cloth(x, ROOM, 3) and not search.widen_body(x, None, ROOM, 3)
