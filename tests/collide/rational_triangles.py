"""Where two triangles meet, in rational arithmetic: one is cut by the plane and the sides of the other."""

import itertools
from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from toile.geometry.arrays import Float, Int

Point = tuple[Fraction, ...]


def exact(points: Float) -> list[Point]:
    """Rows of floating-point numbers as what they are."""
    return [tuple(Fraction(float(value)) for value in point) for point in points]


def _minus(a: Point, b: Point) -> Point:
    return tuple(x - y for x, y in zip(a, b, strict=True))


def _dot(a: Point, b: Point) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def cross(a: Point, b: Point) -> Point:
    return tuple(a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3] for k in range(3))


def normal(face: Sequence[Point]) -> Point:
    return cross(_minus(face[1], face[0]), _minus(face[2], face[0]))


def _cut(polygon: list[Point], origin: Point, along: Point) -> list[Point]:
    """The part of a convex polygon, segment or point that lies in a closed half-space."""
    heights = [_dot(_minus(point, origin), along) for point in polygon]
    kept = []
    for k, point in enumerate(polygon):
        if heights[k] >= 0:
            kept.append(point)
        following = (k + 1) % len(polygon)
        if heights[k] * heights[following] < 0:
            share = heights[k] / (heights[k] - heights[following])
            way = _minus(polygon[following], point)
            kept.append(tuple(x + share * y for x, y in zip(point, way, strict=True)))
    return kept


def common_corners(one: Sequence[Point], other: Sequence[Point]) -> set[Point]:
    """Corners of what two closed triangles have in common; the second must have an area."""
    up = normal(other)
    assert any(up)
    left = _cut(_cut(list(one), other[0], up), other[0], tuple(-x for x in up))
    for k in range(3):
        if left:
            inward = cross(up, _minus(other[(k + 1) % 3], other[k]))
            left = _cut(left, other[k], inward)
    return set(left)


def crossing_between(a: Float, faces_a: Int, b: Float, faces_b: Int) -> set[tuple[int, int]]:
    """Pairs of a face of one surface and a face of another that have a point in common."""
    low_a, high_a = a[faces_a].min(axis=1), a[faces_a].max(axis=1)
    low_b, high_b = b[faces_b].min(axis=1), b[faces_b].max(axis=1)
    close = (low_a[:, None] <= high_b[None]).all(axis=2) & (low_b[None] <= high_a[:, None]).all(axis=2)
    return {
        (int(i), int(j))
        for i, j in zip(*np.nonzero(close), strict=True)
        if common_corners(exact(a[faces_a[i]]), exact(b[faces_b[j]]))
    }


def crossing_in_rationals(x: Float, faces: Int) -> set[tuple[int, int]]:
    """Pairs of faces of a surface with a point in common that is no corner of both, no neighbours."""
    points = exact(x)
    low, high = x[faces].min(axis=1), x[faces].max(axis=1)
    found = set()
    for i, j in itertools.combinations(range(len(faces)), 2):
        if (low[i] <= high[j]).all() and (low[j] <= high[i]).all():
            common = {points[v] for v in set(faces[i].tolist()) & set(faces[j].tolist())}
            if len(common) < 2:
                one, other = [points[v] for v in faces[i]], [points[v] for v in faces[j]]
                if common_corners(one, other) - common:
                    found.add((i, j))
    return found
