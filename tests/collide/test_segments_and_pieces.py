"""Segments through the avatar, and rigid pieces against each other."""

import fcl
import numpy as np
import pytest
import trimesh

from tests.collide.surfaces import sheet, stacked
from toile.collide.rigid_pieces import RigidPieces, bvh_model
from toile.collide.segments import MAX_CONTACTS, SegmentTest, crossing_faces
from toile.geometry.arrays import Float, Int

RADIUS = 0.1


def ball() -> tuple[Float, Int]:
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=RADIUS)
    return np.ascontiguousarray(mesh.vertices, np.float64), np.ascontiguousarray(mesh.faces, np.int32)


def test_segments_cross_the_surface_or_they_do_not() -> None:
    """Against a ball: one end in and one out crosses, as does passing near the centre."""
    generator = np.random.default_rng(0)
    start, end = generator.uniform(-0.2, 0.2, size=(2, 600, 3))
    along = end - start
    t = np.clip(-np.sum(start * along, axis=1) / np.sum(along**2, axis=1), 0.0, 1.0)
    nearest = np.linalg.norm(start + t[:, None] * along, axis=1)
    ends = np.linalg.norm(np.stack([start, end]), axis=2)
    expected = (nearest < RADIUS) & (ends.max(axis=0) > RADIUS)
    # The mesh lies up to 1 % inside the ball: leave out what depends on it.
    sure = (np.abs(np.stack([nearest, *ends]) / RADIUS - 1.0) > 0.011).all(axis=0)
    found = SegmentTest(ball()).crossing(start, end)
    assert np.array_equal(found[sure], expected[sure]) and sure.sum() > 400
    assert expected[sure].any() and not expected[sure].all()


@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (-1, -1, -1), (1, 1, 0)])
def test_every_direction_is_seen(direction: tuple[int, int, int]) -> None:
    way = np.array([direction], float)
    through = np.array([[0.011, 0.007, -0.005]])
    test = SegmentTest(ball())
    assert test.crossing(through, through + 0.3 * way).tolist() == [True]
    assert test.crossing(through, through + 0.02 * way).tolist() == [False]


def test_all_of_very_many_segments_are_seen() -> None:
    """More crossings than one collision query returns at first."""
    flat, faces = sheet(2, 0.02)
    layers = stacked([(flat + np.array([0.0, 1e-4 * k, 0.0]), faces) for k in range(150)])
    count = 1000
    start = np.column_stack([np.linspace(0.001, 0.008, count), np.full(count, -0.01), np.full(count, 0.003)])
    assert SegmentTest(layers).crossing(start, start + np.array([0.0, 0.1, 0.0])).all()


def test_no_segments() -> None:
    none = np.empty((0, 3))
    assert SegmentTest(ball()).crossing(none, none).shape == (0,)


def two_sheets() -> tuple[Float, Int, Int]:
    flat, faces = sheet(3, 0.05)
    flat = flat - flat.mean(axis=0)
    upright = flat[:, [1, 0, 2]] + np.array([0.012, 0.2, 0.003])
    positions, both = stacked([(flat, faces), (upright, faces)])
    return positions, both, np.repeat([0, 1], len(faces)).astype(np.int32)


def test_pieces_cross_where_they_are_shifted_to() -> None:
    pieces = RigidPieces(*two_sheets(), None)
    assert pieces.crosses_pieces(0, np.zeros(3)) == [] and not pieces.crosses_avatar(0, np.zeros(3))
    up = np.array([0.0, 0.17, 0.0])
    assert pieces.crosses_pieces(0, up) == [1] and pieces.crosses_pieces(1, -up) == [0]
    # Trying a place does not move the piece; setting its shift does, for both sides.
    assert pieces.crosses_pieces(0, np.zeros(3)) == []
    pieces.shift[0] = up
    assert pieces.crosses_pieces(0, np.zeros(3)) == [1] and pieces.crosses_pieces(1, np.zeros(3)) == [0]
    pieces.shift[1] = 2.0 * up
    assert pieces.crosses_pieces(0, np.zeros(3)) == [] and pieces.crosses_pieces(0, 2.0 * up) == [1]


def test_pieces_cross_the_avatar_surface() -> None:
    pieces = RigidPieces(*two_sheets(), ball())
    assert not pieces.crosses_avatar(1, np.zeros(3))
    assert pieces.crosses_avatar(1, np.array([0.0, -0.12, 0.0]))
    # Wholly inside is not across: the surface is what counts.
    assert not pieces.crosses_avatar(0, np.zeros(3))
    assert pieces.crosses_avatar(0, np.array([0.06, 0.0, 0.0]))


def test_more_contacts_than_the_first_limit() -> None:
    """A grid of upright triangles: every one along crosses every one across."""
    count = 270
    k = np.arange(count, dtype=np.float64)
    low, high = np.full(count, -1.0), np.full(count, 2.0 * count)
    zero, up = np.zeros(count), np.full(count, 1.0)
    along = np.stack(
        [np.column_stack(c) for c in ((low, zero, k), (high, zero, k), (low, 3 * high, k))], axis=1
    )
    across = np.stack([np.column_stack(c) for c in ((k, up, low), (k, up, high), (k, 3 * high, low))], axis=1)
    faces = np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    one, other = (
        fcl.CollisionObject(bvh_model(corners.reshape(-1, 3).copy(), faces), fcl.Transform())
        for corners in (along, across)
    )
    assert len(crossing_faces(one, other)) == count * count > MAX_CONTACTS
