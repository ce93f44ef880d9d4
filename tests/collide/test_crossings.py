"""Triangles that meet are found exactly, however they touch; rational arithmetic and FCL are the referees."""

import fcl
import numpy as np
import pytest

from tests.collide.rational_triangles import common_corners, cross, crossing_in_rationals, exact, normal
from tests.collide.surfaces import crumpled, stacked
from toile.collide.audit import Auditor, crossings_within
from toile.collide.crossings.face_pairs import PAIRS
from toile.collide.rigid_pieces import bvh_model
from toile.collide.segments import crossing_faces
from toile.geometry.arrays import Float, Int

FACE = np.array([(0, 1, 2)], np.int32)
PAIRS_TRIED = 1500
"""Pairs of every kind."""


def lattice(random: np.random.Generator) -> Float:
    """Six points of a small lattice: half of such pairs touch, lie in one plane or have corners in common."""
    return np.asarray(random.integers(0, 3, (6, 3)), np.float64)


def tenths(random: np.random.Generator) -> Float:
    """A lattice whose numbers are rounded: what lay in one plane lies there but for the last digit."""
    return 0.1 * lattice(random) + 0.3


def turned(random: np.random.Generator) -> Float:
    """A lattice in any position."""
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    return np.ascontiguousarray(lattice(random) @ turn.T + random.normal(size=3))


def in_a_plane(random: np.random.Generator) -> Float:
    """Six points of one plane."""
    points = np.asarray(random.integers(0, 4, (6, 3)), np.float64)
    points[:, 2] = points[:, 0] + 2.0 * points[:, 1]
    return points


def on_the_other(random: np.random.Generator) -> Float:
    """A corner of the second triangle lies on the first, as well as numbers can say."""
    points = random.normal(size=(6, 3))
    shares = random.integers(0, 4, 3).astype(float)
    points[3] = shares @ points[:3] / max(shares.sum(), 1.0)
    return points


def by_a_hair(random: np.random.Generator) -> Float:
    """A corner on the first triangle, moved by the smallest number there is or a few of them."""
    points = on_the_other(random)
    points[3] += random.integers(-2, 3, 3) * np.spacing(points[3])
    return points


def anyhow(random: np.random.Generator) -> Float:
    return np.asarray(random.normal(size=(6, 3)))


KINDS = (lattice, tenths, turned, in_a_plane, on_the_other, by_a_hair, anyhow)


def pairs_between(x: Float, faces: Int, other: Float, other_faces: Int) -> Int:
    return Auditor(other, other_faces).audit(x, faces, np.arange(len(x), dtype=np.int32)).avatar


def found_between(points: Float) -> bool:
    return len(pairs_between(points[:3].copy(), FACE, points[3:].copy(), FACE)) == 1


@pytest.mark.parametrize("kind", KINDS)
def test_two_triangles_meet_if_they_do_in_rational_arithmetic(kind) -> None:  # type: ignore[no-untyped-def]
    random = np.random.default_rng(7)
    met = 0
    for _ in range(PAIRS_TRIED):
        points = kind(random)
        one, other = exact(points[:3]), exact(points[3:])
        if not any(normal(other)):
            one, other = other, one
        if not any(normal(other)):
            continue
        expected = bool(common_corners(one, other))
        met += expected
        assert found_between(points) == expected, points.tolist()
        assert found_between(np.roll(points, 3, axis=0)) == expected, points.tolist()
    assert 0.03 * PAIRS_TRIED < met < 0.97 * PAIRS_TRIED


@pytest.mark.parametrize("kind", KINDS)
def test_faces_with_a_common_corner_cross_where_they_meet_beyond_it(kind) -> None:  # type: ignore[no-untyped-def]
    random = np.random.default_rng(8)
    weld = np.arange(5, dtype=np.int32)
    met = 0
    for _ in range(PAIRS_TRIED):
        points = np.delete(kind(random), 4, axis=0)
        corner = points[0]
        one, other = exact(points[:3]), exact(points[[0, 3, 4]])
        if not any(normal(one)) or not any(normal(other)):
            continue
        expected = bool(common_corners(one, other) - set(exact(corner[None])))
        met += expected
        for shift in range(3):
            faces = np.array([np.roll([0, 1, 2], shift), np.roll([0, 3, 4], 2 * shift)], np.int32)
            assert len(crossings_within(points, faces, weld)) == expected, points.tolist()
    assert 0.01 * PAIRS_TRIED < met < 0.97 * PAIRS_TRIED


def test_triangles_without_area() -> None:
    """Lines and points: they meet what they lie on."""
    line = np.array([(0, 0, 0), (1, 1, 1), (2, 2, 2)], float)
    for points, expected in (
        ((0.5, 0.5, 0.5), True), ((2, 2, 2), True), ((2.5, 2.5, 2.5), False), ((0.5, 0.5, 0.25), False),
    ):  # fmt: skip
        point = np.tile(np.array(points, float), (3, 1))
        assert found_between(np.concatenate([line, point])) == expected
        assert found_between(np.concatenate([point, line])) == expected
    across = np.array([(0, 2, 1), (2, 0, 1), (2, 0, 1)], float)
    assert found_between(np.concatenate([line, across]))
    assert not found_between(np.concatenate([line, across + np.array([0.0, 0.0, 1e-15])]))


def grid(origin: tuple[float, float, float], u: int, v: int, count: int = 8) -> tuple[Float, Int]:
    """A sheet of 0.8 m in squares, along two axes."""
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(count + 1), np.arange(count + 1), indexing="ij"))
    points = np.tile(np.array(origin), (len(i), 1))
    points[:, u] += 0.8 * i / count
    points[:, v] += 0.8 * j / count
    a = np.flatnonzero((i < count) & (j < count))
    right, up = a + count + 1, a + 1
    faces = np.concatenate([np.column_stack([a, right, right + 1]), np.column_stack([a, right + 1, up])])
    return points, faces.astype(np.int32)


LEVEL = grid((-0.4, 1.3, 0.25), 0, 2)
UPRIGHT = {
    "along rows of edges of both": (-0.4, 0.9, 0.65),
    "along a row of edges of one": (-0.4, 0.91, 0.65),
    "along a row of edges of the other": (-0.4, 0.9, 0.663),
    "anywhere": (-0.41, 0.91, 0.663),
    "edges on edges, corners apart": (-0.37, 0.9, 0.65),
    "rim on a row of edges": (-0.4, 1.3, 0.65),
    "rim on rim": (-0.4, 1.3, 0.25),
}


@pytest.mark.parametrize("name", UPRIGHT)
def test_sheets_that_pass_through_each_other_along_edges(name: str) -> None:
    """Once as cloth with itself, once as cloth with an avatar."""
    upright = grid(UPRIGHT[name], 0, 1)
    x, faces = stacked([LEVEL, upright])
    expected = crossing_in_rationals(x, faces)
    found = crossings_within(x, faces, np.arange(len(x), dtype=np.int32))
    assert set(map(tuple, found.tolist())) == expected
    assert len(expected) >= 16
    crossings = Auditor(*upright).audit(*LEVEL, np.arange(len(LEVEL[0]), dtype=np.int32))
    count = len(LEVEL[1])
    assert set(map(tuple, (crossings.avatar + np.array([0, count])).tolist())) == expected


def test_sheets_laid_on_each_other_exactly() -> None:
    """No gap at all is no gap: faces of one plane count where they overlap, neighbours in a sheet do not."""
    patch = (0.4 * LEVEL[0] + np.array([0.013, 0.6 * 1.3, 0.4]), LEVEL[1])
    x, faces = stacked([LEVEL, patch])
    assert x[:81, 1].min() == x[:81, 1].max()
    x[81:, 1] = x[0, 1]
    weld = np.arange(len(x), dtype=np.int32)
    found = crossings_within(x, faces, weld)
    assert set(map(tuple, found.tolist())) == crossing_in_rationals(x, faces)
    assert len(found) > len(LEVEL[1])
    x[81:, 1] = np.nextafter(x[0, 1], 2.0)
    assert len(crossings_within(x, faces, weld)) == 0


@pytest.mark.parametrize("seed", range(3))
def test_fcl_finds_the_same(seed: int) -> None:
    random = np.random.default_rng(seed)
    x, faces = crumpled(random, 22, 0.02, 0.4)
    body, body_faces = crumpled(random, 22, 0.02, 0.4)
    one, other = (
        fcl.CollisionObject(bvh_model(*surface), fcl.Transform())
        for surface in ((x, faces), (body, body_faces))
    )
    found = pairs_between(x, faces, body, body_faces)
    assert np.array_equal(found, crossing_faces(one, other)) and len(found) > 100


def test_more_pairs_than_there_is_room_for_at_first() -> None:
    """A grid of upright triangles: every one along crosses every one across."""
    count = 80
    k = np.arange(count, dtype=np.float64)
    low, high, zero = np.full(count, -1.0), np.full(count, 2.0 * count), np.zeros(count)
    along = np.stack(
        [np.column_stack(c) for c in ((low, zero, k), (high, zero, k), (low, 3 * high, k))], axis=1
    )
    across = np.stack(
        [np.column_stack(c) for c in ((k, zero + 1, low), (k, zero + 1, high), (k, 3 * high, low))], axis=1
    )
    faces = np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    found = pairs_between(along.reshape(-1, 3).copy(), faces, across.reshape(-1, 3).copy(), faces)
    assert count * count > PAIRS
    assert np.array_equal(found, np.stack(np.divmod(np.arange(count * count), count), axis=1))


def test_rational_referee_knows_right_angles() -> None:
    """The referee itself, on what can be checked in the head."""
    flat = exact(np.array([(0, 0, 0), (2, 0, 0), (0, 2, 0)], float))
    upright = exact(np.array([(0.5, 0.5, -1), (0.5, 0.5, 1), (3, 3, 0)], float))
    assert common_corners(upright, flat) == set(exact(np.array([(0.5, 0.5, 0), (1, 1, 0)], float)))
    assert common_corners(exact(np.array([(0, 0, 1), (2, 0, 1), (0, 2, 1)], float)), flat) == set()
    assert cross(*exact(np.eye(3)[:2])) == exact(np.eye(3))[2]
