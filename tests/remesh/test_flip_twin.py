"""The flip criterion against in-circle determinants, and flipped meshes against scipy's triangulation."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import sqrtm
from scipy.spatial import Delaunay

from tests.remesh.cloth_samples import cloth, own_frames
from toile.geometry.arrays import Float, Int
from toile.geometry.topology import triangle_topology
from toile.remesh.adapt import flip
from toile.remesh.adapt.acceptance import Gate
from toile.remesh.adapt.flip import FLIP_MARGIN, WELL_SHAPED, flip_edges
from toile.remesh.adapt.mesh_in_work import MeshInWork
from toile.remesh.mesh.cloth_mesh import ClothMesh

TWO_FACES = np.array([[0, 1, 2], [3, 2, 1]], np.int32)
"""The quad a, b, c, d with its diagonal bc."""


def random_tensor(random: np.random.Generator, largest: float) -> Float:
    """A metric of the plane whose wanted lengths differ by up to `largest` squared, shape (2, 2)."""
    turn = np.linalg.qr(random.normal(size=(2, 2)))[0]
    return np.asarray(turn @ np.diag(np.exp(random.uniform(-1, 1, 2) * np.log(largest))) @ turn.T)


def convex_quad(random: np.random.Generator) -> Float:
    """Corners a, b, d, c counter-clockwise, given as a, b, c, d, shape (4, 2)."""
    angle = np.sort(random.uniform(0, 2 * np.pi, 4))
    radius = np.exp(random.uniform(-0.3, 0.3, (4, 1)))
    points = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.asarray(points[[0, 1, 3, 2]])


def mapped(points: Float, tensor: Float) -> Float:
    """Points of the plane where the metric is the common one: by the tensor's symmetric square root."""
    return np.asarray(points @ np.real(sqrtm(tensor)))


def in_circle(points: Float) -> float:
    """Positive where d lies within the circle through the counter-clockwise a, b, c (4 points)."""
    a, b, c, d = points
    rows = np.array([[*(p - d), (p - d) @ (p - d)] for p in (a, b, c)])
    return float(np.linalg.det(rows))


def angle_excess(points: Float) -> float:
    """How far the angles at a and d together exceed 180 degrees, from the law of cosines [rad]."""
    a, b, c, d = points
    total = 0.0
    for apex in (a, d):
        p, q, r = (float(np.linalg.norm(side)) for side in (b - apex, c - apex, b - c))
        total += float(np.arccos(np.clip((p * p + q * q - r * r) / (2 * p * q), -1.0, 1.0)))
    return total - np.pi


def area(p: Float, q: Float, r: Float) -> float:
    (ux, uy), (vx, vy) = q - p, r - p
    return 0.5 * float(ux * vy - uy * vx)


def aspect(p: Float, q: Float, r: Float) -> float:
    """1 if equilateral, 0 if flat."""
    around = sum(float(np.linalg.norm(side)) for side in (q - p, r - q, p - r))
    return 12 * 3**0.5 * area(p, q, r) / around**2


def two_faces(points: Float, tensors: Float) -> tuple[ClothMesh, Float]:
    """The quad with metrics so small that no edge has to be split, and these metrics."""
    mesh = cloth(np.column_stack([points, np.zeros(len(points))]), TWO_FACES)
    lifted = np.zeros((4, 3, 3))
    lifted[:, :2, :2] = 1e-6 * tensors
    return mesh, lifted


def flips(mesh: ClothMesh, tensors: Float) -> bool:
    return flip_edges(MeshInWork.start(mesh, tensors), Gate(None)) > 0


@pytest.mark.parametrize("largest", [1.0, 3.0, 30.0])
def test_random_quads_flip_where_the_far_corner_is_in_the_circle(largest: float) -> None:
    """In the mean metric of the four corners; angles that exceed 180 degrees together mean the same."""
    random = np.random.default_rng(int(largest))
    count = {True: 0, False: 0}
    while min(count.values()) < 100:
        points = convex_quad(random)
        tensors = np.array([random_tensor(random, largest) for _ in range(4)])
        seen = mapped(points, tensors.mean(axis=0))
        excess = angle_excess(seen)
        a, b, c, d = points
        if min(area(a, b, c), area(d, c, b), area(a, b, d), area(a, d, c)) <= 0.0:
            continue
        delaunay = in_circle(seen) <= 0.0
        assert delaunay == (excess <= 0.0) or abs(excess) < 1e-9
        if abs(np.sin(excess) - FLIP_MARGIN) < 1e-9 or not well_shaped(points, tensors):
            continue
        mesh, lifted = two_faces(points, tensors)
        count[delaunay] += 1
        assert flips(mesh, lifted) == (np.sin(excess) > FLIP_MARGIN)
        if np.sin(excess) > FLIP_MARGIN:
            assert not delaunay


def well_shaped(points: Float, tensors: Float) -> bool:
    """Tell whether the new triangles are no worse than the bound or the old ones, each in its own metric."""
    shapes = []
    for triangle in ([0, 1, 2], [3, 2, 1], [0, 1, 3], [0, 3, 2]):
        shapes.append(aspect(*mapped(points[triangle], tensors[triangle].mean(axis=0))))
    return min(shapes[2:]) > min(WELL_SHAPED, *shapes[:2]) + 1e-9


def test_the_criterion_is_the_same_wherever_the_quad_lies_in_rest_space() -> None:
    """Turned and moved in space together with its metrics, with other frames and first corners."""
    random = np.random.default_rng(7)
    for _ in range(200):
        points, turn = convex_quad(random), np.linalg.qr(random.normal(size=(3, 3)))[0]
        mesh, tensors = two_faces(points, np.array([random_tensor(random, 5.0) for _ in range(4)]))
        if mesh.rest_area.min() <= 0.0:
            continue
        turn *= np.linalg.det(turn)
        rest = np.ascontiguousarray(mesh.rest @ turn.T + random.normal(size=3))
        faces = np.stack([np.roll(face, random.integers(3)) for face in mesh.faces]).astype(np.int32)
        moved = cloth(rest, faces, frames=own_frames(rest, faces))
        assert flips(moved, turn @ tensors @ turn.T) == flips(mesh, tensors)


def ring_and_inside(random: np.random.Generator, count: int) -> Float:
    """Points on a circle and within it, so that every triangulation has the same border, shape (k, 2)."""
    angle = 2 * np.pi * (np.arange(count) + random.uniform(-0.3, 0.3, count)) / count
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    inside = 0.9 * random.uniform(-1, 1, (count * count // 4, 2))
    return np.concatenate([ring, inside[np.linalg.norm(inside, axis=1) < 0.85]])


def triangles(points: Float) -> Int:
    """Counter-clockwise Delaunay triangles."""
    faces = Delaunay(points).simplices.astype(np.int32)
    inverted = [area(*points[face]) < 0.0 for face in faces]
    faces[inverted] = faces[inverted, ::-1]
    return np.asarray(faces, np.int32)


def flipped(seed: int, largest: float) -> tuple[Int, Float]:
    """Faces after flips under a constant tensor from the triangulation for another, and the mapped points."""
    random = np.random.default_rng([seed, int(largest)])
    points, tensor = ring_and_inside(random, 16), random_tensor(random, largest)
    start = triangles(mapped(points, random_tensor(random, 4.0)))
    mesh = cloth(np.column_stack([points, np.zeros(len(points))]), start)
    lifted = np.zeros((len(points), 3, 3))
    lifted[:, :2, :2] = 1e-6 * tensor
    work = MeshInWork.start(mesh, lifted)
    assert flip_edges(work, Gate(None)) > 0
    assert replace(mesh, faces=work.faces).rest_area.min() > 0.0
    return work.faces, mapped(points, tensor)


@pytest.mark.parametrize("largest", [1.0, 2.0, 4.0, 10.0])
@pytest.mark.parametrize("seed", range(4))
def test_flips_without_margin_give_the_triangulation_of_the_mapped_points(
    seed: int, largest: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(flip, "FLIP_MARGIN", 1e-9)
    monkeypatch.setattr(flip, "WELL_SHAPED", 0.0)
    faces, seen = flipped(seed, largest)
    assert edge_set(faces) == edge_set(triangles(seen))


@pytest.mark.parametrize("largest", [1.0, 2.0, 4.0, 10.0])
@pytest.mark.parametrize("seed", range(4))
def test_what_flips_leave_is_within_the_margin_or_would_be_too_thin(seed: int, largest: float) -> None:
    faces, seen = flipped(seed, largest)
    edges, wanted = edge_set(faces), edge_set(triangles(seen))
    left = 0
    for edge in edges - {(int(p), int(q)) for p, q in triangle_topology(faces).border_edges}:
        quad = seen[quad_at(faces, edge)]
        near = 0.0 < angle_excess(quad) and in_circle(quad) > 0.0
        assert not near or np.sin(angle_excess(quad)) < FLIP_MARGIN + 1e-9 or blocked(quad), edge
        left += near
    assert (edges == wanted) == (left == 0)
    assert len(edges & wanted) > 0.9 * len(wanted)


def blocked(quad: Float) -> bool:
    """Tell whether flipping bc would make a triangle too thin."""
    a, b, c, d = quad
    new, old = min(aspect(a, b, d), aspect(a, d, c)), min(aspect(a, b, c), aspect(d, c, b))
    return new < min(WELL_SHAPED, old)


def edge_set(faces: Int) -> set[tuple[int, int]]:
    return {(int(p), int(q)) for p, q in triangle_topology(faces).edges}


def quad_at(faces: Int, edge: tuple[int, int]) -> list[int]:
    """Corners a, b, c, d of the two faces at edge bc, a, b, c counter-clockwise."""
    for face in faces.tolist():
        for k in range(3):
            if {face[k - 1], face[k - 2]} == set(edge):
                a, b, c = face[k], face[(k + 1) % 3], face[(k + 2) % 3]
                others = [other for other in faces.tolist() if {b, c} <= set(other) and a not in other]
                return [a, b, c, next(q for q in others[0] if q not in edge)]
    raise AssertionError(f"no edge {edge}")
