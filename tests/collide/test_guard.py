"""The guard: the shortened motion lets no pair meet, and what need not be held back is not."""

import numpy as np
import pytest

from tests.collide.rational_triangles import crossing_in_rationals
from tests.collide.surfaces import (
    all_edge_edges,
    all_vertex_faces,
    crumpled,
    edges_of,
    sheet,
    stacked,
    vertices,
)
from tests.collide.test_candidates import distance
from tests.collide.test_crossings import UPRIGHT, grid
from toile.collide import guard
from toile.collide.audit import crossings_within
from toile.collide.avatar_surface import AvatarSurface
from toile.collide.guard import FLOOR, KEPT_SHARE, safe_factors
from toile.collide.search import ContactSearch
from toile.geometry.arrays import Float, Int

ipctk = pytest.importorskip("ipctk")

NONE = np.empty((0, 4), np.int32)


def all_pairs(positions: Float, faces: Int) -> tuple[Int, Int]:
    return all_vertex_faces(vertices(len(positions)), faces), all_edge_edges(edges_of(faces))


def comes_closer(p: Float, move: Float, row: Int, kind: int, limit: float) -> bool:
    """Whether a pair comes closer than `limit` on the way: steps no longer than the distance allows."""
    local, way, first = p[row], move[row] - move[row].mean(axis=0), vertices(4)
    speed = np.linalg.norm(way, axis=1)
    split = 1 if kind == 0 else 2
    closing = float(speed[:split].max() + speed[split:].max())
    time = 0.0
    while time <= 1.0:
        left = distance(local + time * way, first, kind) - limit
        if left <= 0.0:
            return True
        if left >= closing:
            return False
        time += max(0.999 * left / closing, 1e-12)
    return False


def collisions(p: Float, move: Float, vertex_face: Int, edge_edge: Int) -> list[tuple[int, ...]]:
    """Pairs that meet, by additive CCD; its rare false alarms on parallel edges need a second opinion.

    It reports a pair once the distance falls to a tenth, so silence means more than "did not touch".
    """
    ccd = ipctk.AdditiveCCD(conservative_rescaling=0.9)
    end = p + move
    found = []
    for kind, rows, test in (
        (0, vertex_face, ccd.point_triangle_ccd),
        (1, edge_edge, ccd.edge_edge_ccd),
    ):
        for row in rows:
            if test(*p[row], *end[row])[0]:
                limit = 0.5 * KEPT_SHARE * distance(p, row, kind)
                if comes_closer(p, move, row, kind, limit):
                    found.append((kind, *(int(v) for v in row)))
    return found


def free_of_crossings(positions: Float, faces: Int) -> bool:
    edges = edges_of(faces)
    return not any(
        ipctk.is_edge_intersecting_triangle(*positions[edge], *positions[face])
        for face in faces
        for edge in edges
        if not set(edge.tolist()) & set(face.tolist())
    )


def layers(generator: np.random.Generator, count: int) -> tuple[Float, Int]:
    """Rough parallel sheets with gaps from 1 um to 1 cm, somewhere in space."""
    gap = 10.0 ** generator.uniform(-6, -2)
    parts = []
    for level in range(2 + int(generator.integers(0, 2))):
        points, faces = sheet(count, 0.02)
        points[:, [0, 2]] += generator.normal(scale=0.005, size=(len(points), 2))
        points[:, 1] = gap * (level + generator.uniform(-0.45, 0.45, size=len(points)))
        parts.append((points, faces))
    points, faces = stacked(parts)
    turn = np.linalg.qr(generator.normal(size=(3, 3)))[0]
    return np.ascontiguousarray(points @ turn.T + generator.uniform(-1, 1, size=3)), faces


def tangle(generator: np.random.Generator) -> tuple[Float, Int]:
    """Pieces that stick into each other's neighbourhood from all sides, without crossing."""
    while True:
        parts = [crumpled(generator, 2, 0.02, 0.4) for _ in range(3)]
        points, faces = stacked([(p + generator.normal(scale=0.01, size=3), f) for p, f in parts])
        if free_of_crossings(points, faces):
            return points, faces


def wanted(generator: np.random.Generator, points: Float) -> Float:
    """A motion: noise, common motion with a little noise, collapse, or rotation; slow to very fast."""
    size = 10.0 ** generator.uniform(-4, 1)
    noise = generator.normal(size=points.shape)
    kind = generator.integers(0, 4)
    centre = points.mean(axis=0)
    if kind == 0:
        move = size * noise
    elif kind == 1:
        move = size * generator.normal(size=3) + 10.0 ** generator.uniform(-5, -2) * noise
    elif kind == 2:
        move = -generator.uniform(0.5, 3.0) * (points - centre) + 1e-3 * noise
    else:
        move = (points - centre) @ np.linalg.qr(generator.normal(size=(3, 3)))[0].T - (points - centre)
    still = generator.uniform(size=len(points)) < generator.choice([0.0, 0.3])
    move[still] = 0.0
    return np.ascontiguousarray(move)


@pytest.mark.parametrize("sweeps", [60, 3, 0])
@pytest.mark.parametrize("shape", ["layers", "tangle"])
def test_no_pair_meets(shape: str, sweeps: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Thousands of small scenes; with few sweeps the fixed middle planes of the last sweep must hold."""
    monkeypatch.setattr(guard, "MAX_SWEEPS", sweeps)
    generator = np.random.default_rng([sweeps, len(shape)])
    limited = 0
    for _ in range(350):
        points, faces = layers(generator, 2) if shape == "layers" else tangle(generator)
        pairs = all_pairs(points, faces)
        for _ in range(2):
            move = wanted(generator, points)
            factor = safe_factors(points, move, *pairs)
            assert factor.min() >= 0.0 and factor.max() <= 1.0
            limited += int((factor < 1.0).any())
            assert collisions(points, factor[:, None] * move, *pairs) == []
    assert limited > 200


def test_larger_sheets_keep_their_share_of_distance_at_every_instant() -> None:
    generator = np.random.default_rng(4)
    for _ in range(8):
        points, faces = layers(generator, 4)
        pairs = all_pairs(points, faces)
        move = wanted(generator, points)
        move *= safe_factors(points, move, *pairs)[:, None]
        assert collisions(points, move, *pairs) == []
        for kind, rows in enumerate(pairs):
            for row in rows[generator.integers(0, len(rows), 60)]:
                start = distance(points, row, kind)
                kept = min(distance(points + t * move, row, kind) for t in np.linspace(0, 1, 40))
                assert kept >= min(KEPT_SHARE * start, FLOOR) * (1 - 1e-6) - 1e-13


def test_the_candidates_of_the_search_are_enough() -> None:
    """Search and guard together, as a step uses them: many moves in a row, checked against all pairs."""
    generator = np.random.default_rng(9)
    points, faces = layers(generator, 4)
    body, body_faces = sheet(4, 0.03)
    centre, normal = points.mean(axis=0), np.linalg.svd(points - points.mean(axis=0))[2][2]
    across = np.linalg.svd(points - centre)[2][:2]
    body = np.ascontiguousarray(
        centre - 0.03 * normal + (body[:, [0]] - 0.045) * across[0] + (body[:, [2]] - 0.045) * across[1]
    )
    search = ContactSearch(
        faces,
        np.arange(len(points), dtype=np.int32),
        AvatarSurface(body, body_faces),
        self_contact=True,
        radius_self=0.002,
        radius_body=0.002,
    )
    whole_faces = np.concatenate([faces, body_faces + len(points)])
    x = points.copy()
    for _ in range(12):
        move = 0.004 * generator.normal(size=x.shape) - 0.006 * normal
        length = np.linalg.norm(move, axis=1)
        if not (search.allowance(x) >= length).all():
            search.search(x, 1.3 * length + 5e-4)
        search.place(x)
        p = search.positions.copy()
        motion = np.concatenate([move, np.zeros_like(body)])
        vertex_face, edge_edge = (
            np.concatenate(both) for both in zip(search.body, search.cloth, strict=True)
        )
        motion *= safe_factors(p, motion, vertex_face, edge_edge)[:, None]
        assert collisions(p, motion, *all_pairs(p, whole_faces)) == []
        x = x + motion[: len(x)]
    assert search.rebuilds > 1


@pytest.mark.parametrize("place", UPRIGHT.values(), ids=list(UPRIGHT))
def test_sheets_do_not_pass_through_each_other_along_edges(place: tuple[float, float, float]) -> None:
    """Edges fall on edges, or within faces: the sheet pressed on the other stops, and nothing meets."""
    upright, faces = grid(place, 0, 1, 4)
    level, level_faces = grid((-0.4, 1.3, 0.25), 0, 2, 4)
    upright[:, 1] += 1.3 - upright[:, 1].min() + 0.01
    x, both = stacked([(level, level_faces), (upright, faces)])
    pairs = all_pairs(x, both)
    for _ in range(8):
        move = np.zeros_like(x)
        move[len(level) :, 1] = -0.45
        move *= safe_factors(x, move, *pairs)[:, None]
        assert collisions(x, move, *pairs) == []
        x = x + move
        assert crossing_in_rationals(x, both) == set()
        assert len(crossings_within(x, both, vertices(len(x)))) == 0
    on_level = x[len(level) :][(x[len(level) :, 2] >= 0.25) & (x[len(level) :, 2] <= 1.05)]
    assert 1.3 < on_level[:, 1].min() < 1.301


def test_nearly_parallel_edges_do_not_slip_through() -> None:
    generator = np.random.default_rng(8)
    row = np.array([[0, 1, 2, 3]], np.int32)
    for _ in range(800):
        angle, gap = 10.0 ** generator.uniform(-9, -2), 10.0 ** generator.uniform(-7, -3)
        shift = generator.uniform(-0.008, 0.008)
        along = 0.01 * np.array([np.cos(angle), 0.0, np.sin(angle)])
        over = np.array([shift, gap, 0.0])
        p = np.array([(-0.01, 0.0, 0.0), (0.01, 0.0, 0.0), over - along, over + along])
        move = 10.0 ** generator.uniform(-9, -3) * generator.normal(size=(4, 3))
        move[2:, 1] -= 10.0 ** generator.uniform(-7, -1)
        turn = np.linalg.qr(generator.normal(size=(3, 3)))[0]
        p, move = np.ascontiguousarray(p @ turn.T), np.ascontiguousarray(move @ turn.T)
        factor = safe_factors(p, move, NONE, row)
        assert collisions(p, factor[:, None] * move, NONE, row) == []


@pytest.mark.parametrize("speed", [1e-3, 1.0, 100.0])
def test_common_motion_is_not_limited(speed: float) -> None:
    generator = np.random.default_rng(1)
    for _ in range(50):
        points, faces = layers(generator, 3)
        move = np.tile(speed * generator.normal(size=3), (len(points), 1))
        assert safe_factors(points, move, *all_pairs(points, faces)) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("gap", [1e-4, 1e-3, 1e-2])
def test_sliding_and_parting(gap: float) -> None:
    """Parting is free; sliding is free up to the faces ahead, at least by 1.6 gaps."""
    flat, faces = sheet(4, 0.02)
    points, both = stacked([(flat, faces), (flat + np.array([0.003, gap, 0.004]), faces)])
    move = np.zeros_like(points)
    top = np.arange(len(points)) >= len(flat)
    pairs = all_pairs(points, both)
    move[top] = (0.0, 2.0, 0.0)
    assert (safe_factors(points, move, *pairs) == 1.0).all()
    for angle in np.linspace(0.0, 2.0 * np.pi, 25):
        move[top] = (1.59 * gap * np.cos(angle), 0.0, 1.59 * gap * np.sin(angle))
        assert (safe_factors(points, move, *pairs) == 1.0).all()


def test_approach_stops_at_the_kept_share() -> None:
    flat, faces = sheet(3, 0.02)
    for gap, left in ((1e-2, KEPT_SHARE * 1e-2), (5e-5, FLOOR), (1e-5, 1e-5)):
        points, both = stacked([(flat, faces), (flat + np.array([0.0, gap, 0.0]), faces)])
        move = np.zeros_like(points)
        move[9:, 1] = -1.0
        moved = points + safe_factors(points, move, *all_pairs(points, both))[:, None] * move
        assert (moved[9:, 1] == pytest.approx(left, rel=1e-6)) and (moved[:9] == points[:9]).all()


def test_a_tall_stack_falls_together() -> None:
    """More layers than sweeps, pairs listed from the top down: still safe, and the rest keeps moving."""
    flat, faces = sheet(2, 0.02)
    count = 80
    points, stack = stacked([(flat + np.array([0.0, 1e-3 * (count - k), 0.0]), faces) for k in range(count)])
    move = np.zeros_like(points)
    move[: 4 * (count - 1), 1] = -0.01
    rows = [[v for v in range(4 * k, 4 * k + 4) for _ in (0, 1)] for k in range(count - 1)]
    vertex_face = np.array(
        [(v, *stack[2 * (k + 1) + i % 2]) for k, row in enumerate(rows) for i, v in enumerate(row)], np.int32
    )
    for order in (slice(None), slice(None, None, -1)):
        pairs = np.ascontiguousarray(vertex_face[order])
        factor = safe_factors(points, move, pairs, NONE)
        assert collisions(points, factor[:, None] * move, pairs, NONE) == []
        assert factor[:4] == pytest.approx(1.0) or factor[:4].min() > 0.02


def test_the_result_is_the_same_every_time() -> None:
    generator = np.random.default_rng(2)
    points, faces = layers(generator, 4)
    move = 0.01 * generator.normal(size=points.shape)
    pairs = all_pairs(points, faces)
    first = safe_factors(points, move, *pairs)
    assert first.min() < 1.0
    again = safe_factors(points.copy(), move.copy(), pairs[0].copy(), pairs[1].copy())
    assert np.array_equal(first, again)


def test_nothing_to_meet_nothing_to_limit() -> None:
    points, _ = sheet(2, 0.02)
    assert (safe_factors(points, points + 1.0, NONE, NONE) == 1.0).all()
