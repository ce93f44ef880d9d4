"""Closest points of both pair kinds against an oracle, over closest-feature tables and random shapes."""

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from toile.collide.edge_edge import closest_parameters
from toile.collide.vertex_face import closest_barycentric
from toile.geometry.arrays import Float

ipctk = pytest.importorskip("ipctk")

OFFSETS = [1e-9, 1e-6, 1e-3, 1.0, 1e3]


def vertex_face(p: Float) -> tuple[Float, float]:
    """Weights of the closest point of face p[1:] to vertex p[0], and the distance."""
    weights = np.array(closest_barycentric(*p.ravel()))
    return weights, float(np.linalg.norm(p[0] - weights @ p[1:]))


def edge_edge(p: Float) -> tuple[Float, float]:
    """Parameters of the closest points of edges p[:2] and p[2:], and the distance."""
    s, t = closest_parameters(*p.ravel())
    return np.array([s, t]), float(np.linalg.norm(p[0] + s * (p[1] - p[0]) - p[2] - t * (p[3] - p[2])))


def point_segment(p: Float, a: Float, b: Float) -> float:
    """Distance from p to segment ab, by a formula of its own."""
    u = b - a
    t = np.clip((p - a) @ u / max(float(u @ u), 1e-300), 0.0, 1.0)
    return float(np.linalg.norm(p - a - t * u))


def oracle_vertex_face(p: Float) -> float:
    return float(np.sqrt(ipctk.point_triangle_distance(*p)))


def oracle_edge_edge(p: Float) -> float:
    return float(np.sqrt(max(ipctk.edge_edge_distance(*p), 0.0)))


def rotations(count: int) -> list[Float]:
    generator = np.random.default_rng(11)
    return [np.linalg.qr(generator.normal(size=(3, 3)))[0] for _ in range(count)]


# One place per feature of the triangle (0,0,0), (1,0,0), (0,0,1): where its closest point lies, and the
# direction from there in which the vertex stands.
FACE_FEATURES = [
    ("inside", (0.3, 0.4, 0.3), (0.0, 1.0, 0.0)),
    ("inside from below", (0.2, 0.2, 0.6), (0.0, -1.0, 0.0)),
    ("edge ab", (0.6, 0.4, 0.0), (0.0, 0.5, -1.0)),
    ("edge ac", (0.5, 0.0, 0.5), (-1.0, -0.5, 0.0)),
    ("edge bc", (0.0, 0.3, 0.7), (1.0, 0.2, 1.0)),
    ("corner a", (1.0, 0.0, 0.0), (-1.0, 0.3, -0.5)),
    ("corner b", (0.0, 1.0, 0.0), (1.0, 0.3, -0.2)),
    ("corner c", (0.0, 0.0, 1.0), (-0.2, 0.3, 1.0)),
    ("in the plane, off an edge", (0.6, 0.4, 0.0), (0.0, 0.0, -1.0)),
]


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize(
    ("where", "direction"), [row[1:] for row in FACE_FEATURES], ids=[r[0] for r in FACE_FEATURES]
)
def test_every_feature_of_a_face(
    where: tuple[float, float, float], direction: tuple[float, float, float], offset: float
) -> None:
    triangle = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
    away = np.array(direction) / np.linalg.norm(direction)
    for turn in rotations(5):
        p = np.vstack([np.array(where) @ triangle + offset * away, triangle]) @ turn.T
        weights, distance = vertex_face(p)
        assert weights == pytest.approx(where, abs=1e-9 + 1e-15 * offset)
        assert distance == pytest.approx(offset, abs=2e-15 * (1.0 + offset))
        assert oracle_vertex_face(p) == pytest.approx(offset, rel=1e-3, abs=1e-8)


# Edge u runs from (0,0,0) to (1,0,0). Per row: its parameter, edge v's, direction from u to v, v's direction.
EDGE_FEATURES = [
    ("inside, inside", 0.3, 0.6, (0.0, 1.0, 0.0), (0.3, 0.0, 1.0)),
    ("inside, inside, steep", 0.5, 0.5, (0.0, 1.0, 0.0), (1e-3, 0.0, 1.0)),
    ("inside, inside, nearly along", 0.5, 0.5, (0.0, 1.0, 0.0), (1.0, 0.0, 0.01)),
    ("start, inside", 0.0, 0.4, (-1.0, 0.5, 0.0), (0.0, 0.0, 1.0)),
    ("end, inside", 1.0, 0.4, (1.0, 0.5, 0.0), (0.0, 0.0, 1.0)),
    ("inside, start", 0.7, 0.0, (0.0, 1.0, 1.0), (0.2, 0.0, 1.0)),
    ("inside, end", 0.7, 1.0, (0.0, 1.0, -1.0), (0.2, 0.0, 1.0)),
    ("start, start", 0.0, 0.0, (-1.0, 0.2, 0.1), (-1.0, 0.3, 0.4)),
    ("start, end", 0.0, 1.0, (-1.0, 0.2, 0.1), (1.0, -0.3, -0.4)),
    ("end, start", 1.0, 0.0, (1.0, 0.2, 0.1), (1.0, 0.3, 0.4)),
    ("end, end", 1.0, 1.0, (1.0, 0.2, 0.1), (-1.0, -0.3, -0.4)),
    ("in one line", 1.0, 0.0, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
]


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize(
    ("s", "t", "direction", "along"), [r[1:] for r in EDGE_FEATURES], ids=[r[0] for r in EDGE_FEATURES]
)
def test_every_feature_of_two_edges(
    s: float,
    t: float,
    direction: tuple[float, float, float],
    along: tuple[float, float, float],
    offset: float,
) -> None:
    away = np.array(direction) / np.linalg.norm(direction)
    on_u = np.array([s, 0.0, 0.0])
    start = on_u + offset * away - t * np.array(along)
    edges = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), start, start + np.array(along)])
    for turn in rotations(5):
        p = edges @ turn.T
        parameters, distance = edge_edge(p)
        assert distance == pytest.approx(offset, abs=1e-13 * (1.0 + offset))
        if offset < 1e3:
            assert parameters == pytest.approx([s, t], abs=1e-6)


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("shift", [-1.5, -1.0, -0.4, 0.0, 0.7, 1.0, 1.8])
def test_parallel_edges(shift: float, offset: float) -> None:
    expected = np.hypot(offset, max(abs(shift) - 1.0, 0.0))
    edges = np.array([(0, 0, 0), (1, 0, 0), (shift, offset, 0), (1 + shift, offset, 0)])
    for turn in rotations(5):
        for order in ([0, 1, 2, 3], [1, 0, 2, 3], [0, 1, 3, 2], [2, 3, 0, 1]):
            _, distance = edge_edge(edges[order] @ turn.T)
            assert distance == pytest.approx(expected, abs=1e-13 * (1.0 + offset))


@pytest.mark.parametrize("gap", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("angle", [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-12])
def test_nearly_parallel_edges_that_cross(angle: float, gap: float) -> None:
    """Where rounding hides the crossing point, the edges are too parallel for it to matter."""
    edges = np.array([(0, 0, 0), (1, 0, 0), (0, gap, -0.4 * angle), (1, gap, 0.6 * angle)])
    for turn in rotations(20):
        _, distance = edge_edge(edges @ turn.T)
        assert gap - 1e-12 <= distance <= np.hypot(gap, 1e-8) + 1e-12


def test_edges_without_length() -> None:
    generator = np.random.default_rng(5)
    for _ in range(200):
        p = generator.normal(size=(4, 3))
        p[1] = p[0]
        assert edge_edge(p)[1] == pytest.approx(point_segment(p[0], p[2], p[3]), abs=1e-12)
        assert edge_edge(p[[2, 3, 0, 1]])[1] == pytest.approx(point_segment(p[0], p[2], p[3]), abs=1e-12)
        p[3] = p[2]
        assert edge_edge(p)[1] == pytest.approx(np.linalg.norm(p[0] - p[2]), abs=1e-12)


def exact_distance(p: Float) -> float:
    """Distance from p[0] to face p[1:] in rational arithmetic: above the face, or to the nearest edge."""
    q, a, b, c = ([Fraction(float(value)) for value in row] for row in p)

    def minus(x: list[Fraction], y: list[Fraction]) -> list[Fraction]:
        return [i - j for i, j in zip(x, y, strict=True)]

    def dot(x: list[Fraction], y: list[Fraction]) -> Fraction:
        return sum((i * j for i, j in zip(x, y, strict=True)), Fraction(0))

    u, v, w = minus(b, a), minus(c, a), minus(q, a)
    uu, vv, uv, uw, vw = dot(u, u), dot(v, v), dot(u, v), dot(u, w), dot(v, w)
    area = uu * vv - uv * uv
    if area > 0:
        s, t = (vv * uw - uv * vw) / area, (uu * vw - uv * uw) / area
        if s >= 0 and t >= 0 and s + t <= 1:
            rest = [w[k] - s * u[k] - t * v[k] for k in range(3)]
            return float(np.sqrt(float(dot(rest, rest))))
    squares = []
    for start, end in ((a, b), (b, c), (c, a)):
        along, to = minus(end, start), minus(q, start)
        length = dot(along, along)
        share = Fraction(0) if length == 0 else min(max(dot(along, to) / length, Fraction(0)), Fraction(1))
        rest = [to[k] - share * along[k] for k in range(3)]
        squares.append(dot(rest, rest))
    return float(np.sqrt(float(min(squares))))


@pytest.mark.parametrize("far", [1.0, 1e-2, 1e-4])
@pytest.mark.parametrize("height", [0.0, 1e-16, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-5, 1e-4, 1e-3])
def test_slivers_and_faces_without_area(height: float, far: float) -> None:
    """The textbook formula alone errs by more than the length of such a face."""
    generator = np.random.default_rng(6)
    for _ in range(250):
        a, b = generator.normal(size=(2, 3))
        c = a + generator.uniform(-0.5, 1.5) * (b - a) + height * generator.normal(size=3)
        above = generator.dirichlet(np.ones(3)) @ np.array([a, b, c])
        p = np.array([above + far * generator.normal(size=3), a, b, c])
        weights, distance = vertex_face(p)
        assert weights.min() >= -1e-12 and weights.sum() == pytest.approx(1.0)
        assert distance == pytest.approx(exact_distance(p), abs=1e-9)


def test_a_face_that_is_a_point() -> None:
    p = np.array([(1.0, 2.0, 3.0)] + [(0.0, 0.0, 0.0)] * 3)
    assert vertex_face(p)[1] == pytest.approx(np.sqrt(14.0))


@pytest.mark.parametrize(
    ("ours", "oracle"),
    [(vertex_face, oracle_vertex_face), (edge_edge, oracle_edge_edge)],
    ids=["vertex-face", "edge-edge"],
)
def test_random_pairs_of_all_sizes(
    ours: Callable[[Float], tuple[Float, float]], oracle: Callable[[Float], float]
) -> None:
    generator = np.random.default_rng(1)
    for _ in range(4000):
        size = 10.0 ** generator.uniform(-4, 1)
        p = size * generator.normal(size=(4, 3))
        p[0 if ours is vertex_face else [0, 1]] += generator.normal(size=3) * 10.0 ** generator.uniform(-4, 2)
        weights, distance = ours(p)
        assert weights.min() >= 0.0 and weights.max() <= 1.0 + 1e-15
        reach = float(np.abs(p).max())
        assert distance == pytest.approx(oracle(p), rel=1e-9, abs=1e-7 * reach)


def test_far_from_the_origin_only_rounding_is_lost() -> None:
    generator = np.random.default_rng(2)
    for _ in range(500):
        p = 0.01 * generator.normal(size=(4, 3))
        there = p + 1e3
        back = there - 1e3
        assert vertex_face(there)[1] == pytest.approx(vertex_face(back)[1], abs=1e-12)
        assert edge_edge(there)[1] == pytest.approx(edge_edge(back)[1], abs=1e-9)
