"""The contact search lists exactly the close pairs, each once, and its list stays complete."""

import numpy as np
import pytest

from tests.collide.surfaces import (
    all_edge_edges,
    all_vertex_faces,
    crumpled,
    edges_of,
    sheet,
    stacked,
    vertices,
)
from toile.collide import bvh, candidates
from toile.collide.avatar_surface import AvatarSurface
from toile.collide.edge_edge import closest_parameters
from toile.collide.search import ContactSearch
from toile.collide.surface import surface_of
from toile.collide.vertex_face import closest_barycentric
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import CrowdedError

RADIUS = 0.01
Pair = tuple[int, ...]


def distance(p: Float, row: Int, kind: int) -> float:
    q = p[row]
    if kind == 0:
        return float(np.linalg.norm(q[0] - np.array(closest_barycentric(*q.ravel())) @ q[1:]))
    s, t = closest_parameters(*q.ravel())
    return float(np.linalg.norm(q[0] + s * (q[1] - q[0]) - q[2] - t * (q[3] - q[2])))


def key(row: Int, kind: int) -> Pair:
    """Name of a pair that does not depend on the order of its vertices."""
    a, b, c, d = (int(v) for v in row)
    if kind == 0:
        return (a, *sorted((b, c, d)))
    first, second = sorted([sorted((a, b)), sorted((c, d))])
    return (*first, *second)


def listed(rows: Int, kind: int) -> set[Pair]:
    """Names of listed pairs; fails where one is listed twice."""
    names = {key(row, kind) for row in rows}
    assert len(names) == len(rows)
    return names


def brute_force(p: Float, rows: Int, kind: int, reach: Float, weld: Int) -> set[Pair]:
    """Pairs closer than the reaches of their two sides that share no sewn vertex."""
    split = 1 if kind == 0 else 2
    found = set()
    for row in rows:
        if set(weld[row[:split]].tolist()) & set(weld[row[split:]].tolist()):
            continue
        if distance(p, row, kind) < reach[row[:split]].max() + reach[row[split:]].max():
            found.add(key(row, kind))
    return found


def scene(seed: int) -> tuple[Float, Int, Float, Int]:
    """Two crumpled sheets of cloth that interpenetrate, and one that plays the avatar."""
    generator = np.random.default_rng(seed)
    cloth, faces = stacked([crumpled(generator, 4, 0.02, 0.3) for _ in range(2)])
    body, body_faces = crumpled(generator, 4, 0.03, 0.3)
    return cloth, faces, body, body_faces


def covers(search: ContactSearch, x: Float, motion: Float) -> bool:
    """Whether the candidates are complete while nodes at x move by at most `motion` [m]."""
    return bool((search.allowance(x) >= motion).all())


@pytest.mark.parametrize("seed", range(6))
def test_the_list_is_brute_force(seed: int) -> None:
    x, faces, body, body_faces = scene(seed)
    generator = np.random.default_rng(100 + seed)
    weld = np.arange(len(x), dtype=np.int32)
    # Three nodes sewn into one, far from each other in the mesh.
    weld[[5, 20, 27]] = 5
    motion = generator.uniform(0.0, 0.02, size=len(x)) * generator.integers(0, 2, size=len(x))
    avatar = AvatarSurface(body, body_faces)
    avatar.motion = generator.uniform(0.0, 0.01, size=len(body))
    search = ContactSearch(faces, weld, avatar, self_contact=True, radius_self=RADIUS, radius_body=RADIUS)
    search.search(x, motion)

    p = np.concatenate([x, body])
    assert np.array_equal(search.positions, p)
    reach = 0.5 * RADIUS + np.concatenate([motion, avatar.motion])
    welded = np.concatenate([weld, np.arange(len(x), len(p))])
    shifted = body_faces + len(x)
    edges, body_edges = edges_of(faces), edges_of(shifted)

    vertex_faces = all_vertex_faces(vertices(len(x)), faces)
    assert listed(search.cloth[0], 0) == brute_force(p, vertex_faces, 0, reach, welded)
    assert listed(search.cloth[1], 1) == brute_force(p, all_edge_edges(edges), 1, reach, welded)

    against = np.concatenate(
        [all_vertex_faces(vertices(len(x)), shifted), all_vertex_faces(vertices(len(p))[len(x) :], faces)]
    )
    assert listed(search.body[0], 0) == brute_force(p, against, 0, reach, welded)
    across = np.concatenate(
        [np.repeat(edges, len(body_edges), axis=0), np.tile(body_edges, (len(edges), 1))], axis=1
    )
    assert listed(search.body[1], 1) == brute_force(p, across, 1, reach, welded)
    assert min(map(len, (*search.cloth, *search.body))) > 20


@pytest.mark.parametrize("seed", range(6))
def test_neighbours_in_smooth_cloth_are_listed_where_they_come_close(seed: int) -> None:
    """Faces around a vertex are told apart by a line where cloth is smooth; some here reach each other."""
    generator = np.random.default_rng(200 + seed)
    x, faces = crumpled(generator, 7, 0.02, 0.1)
    weld = np.arange(len(x), dtype=np.int32)
    # Two nodes that are sewn but still apart.
    weld[[10, 30]] = 10
    motion = generator.uniform(0.0, 0.011, size=len(x))
    search = ContactSearch(faces, weld, None, self_contact=True, radius_self=1e-3, radius_body=1e-3)
    search.search(x, motion)
    reach = 5e-4 + motion
    near = brute_force(x, all_vertex_faces(vertices(len(x)), faces), 0, reach, weld)
    assert listed(search.cloth[0], 0) == near
    edge_edges = all_edge_edges(edges_of(faces))
    assert listed(search.cloth[1], 1) == brute_force(x, edge_edges, 1, reach, weld)
    assert 10 < len(near) < 0.05 * len(x) * len(faces)


@pytest.mark.parametrize("seed", range(6))
def test_the_list_covers_a_drift_and_what_strays_from_it(seed: int) -> None:
    """All nodes do the same share of their drift: every pair within the contact radius is listed."""
    x, faces, body, body_faces = scene(seed)
    generator = np.random.default_rng(300 + seed)
    weld = np.arange(len(x), dtype=np.int32)
    avatar = AvatarSurface(body, body_faces)
    search = ContactSearch(faces, weld, avatar, self_contact=True, radius_self=RADIUS, radius_body=RADIUS)
    stray = generator.uniform(0.002, 0.003, size=len(x))
    drift = np.array([0.03, -0.01, 0.02]) + 0.01 * generator.normal(size=x.shape)
    search.search(x, stray, drift=drift)
    still = ContactSearch(faces, weld, avatar, self_contact=True, radius_self=RADIUS, radius_body=RADIUS)
    still.search(x, stray + np.linalg.norm(drift, axis=1))
    assert len(search.cloth[0]) < len(still.cloth[0]) and len(search.cloth[1]) < len(still.cloth[1])
    shifted = body_faces + len(x)
    vertex_faces = all_vertex_faces(vertices(len(x)), faces)
    against = np.concatenate(
        [all_vertex_faces(vertices(len(x)), shifted), all_vertex_faces(vertices(len(x) + len(body)), faces)]
    )
    against = against[(against < len(x)).any(axis=1) & (against >= len(x)).any(axis=1)]
    edge_edges = all_edge_edges(edges_of(faces))
    welded = np.arange(len(x) + len(body), dtype=np.int32)
    radius = np.full(len(x) + len(body), 0.5 * RADIUS)
    for share in (0.0, 0.3, 0.7, 1.0):
        way = generator.normal(size=x.shape)
        way *= (0.5 * stray / np.linalg.norm(way, axis=1))[:, None]
        then = x + share * drift + way
        assert search.covers(then)
        p = np.concatenate([then, body])
        assert brute_force(p, vertex_faces, 0, radius, welded) <= listed(search.cloth[0], 0)
        assert brute_force(p, edge_edges, 1, radius, welded) <= listed(search.cloth[1], 1)
        assert brute_force(p, against, 0, radius, welded) <= listed(search.body[0], 0)
    assert not search.covers(x + 1.5 * drift)
    assert not search.covers(x - 0.5 * drift)


@pytest.mark.parametrize("seed", range(6))
def test_the_list_covers_the_allowed_motion(seed: int) -> None:
    """After any motion that is covered, every pair within the contact radius or reach is still listed."""
    x, faces, body, body_faces = scene(seed)
    generator = np.random.default_rng(200 + seed)
    weld = np.arange(len(x), dtype=np.int32)
    avatar = AvatarSurface(body, body_faces)
    search = ContactSearch(faces, weld, avatar, self_contact=True, radius_self=RADIUS, radius_body=RADIUS)
    motion = generator.uniform(0.0, 0.02, size=len(x))
    search.search(x, motion)
    vertex_faces = all_vertex_faces(vertices(len(x)), faces)
    edge_edges = all_edge_edges(edges_of(faces))
    names = listed(search.cloth[0], 0), listed(search.cloth[1], 1)
    for _ in range(3):
        way = generator.normal(size=x.shape)
        way *= (motion * generator.uniform(0, 1, size=len(x)) / np.linalg.norm(way, axis=1))[:, None]
        then = x + way
        used = np.linalg.norm(way, axis=1)
        left = (motion - used) * (1 - 1e-9)
        assert covers(search, then, left)
        for kind, rows in ((0, vertex_faces), (1, edge_edges)):
            # Whoever ends the remaining motion within the radius of each other must be listed.
            for _ in range(2):
                step = generator.normal(size=x.shape)
                end = then + step * (left / np.linalg.norm(step, axis=1))[:, None]
                close = brute_force(end, rows, kind, np.full(len(x), 0.5 * RADIUS), weld)
                assert close <= names[kind]


def test_covers_knows_its_limits() -> None:
    x, faces = sheet(3, 0.02)
    search = ContactSearch(
        faces, np.arange(9, dtype=np.int32), None, self_contact=True, radius_self=RADIUS, radius_body=RADIUS
    )
    none = np.zeros(9)
    assert not covers(search, x, none)
    search.search(x, np.full(9, 0.01))
    assert covers(search, x, np.full(9, 0.01)) and not covers(search, x, np.full(9, 0.0101))
    moved = x.copy()
    moved[4, 1] += 0.006
    one = none.copy()
    one[4] = 0.0041
    assert covers(search, moved, none) and not covers(search, moved, one)
    search.expire()
    assert not covers(search, x, none)


def test_the_avatars_own_motion_and_place_are_searched() -> None:
    x, faces = sheet(3, 0.02)
    weld = np.arange(9, dtype=np.int32)
    body = x - np.array([0.0, 0.05, 0.0])
    avatar = AvatarSurface(body, faces)
    search = ContactSearch(faces, weld, avatar, self_contact=False, radius_self=RADIUS, radius_body=RADIUS)
    search.search(x, np.zeros(9))
    assert len(search.body[0]) == 0
    avatar.motion = np.full(9, 0.0401)
    search.search(x, np.zeros(9))
    assert len(search.body[0]) > 0
    avatar.motion = np.zeros(9)
    search.search(x, np.zeros(9))
    assert len(search.body[0]) == 0
    avatar.move_to(x - np.array([0.0, 0.009, 0.0]))
    search.search(x, np.zeros(9))
    assert len(search.body[0]) > 0 and len(search.cloth[0]) == 0


def test_marked_nodes_pass_each_other_and_nothing_else() -> None:
    x, faces, body, body_faces = scene(3)
    weld = np.arange(len(x), dtype=np.int32)
    search = ContactSearch(
        faces,
        weld,
        AvatarSurface(body, body_faces),
        self_contact=True,
        radius_self=RADIUS,
        radius_body=RADIUS,
    )
    motion = np.zeros(len(x))
    search.search(x, motion)
    before = [listed(rows, kind) for kind, rows in enumerate(search.cloth)]
    against = [len(rows) for rows in search.body]
    ghost = np.zeros(len(x) + len(body), bool)
    ghost[10:25] = True
    search.let_pass(ghost)
    assert not covers(search, x, motion)
    search.search(x, motion)
    marked = set(np.flatnonzero(ghost).tolist())
    for kind, rows in enumerate(search.cloth):
        assert listed(rows, kind) == {pair for pair in before[kind] if not set(pair) <= marked}
    assert [len(rows) for rows in search.body] == against


def test_every_vertex_and_edge_has_one_owner() -> None:
    _, faces = sheet(5, 0.02)
    surface = surface_of(faces)
    bits = surface.owned[:, None] >> np.arange(6) & 1
    assert sorted(faces[bits[:, :3] == 1]) == list(range(25))
    starts, ends = faces, np.roll(faces, -1, axis=1)
    owns_edge = bits[:, 3:] == 1
    owned = np.stack([starts[owns_edge], ends[owns_edge]], axis=1)
    assert np.array_equal(np.unique(np.sort(owned, axis=1), axis=0), edges_of(faces))
    assert len(owned) == len(edges_of(faces))


def test_more_pairs_than_memory_is_for_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cloth a hundred times thicker than its triangles are long: every pair is a candidate."""
    positions, faces = sheet(12, 0.02)
    search = ContactSearch(
        faces, np.arange(len(positions), dtype=np.int32), None, self_contact=True, radius_self=50.0,
        radius_body=0.0,
    )  # fmt: skip
    monkeypatch.setattr(bvh, "MOST_PAIRS", 10_000)
    with pytest.raises(CrowdedError, match=r"pairs of triangles are close enough to touch.*check thickness"):
        search.search(positions, np.full(len(positions), 0.01))
    monkeypatch.setattr(bvh, "MOST_PAIRS", 10_000_000)
    monkeypatch.setattr(candidates, "MOST_CANDIDATES", 10_000)
    with pytest.raises(CrowdedError):
        search.search(positions, np.full(len(positions), 0.01))
