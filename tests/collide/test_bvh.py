"""The hierarchy finds exactly the box pairs that brute force finds."""

import numpy as np
import pytest

from toile.collide import bvh
from toile.geometry.arrays import Float, Int


def random_boxes(generator: np.random.Generator, count: int, size: float) -> Float:
    """Boxes in the unit cube, some of them flat or points."""
    low = generator.uniform(size=(count, 3))
    extent = generator.uniform(0.0, size, size=(count, 3)) * generator.integers(0, 2, size=(count, 3))
    return np.concatenate([low, low + extent], axis=1)


def all_overlaps(a: Float, b: Float) -> set[tuple[int, int]]:
    """Index pairs of closed boxes that meet."""
    meet = (a[:, None, :3] <= b[None, :, 3:]).all(axis=2) & (b[None, :, :3] <= a[:, None, 3:]).all(axis=2)
    return {(int(i), int(j)) for i, j in zip(*np.nonzero(meet), strict=True)}


def once(pairs: Int) -> set[tuple[int, int]]:
    """Pairs as a set; fails where one is listed twice."""
    found = {(int(a), int(b)) for a, b in pairs}
    assert len(found) == len(pairs)
    return found


def once_unordered(pairs: Int) -> set[tuple[int, int]]:
    """Pairs with the smaller index first; fails where one is listed twice, also the other way round."""
    return once(np.sort(pairs, axis=1))


@pytest.mark.parametrize("count", [1, 5, 33, 200])
def test_moving_boxes_that_meet_are_never_missed(count: int) -> None:
    """Twin: the boxes at many times; what an axis keeps apart at both ends is not listed."""
    generator = np.random.default_rng(count)
    start, way = random_boxes(generator, count, 0.2), generator.uniform(-1.0, 1.0, (count, 3))
    end = start + np.tile(way, 2) + generator.uniform(0.0, 0.1, (count, 6)) * [-1, -1, -1, 1, 1, 1]
    moving = np.concatenate([start, end], axis=1)
    found = once_unordered(bvh.self_overlapping_pairs(bvh.build(moving), moving))
    met = set()
    for pace in np.linspace(0.0, 1.0, 101):
        now = (1.0 - pace) * start + pace * end
        met |= {(i, j) for i, j in all_overlaps(now, now) if i < j}
    assert met <= found
    for i, j in found:
        before, after = start[i, :3] - start[j, 3:], end[i, :3] - end[j, 3:]
        behind, later = start[j, :3] - start[i, 3:], end[j, :3] - end[i, 3:]
        assert not ((before > 0.0) & (after > 0.0)).any() and not ((behind > 0.0) & (later > 0.0)).any()


@pytest.mark.parametrize("count", [1, 2, 4, 5, 33, 400])
@pytest.mark.parametrize("size", [0.0, 0.05, 0.8])
def test_pairs_between_two_sets(count: int, size: float) -> None:
    generator = np.random.default_rng(count)
    a, b = random_boxes(generator, count, size), random_boxes(generator, 3 * count + 1, size)
    assert once(bvh.overlapping_pairs(bvh.build(a), a, bvh.build(b), b)) == all_overlaps(a, b)


@pytest.mark.parametrize("count", [1, 2, 4, 5, 33, 400])
@pytest.mark.parametrize("size", [0.0, 0.05, 0.8])
def test_pairs_within_one_set(count: int, size: float) -> None:
    boxes = random_boxes(np.random.default_rng(count), count, size)
    expected = {(i, j) for i, j in all_overlaps(boxes, boxes) if i < j}
    assert once_unordered(bvh.self_overlapping_pairs(bvh.build(boxes), boxes)) == expected


def test_pairs_after_a_refit_far_from_the_shape_that_was_built() -> None:
    generator = np.random.default_rng(7)
    boxes = random_boxes(generator, 200, 0.1)
    other = random_boxes(generator, 150, 0.1)
    tree, other_tree = bvh.build(boxes), bvh.build(other)
    for _ in range(3):
        boxes = random_boxes(generator, 200, 0.1)
        bvh.refit(tree, boxes)
        expected = {(i, j) for i, j in all_overlaps(boxes, boxes) if i < j}
        assert once_unordered(bvh.self_overlapping_pairs(tree, boxes)) == expected
        assert once(bvh.overlapping_pairs(tree, boxes, other_tree, other)) == all_overlaps(boxes, other)


def test_boxes_that_coincide_and_boxes_that_only_touch() -> None:
    same = np.tile([0.0, 0.0, 0.0, 1.0, 1.0, 1.0], (300, 1))
    assert len(once_unordered(bvh.self_overlapping_pairs(bvh.build(same), same))) == 300 * 299 // 2
    row = np.zeros((50, 6))
    row[:, 0], row[:, 3] = np.arange(50), np.arange(1, 51)
    assert once_unordered(bvh.self_overlapping_pairs(bvh.build(row), row)) == {(i, i + 1) for i in range(49)}


def test_sorted_input_and_far_outliers_keep_the_tree_shallow_enough() -> None:
    boxes = np.zeros((5000, 6))
    boxes[:, 0] = 2.0 ** (np.arange(5000) / 10.0 - 250.0)
    boxes[:, 3:] = boxes[:, :3]
    tree = bvh.build(boxes)
    assert sorted(tree.order) == list(range(5000))
    assert once_unordered(bvh.self_overlapping_pairs(tree, boxes)) == set()


def test_the_result_is_the_same_every_time() -> None:
    boxes = random_boxes(np.random.default_rng(3), 300, 0.1)
    first = bvh.self_overlapping_pairs(bvh.build(boxes), boxes)
    assert np.array_equal(first, bvh.self_overlapping_pairs(bvh.build(boxes.copy()), boxes.copy()))
