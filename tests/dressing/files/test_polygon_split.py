"""Polygons become triangles that cover them once: concave ones, straight corners, holes and bent ones."""

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from toile.dressing.files.polygon_split import split_polygons
from toile.geometry.arrays import Float

L = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
STRAIGHT = [(0, 0), (1, 0), (2, 0), (2, 1), (0, 1)]
COMB = [
    (0, 0),
    (6, 0),
    (6, 3),
    (5, 3),
    (5, 1),
    (4, 1),
    (4, 3),
    (3, 3),
    (3, 1),
    (2, 1),
    (2, 3),
    (1, 3),
    (1, 1),
    (0, 1),
]
KEYHOLE = [(0, 0), (3, 0), (3, 3), (0, 3), (0, 0), (1, 1), (1, 2), (2, 2), (2, 1), (1, 1)]
TRIANGLE = [(0, 0), (1, 0), (2, 0), (3, 0), (2, 1), (1, 2), (0, 3), (0, 2), (0, 1)]


def triangles(points: npt.ArrayLike) -> Float:
    """Triangles of one polygon, shape (n - 2, 3, 3)."""
    polygon = np.asarray(points, np.float64)
    if polygon.shape[1] == 2:
        polygon = np.column_stack([polygon, np.zeros(len(polygon))])
    split = split_polygons(polygon[None])
    assert split.shape == (1, len(polygon) - 2, 3)
    return np.asarray(polygon[split[0]])


def normals(corners: Float) -> Float:
    """Normals as long as the areas."""
    return np.asarray(0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))


@pytest.mark.parametrize(
    ("points", "area"), [(L, 3), (STRAIGHT, 2), (COMB, 12), (KEYHOLE, 8), (TRIANGLE, 4.5)]
)
@pytest.mark.parametrize("is_turned", [False, True])
def test_every_first_corner_gives_the_same_area(
    points: list[tuple[int, int]], area: float, is_turned: bool
) -> None:
    """No triangle is turned over, so that none counts twice, and none has no area."""
    for first in range(len(points)):
        ring = points[first:] + points[:first]
        found = normals(triangles(ring[::-1] if is_turned else ring))[:, 2] * (-1.0 if is_turned else 1.0)
        assert found.min() > 0.01 and found.sum() == pytest.approx(area)


def test_panels_of_hundreds_of_corners_on_straight_sides() -> None:
    """A panel as sewing programs export it: one polygon, its sides of many pieces, an armhole cut out."""
    side = np.linspace(0.0, 1.0, 120, endpoint=False)
    angle = np.linspace(np.pi, 0.5 * np.pi, 60, endpoint=False)
    outline = np.vstack(
        [
            np.column_stack([side, 0.0 * side]),
            np.column_stack([1.0 + 0.0 * side, side]),
            np.column_stack([1.0 - 0.5 * side, 1.0 + 0.0 * side]),
            np.column_stack([0.5 + 0.5 * np.sin(angle - np.pi), 0.5 - 0.5 * np.cos(angle)]),
            np.column_stack([0.0 * side, 0.5 - 0.5 * side]),
        ]
    )
    x, y = outline.T
    area = 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    found = normals(triangles(outline))[:, 2]
    assert found.min() > 0.0 and found.sum() == pytest.approx(area)


def test_a_polygon_that_is_not_flat_covers_what_it_encloses_from_above() -> None:
    """An L bent along a saddle: seen from above its triangles cover 3, and all look up."""
    points = np.array([[x, y, 0.1 * (x * x - y * y)] for x, y in L])
    up = normals(triangles(points))[:, 2]
    assert up.min() > 0.0 and up.sum() == pytest.approx(3.0)


@given(
    st.lists(st.floats(0.2, 1.0), min_size=5, max_size=24),
    st.floats(0.0, 6.0), st.floats(-3.0, 3.0), st.sampled_from([1e-3, 1.0, 1e3]),
)  # fmt: skip
@settings(max_examples=60, deadline=None)
def test_stars_of_any_shape_are_covered_once(
    radii: list[float], turn: float, lean: float, scale: float
) -> None:
    angle = turn + 2.0 * np.pi * np.arange(len(radii)) / len(radii)
    flat = scale * np.array(radii)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.column_stack([flat[:, 0], np.cos(lean) * flat[:, 1], np.sin(lean) * flat[:, 1]])
    x, y = flat.T
    area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    found = normals(triangles(points)) @ (0.0, -np.sin(lean), np.cos(lean))
    assert found.min() > -1e-9 * scale**2
    assert found.sum() == pytest.approx(area, rel=1e-9)
