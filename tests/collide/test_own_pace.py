"""Pairs with an avatar that stays are known wherever each node is on its own way."""

import numpy as np
import pytest

from tests.collide.surfaces import all_vertex_faces, edges_of, vertices
from tests.collide.test_candidates import RADIUS, brute_force, listed, scene
from toile.collide.search import AvatarSurface, ContactSearch


@pytest.mark.parametrize("seed", range(6))
def test_the_list_covers_nodes_that_stop_on_their_way(seed: int) -> None:
    x, faces, body, body_faces = scene(seed)
    generator = np.random.default_rng(400 + seed)
    count = len(x)
    avatar = AvatarSurface(body, body_faces)
    search = ContactSearch(
        faces, np.arange(count, dtype=np.int32), avatar, self_contact=True, radius_self=RADIUS,
        radius_body=RADIUS,
    )  # fmt: skip
    stray = generator.uniform(0.002, 0.003, size=count)
    drift = 0.03 * generator.normal(size=x.shape)
    search.search(x, stray, drift=drift)
    shifted = body_faces + count
    corners = [
        all_vertex_faces(vertices(count), shifted),
        all_vertex_faces(vertices(count + len(body)), faces),
    ]
    against = np.concatenate(corners)
    against = against[(against < count).any(axis=1) & (against >= count).any(axis=1)]
    edges, body_edges = edges_of(faces), edges_of(shifted)
    across = np.concatenate(
        [np.repeat(edges, len(body_edges), axis=0), np.tile(body_edges, (len(edges), 1))], axis=1
    )
    known = listed(search.body[0], 0), listed(search.body[1], 1)
    radius = np.full(count + len(body), 0.5 * RADIUS)
    welded = np.arange(count + len(body), dtype=np.int32)
    for _ in range(3):
        way = generator.normal(size=x.shape)
        way *= (0.9 * stray / np.linalg.norm(way, axis=1))[:, None]
        then = x + generator.uniform(size=(count, 1)) * drift + way
        assert search.covers_body(then)
        assert not search.covers_cloth(then)
        p = np.concatenate([then, body])
        for kind, rows in ((0, against), (1, across)):
            close = brute_force(p, rows, kind, radius, welded)
            assert close and close <= known[kind]
    assert not search.covers_body(x + 1.5 * drift)
    assert not search.covers_body(x - 0.5 * drift)


def test_beside_an_avatar_that_moves_all_keep_pace() -> None:
    x, faces, body, body_faces = scene(0)
    avatar = AvatarSurface(body, body_faces)
    avatar.drift, avatar.motion = np.full_like(body, 0.02), np.full(len(body), 0.002)
    search = ContactSearch(
        faces, np.arange(len(x), dtype=np.int32), avatar, self_contact=True, radius_self=RADIUS,
        radius_body=RADIUS,
    )  # fmt: skip
    drift = np.full_like(x, 0.02)
    search.search_body(x, np.full(len(x), 0.002), drift=drift)
    there = x + 0.5 * drift
    there[3] = x[3]
    left = search.left_with_body(there, body + 0.01)
    assert left[3] < 0.0 and (np.delete(left, 3) >= 0.0).all()
