"""Flat triangulation: borders untouched, area exact, angles good, no preferred direction."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from toile.geometry.arrays import Float, Int
from toile.remesh.panel.delaunay_flip import flip_to_delaunay, neighbours_across
from toile.remesh.panel.panel_mesh import (
    PanelMesh,
    PanelMeshOptions,
    constrained_triangles,
    triangulate_panel,
)

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
L_SHAPE = np.array([[0.0, 0.0], [0.6, 0.0], [0.6, 0.2], [0.2, 0.2], [0.2, 0.5], [0.0, 0.5]])
DART = np.array([[0.0, 0.0], [0.24, 0.0], [0.25, 0.15], [0.26, 0.0], [0.5, 0.0], [0.5, 0.4], [0.0, 0.4]])
TIP = np.array([[0.0, 0.0], [0.5, 0.0], [0.5, 0.05]])


def cut(corners: Float, edge_length: float, finer: dict[int, int] | None = None) -> Float:
    """Cut polygon sides into pieces of at most `edge_length`, side i into `finer[i]` times as many."""
    sides = []
    for i, start in enumerate(corners):
        end = corners[(i + 1) % len(corners)]
        count = int(np.ceil(np.linalg.norm(end - start) / edge_length - 1e-9)) * (finer or {}).get(i, 1)
        sides.append(start + (np.arange(count) / count)[:, None] * (end - start))
    return np.concatenate(sides)


def circle(count: int) -> Float:
    angle = 2.0 * np.pi * np.arange(count) / count
    return np.column_stack([np.cos(angle), np.sin(angle)])


def areas(points: Float, faces: Int) -> Float:
    ab, ac = points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]
    return np.asarray(0.5 * (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]))


def angles(points: Float, faces: Int) -> Float:
    """Smallest angle [degrees] of each triangle, from the cosine rule."""
    corners = points[faces]
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    a, b, c = sides[:, [0, 1, 2]], sides[:, [1, 2, 0]], sides[:, [2, 0, 1]]
    cosine = (b**2 + c**2 - a**2) / (2.0 * b * c)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))).min(axis=1))


def inner_edges(mesh: PanelMesh) -> Int:
    """Edges with two triangles, shape (e, 2)."""
    edges = np.sort(np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    return np.asarray(unique[count == 2])


def check_fills(border: Float, mesh: PanelMesh) -> None:
    """Check that a mesh is a triangulation of exactly this polygon."""
    count = len(border)
    assert np.array_equal(mesh.vertices[:count], border)
    assert mesh.faces.dtype == np.int32
    area = areas(mesh.vertices, mesh.faces)
    assert area.min() > 0.0
    x, y = border.T
    assert area.sum() == pytest.approx(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y), rel=1e-12)
    edges = np.sort(np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    unique, uses = np.unique(edges, axis=0, return_counts=True)
    sides = np.sort(np.column_stack([np.arange(count), np.roll(np.arange(count), -1)]), axis=1)
    assert np.array_equal(unique[uses == 1], np.unique(sides, axis=0))
    assert uses.max() <= 2
    assert len(mesh.vertices) - len(unique) + len(mesh.faces) == 1
    assert len(np.unique(mesh.faces)) == len(mesh.vertices)


@pytest.mark.parametrize(
    ("corners", "edge_length", "smallest"),
    [
        (SQUARE, 0.05, 30.0),
        (L_SHAPE, 0.02, 30.0),
        (DART, 0.02, 28.0),
        (circle(63), 0.1, 30.0),
        (TIP, 0.01, 5.0),
    ],
)
def test_fills_with_good_triangles(corners: Float, edge_length: float, smallest: float) -> None:
    border = cut(corners, edge_length)
    mesh = triangulate_panel(border, edge_length=edge_length)
    check_fills(border, mesh)
    angle = angles(mesh.vertices, mesh.faces)
    assert angle.min() > smallest
    assert np.median(angle) > 50.0


def test_inner_edges_have_the_wanted_length() -> None:
    border = cut(SQUARE, 0.02)
    mesh = triangulate_panel(border, edge_length=0.02)
    ends = mesh.vertices[inner_edges(mesh)]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    assert lengths.mean() == pytest.approx(0.02, rel=0.03)
    assert np.percentile(lengths, 1) > 0.7 * 0.02
    assert np.percentile(lengths, 99) < 1.3 * 0.02


def test_no_preferred_direction() -> None:
    mesh = triangulate_panel(cut(SQUARE, 0.015), edge_length=0.015)
    edges = inner_edges(mesh)
    direction = mesh.vertices[edges[:, 1]] - mesh.vertices[edges[:, 0]]
    angle = np.arctan2(direction[:, 1], direction[:, 0])
    for fold in (2, 4, 6):
        assert abs(np.exp(1j * fold * angle).mean()) < 0.12


def test_grows_from_a_fine_border() -> None:
    border = cut(SQUARE, 0.05, finer={0: 5})
    mesh = triangulate_panel(border, edge_length=0.05)
    check_fills(border, mesh)
    # The corners, where a side of 1 cm meets one of 5, have the smallest.
    assert angles(mesh.vertices, mesh.faces).min() > 20.0
    height = mesh.vertices[mesh.faces].mean(axis=1)[:, 1]
    area = areas(mesh.vertices, mesh.faces)
    assert area[height < 0.02].mean() < 0.1 * area[height > 0.4].mean()


def test_a_narrow_strip_and_a_single_triangle_need_no_inner_point() -> None:
    strip = cut(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.01], [0.0, 0.01]]), 0.02)
    mesh = triangulate_panel(strip, edge_length=0.02)
    check_fills(strip, mesh)
    assert len(mesh.vertices) == len(strip)
    triangle = circle(3)
    assert len(triangulate_panel(triangle, edge_length=10.0).faces) == 1


def test_square_corners_are_not_left_to_one_triangle() -> None:
    mesh = triangulate_panel(cut(SQUARE, 0.1), edge_length=0.1)
    for corner in (0, 10, 20, 30):
        assert (mesh.faces == corner).any(axis=1).sum() >= 2


def test_random_star_shapes() -> None:
    rng = np.random.default_rng(7)
    filled = 0
    for _ in range(40):
        count = int(rng.integers(5, 20))
        angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, count))
        if np.diff(np.concatenate([angle, angle[:1] + 2.0 * np.pi])).max() > 3.0:
            continue
        corners = rng.uniform(0.2, 1.0, count)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
        border = cut(corners, 0.08, finer={0: 4})
        check_fills(border, triangulate_panel(border, edge_length=0.08))
        filled += 1
    assert filled > 20


def test_same_input_same_bytes() -> None:
    border = cut(L_SHAPE, 0.02)
    first, second = (triangulate_panel(border, edge_length=0.02) for _ in range(2))
    assert first.vertices.tobytes() == second.vertices.tobytes()
    assert first.faces.tobytes() == second.faces.tobytes()


def test_room_grows_when_a_border_asks_for_more_points_than_the_area() -> None:
    border = cut(SQUARE, 0.5, finer={0: 400})
    mesh = triangulate_panel(border, edge_length=0.5, options=PanelMeshOptions(grading=0.02))
    check_fills(border, mesh)
    assert len(mesh.vertices) > 10 * len(border)


@pytest.mark.parametrize("polygon", [SQUARE[::-1], SQUARE[[0, 2, 1, 3]]])
def test_outlines_that_cannot_be_filled(polygon: Float) -> None:
    with pytest.raises(ValueError, match="cannot be triangulated"):
        triangulate_panel(polygon, edge_length=0.1)


def test_flips_reach_the_delaunay_triangulation() -> None:
    """Twin: Qhull, on points of a convex outline, where constrained and plain Delaunay agree."""
    rng = np.random.default_rng(3)
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, 60))
    polygon = np.column_stack([np.cos(angle), np.sin(angle)]) * np.array([1.0, 0.7])
    faces = constrained_triangles(polygon)
    across = neighbours_across(faces)
    assert flip_to_delaunay(polygon, faces, across, np.empty(3 * len(faces), np.int32)) > 0
    assert np.array_equal(across, neighbours_across(faces))
    ours = {tuple(sorted(face)) for face in faces.tolist()}
    assert ours == {tuple(sorted(face)) for face in Delaunay(polygon).simplices.tolist()}


def test_neighbours_refuse_an_edge_with_three_triangles() -> None:
    with pytest.raises(ValueError, match="more than two triangles"):
        neighbours_across(np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]], dtype=np.int32))
