"""Bounding volume hierarchy in flat arrays: built once, refitted, traversed in pairs.

Boxes may move: a second box is then where each ends. Two that are apart along an axis at the start and, on
the same side, at the end are so all the way, if all move at the same pace.

Median split on the longest axis of the box centres, at most four boxes per leaf. Children come after
their parent in the arrays, so a refit is one backward loop.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import types

from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import (
    F64_2,
    I32_1,
    I32_2,
    OUT_F64_2,
    OUT_I32_1,
    OUT_I32_2,
    helper,
    kernel,
    unsigned,
)
from toile.geometry.threads.crew import in_parts, together
from toile.geometry.threads.crowd import Crowd

LEAF_SIZE = 4


class Bvh(NamedTuple):
    """Hierarchy over n boxes.

    Attributes
    ----------
    order
        Box indices, grouped by leaf, shape (n,).
    child
        Per tree node: (left, right) child, or (-1 - first, count) into `order` for a leaf, shape (k, 2).
    box
        Per tree node: lower and upper corner [m], shape (k, 6); of moving boxes at the end as well, (k, 12).
    """

    order: Int
    child: Int
    box: Float


SORTED_RUN = 8
"""Boxes that are sorted by inserting one after the other; longer runs are merged."""


@helper
def _sort(order, spare, key, first, last):  # type: ignore[no-untyped-def]
    """Sort order[first:last] by key[order[k]], equal keys in their old order (merge sort, bottom up).

    Stable, so that the tree depends on nothing but its input; np.argsort takes 1.5 s longer to compile.
    """
    for low in range(first, last, SORTED_RUN):
        for k in range(low + 1, min(low + SORTED_RUN, last)):
            one = order[k]
            i = k
            while i > low and key[order[i - 1]] > key[one]:
                order[i] = order[i - 1]
                i -= 1
            order[i] = one
    width = SORTED_RUN
    while width < last - first:
        for low in range(first, last, 2 * width):
            middle = min(low + width, last)
            high = min(low + 2 * width, last)
            # Boxes of a mesh are in order for long stretches.
            if middle == high or key[order[middle - 1]] <= key[order[middle]]:
                for k in range(low, high):
                    spare[k] = order[k]
                continue
            i = low
            j = middle
            for k in range(low, high):
                if i < middle and (j >= high or key[order[i]] <= key[order[j]]):
                    spare[k] = order[i]
                    i += 1
                else:
                    spare[k] = order[j]
                    j += 1
        for k in range(first, last):
            order[k] = spare[k]
        width *= 2


@kernel(types.int64(F64_2, OUT_I32_1, OUT_I32_2))
def _split(boxes, order, child):  # type: ignore[no-untyped-def]
    """Fill order and child; return the number of tree nodes."""
    count = boxes.shape[0]
    for i in range(count):
        order[i] = i
    key = np.empty(count, np.float64)
    spare = np.empty(count, np.int32)
    stack = np.empty((128, 3), np.int64)
    stack[0, 0], stack[0, 1], stack[0, 2] = 0, 0, count
    depth = 1
    used = 1
    while depth > 0:
        depth -= 1
        node, first, last = stack[depth, 0], stack[depth, 1], stack[depth, 2]
        if last - first <= LEAF_SIZE:
            child[node, 0] = -1 - first
            child[node, 1] = last - first
            continue
        best_axis = 0
        best_extent = -1.0
        for axis in range(3):
            low = np.inf
            high = -np.inf
            for k in range(first, last):
                c = boxes[order[k], axis] + boxes[order[k], axis + 3]
                low = min(low, c)
                high = max(high, c)
            if high - low > best_extent:
                best_extent = high - low
                best_axis = axis
        for k in range(first, last):
            key[order[k]] = boxes[order[k], best_axis] + boxes[order[k], best_axis + 3]
        _sort(order, spare, key, first, last)
        middle = (first + last) // 2
        child[node, 0] = used
        child[node, 1] = used + 1
        stack[depth, 0], stack[depth, 1], stack[depth, 2] = used, first, middle
        stack[depth + 1, 0], stack[depth + 1, 1], stack[depth + 1, 2] = used + 1, middle, last
        depth += 2
        used += 2
    return used


@kernel(types.void(F64_2, I32_1, I32_2, OUT_F64_2))
def _refit(boxes, order, child, tree_box):  # type: ignore[no-untyped-def]
    width = boxes.shape[1]
    for node in range(child.shape[0] - 1, -1, -1):
        if child[node, 0] < 0:
            first = -1 - child[node, 0]
            for time in range(0, width, 6):
                for axis in range(time, time + 3):
                    low = np.inf
                    high = -np.inf
                    for k in range(first, first + child[node, 1]):
                        low = min(low, boxes[order[k], axis])
                        high = max(high, boxes[order[k], axis + 3])
                    tree_box[node, axis] = low
                    tree_box[node, axis + 3] = high
        else:
            left = child[node, 0]
            right = child[node, 1]
            for time in range(0, width, 6):
                for axis in range(time, time + 3):
                    tree_box[node, axis] = min(tree_box[left, axis], tree_box[right, axis])
                    tree_box[node, axis + 3] = max(tree_box[left, axis + 3], tree_box[right, axis + 3])


def build(boxes: Float) -> Bvh:
    """Build the hierarchy over boxes of shape (n, 6) or (n, 12), n >= 1: lower corner, upper corner."""
    count = len(boxes)
    order = np.empty(count, np.int32)
    child = np.empty((2 * count + 1, 2), np.int32)
    used = _split(boxes, order, child)
    tree = Bvh(order, child[:used].copy(), np.empty((used, boxes.shape[1])))
    refit(tree, boxes)
    return tree


def refit(tree: Bvh, boxes: Float) -> None:
    """Update the boxes of the tree in place; its structure stays."""
    _refit(boxes, tree.order, tree.child, tree.box)


@helper
def _apart(a, i, b, j):  # type: ignore[no-untyped-def]
    """Whether row i of boxes a and row j of boxes b, both still or both moving, never meet."""
    still = a.shape[1] == 6
    for axis in range(3):
        if a[i, axis] > b[j, axis + 3]:
            if still or a[i, axis + 6] > b[j, axis + 9]:
                return True
        elif b[j, axis] > a[i, axis + 3]:
            if still or b[j, axis + 6] > a[i, axis + 9]:
                return True
    return False


@helper
def _extent(box, i):  # type: ignore[no-untyped-def]
    """Sum of the three sides of box i."""
    return (box[i, 3] - box[i, 0]) + (box[i, 4] - box[i, 1]) + (box[i, 5] - box[i, 2])


@helper
def _push_below(child_a, tree_a, child_b, tree_b, i, j, itself, stack, depth):  # type: ignore[no-untyped-def]
    """Put the pairs below a pair of tree nodes, not both leaves, on a stack; return its new depth."""
    if itself:
        left, right = child_a[i, 0], child_a[i, 1]
        stack[depth, 0], stack[depth, 1] = left, left
        stack[depth + 1, 0], stack[depth + 1, 1] = right, right
        stack[depth + 2, 0], stack[depth + 2, 1] = left, right
        return depth + 3
    if child_b[j, 0] < 0 or (child_a[i, 0] >= 0 and _extent(tree_a, i) >= _extent(tree_b, j)):
        stack[depth, 0], stack[depth, 1] = child_a[i, 0], j
        stack[depth + 1, 0], stack[depth + 1, 1] = child_a[i, 1], j
    else:
        stack[depth, 0], stack[depth, 1] = i, child_b[j, 0]
        stack[depth + 1, 0], stack[depth + 1, 1] = i, child_b[j, 1]
    return depth + 2


@kernel(types.int64(I32_2, F64_2, I32_2, F64_2, types.boolean, types.int64, OUT_I32_2))
def _spread(child_a, tree_a, child_b, tree_b, same, least, starts):  # type: ignore[no-untyped-def]
    """Write pairs of tree nodes, `least` or more if there are, below which all overlaps are; return how many.

    They come as a stack would hold them: the last is searched first.
    """
    above = np.empty(starts.shape, np.int32)
    starts[0, 0], starts[0, 1] = 0, 0
    count = 1
    went_on = True
    while went_on and count < least:
        went_on = False
        above[:count] = starts[:count]
        last = count
        count = 0
        for k in range(last):
            i = unsigned(above[k, 0])
            j = unsigned(above[k, 1])
            itself = same and i == j
            if not itself and _apart(tree_a, i, tree_b, j):
                continue
            if child_a[i, 0] < 0 and child_b[j, 0] < 0:
                starts[count, 0] = i
                starts[count, 1] = j
                count += 1
            else:
                count = _push_below(child_a, tree_a, child_b, tree_b, i, j, itself, starts, count)
                went_on = True
    return count


@kernel(types.int64(F64_2, I32_1, I32_2, F64_2, F64_2, I32_1, I32_2, F64_2, types.boolean, I32_2, OUT_I32_2))
def _overlaps(  # type: ignore[no-untyped-def]
    boxes_a, order_a, child_a, tree_a, boxes_b, order_b, child_b, tree_b, same, starts, pairs
):
    """Write overlapping pairs below pairs of tree nodes while they fit; return how many there are."""
    capacity = pairs.shape[0]
    found = 0
    stack = np.empty((1024, 2), np.int32)
    depth = starts.shape[0]
    stack[:depth] = starts[::-1]
    while depth > 0:
        depth -= 1
        i = unsigned(stack[depth, 0])
        j = unsigned(stack[depth, 1])
        itself = same and i == j
        if not itself and _apart(tree_a, i, tree_b, j):
            continue
        leaf_i = child_a[i, 0] < 0
        leaf_j = child_b[j, 0] < 0
        if leaf_i and leaf_j:
            first_i = -1 - child_a[i, 0]
            first_j = -1 - child_b[j, 0]
            for k in range(unsigned(first_i), unsigned(first_i + child_a[i, 1])):
                a = unsigned(order_a[k])
                if not itself and _apart(boxes_a, a, tree_b, j):
                    continue
                begin = k + unsigned(1) if itself else unsigned(first_j)
                for m in range(begin, unsigned(first_j + child_b[j, 1])):
                    b = unsigned(order_b[m])
                    if not _apart(boxes_a, a, boxes_b, b):
                        if found < capacity:
                            pairs[found, 0] = a
                            pairs[found, 1] = b
                        found += 1
        # As `_push_below` does, whose call took twice the time of a search.
        elif itself:
            left, right = child_a[i, 0], child_a[i, 1]
            stack[depth, 0], stack[depth, 1] = left, left
            stack[depth + 1, 0], stack[depth + 1, 1] = right, right
            stack[depth + 2, 0], stack[depth + 2, 1] = left, right
            depth += 3
        elif leaf_j or (not leaf_i and _extent(tree_a, i) >= _extent(tree_b, j)):
            stack[depth, 0], stack[depth, 1] = child_a[i, 0], j
            stack[depth + 1, 0], stack[depth + 1, 1] = child_a[i, 1], j
            depth += 2
        else:
            stack[depth, 0], stack[depth, 1] = i, child_b[j, 0]
            stack[depth + 1, 0], stack[depth + 1, 1] = i, child_b[j, 1]
            depth += 2
    return found


MOST_PAIRS = 40_000_000
"""Pairs of boxes at most: 320 MB. Garments of 100,000 faces on bodies of as many have a tenth of that."""


FEW_BOXES, PARTS = 2000, 16
"""Hierarchies over fewer boxes together are searched as one, others in so many parts at least."""
BOXES_PER_PART = 512
"""Boxes that one thread compares with a hierarchy at a time."""


def overlapping_pairs(tree_a: Bvh, boxes_a: Float, tree_b: Bvh, boxes_b: Float) -> Int:
    """Index pairs (a, b) of overlapping boxes, shape (p, 2)."""
    return _collect(tree_a, boxes_a, tree_b, boxes_b, False)


def self_overlapping_pairs(tree: Bvh, boxes: Float) -> Int:
    """Index pairs of overlapping boxes within one set, each once, shape (p, 2)."""
    return _collect(tree, boxes, tree, boxes, True)


def _collect(tree_a: Bvh, boxes_a: Float, tree_b: Bvh, boxes_b: Float, same: bool) -> Int:
    starts = np.empty((4 * PARTS, 2), np.int32)
    parts = 1 if len(boxes_a) + len(boxes_b) < FEW_BOXES else PARTS
    count = _spread(tree_a.child, tree_a.box, tree_b.child, tree_b.box, same, parts, starts)
    starts = starts[:count][::-1].copy()

    def write(first: int, last: int, pairs: Int) -> int:
        found: int = _overlaps(
            boxes_a, tree_a.order, tree_a.child, tree_a.box, boxes_b, tree_b.order, tree_b.child, tree_b.box,
            same, starts[first:last], pairs,
        )  # fmt: skip
        return found

    return _gathered(write, count, 1, 16 * len(boxes_a) + 1024)


def _gathered(write: Callable[[int, int, Int], int], rows: int, part: int, room: int) -> Int:
    """Return what `write(first, last, pairs)` writes of parts of rows while it fits, in their order.

    There is `room` for that many pairs of a part at first.
    """
    crowd = Crowd(MOST_PAIRS)

    def find(first: int, last: int) -> Int:
        pairs = np.empty((room, 2), np.int32)
        found = write(first, last, pairs)
        crowd.add(found)
        if found > len(pairs):
            pairs = np.empty((found, 2), np.int32)
            write(first, last, pairs)
        return pairs[:found]

    pairs = together(in_parts(find, rows, part), 2)
    crowd.check(len(pairs))
    return pairs


@kernel(types.int64(F64_2, I32_1, I32_2, F64_2, F64_2, types.int64, OUT_I32_2))
def _meeting(boxes, order, child, tree_box, others, number, pairs):  # type: ignore[no-untyped-def]
    """Write pairs (box, other box) that overlap while they fit; return how many there are.

    `number` is that of the first other box.
    """
    capacity = pairs.shape[0]
    found = 0
    stack = np.empty(128, np.int32)
    for t in range(others.shape[0]):
        stack[0] = 0
        depth = 1
        while depth > 0:
            depth -= 1
            node = unsigned(stack[depth])
            if _apart(tree_box, node, others, t):
                continue
            if child[node, 0] >= 0:
                stack[depth] = child[node, 0]
                stack[depth + 1] = child[node, 1]
                depth += 2
                continue
            first = -1 - child[node, 0]
            for k in range(unsigned(first), unsigned(first + child[node, 1])):
                box = unsigned(order[k])
                if not _apart(boxes, box, others, t):
                    if found < capacity:
                        pairs[found, 0] = box
                        pairs[found, 1] = number + t
                    found += 1
    return found


def boxes_meeting(tree: Bvh, boxes: Float, others: Float) -> Int:
    """Index pairs (box, other) of boxes that overlap others of the same kind, shape (p, 2).

    For others that are asked about once: a hierarchy over them would cost more than it saves.
    """

    def write(first: int, last: int, pairs: Int) -> int:
        found: int = _meeting(boxes, tree.order, tree.child, tree.box, others[first:last], first, pairs)
        return found

    return _gathered(write, len(others), BOXES_PER_PART, 16 * max(len(boxes), len(others)) + 1024)
