"""Groups of neighbouring nodes of about equal size: the coarse nodes of a two-level preconditioner."""

import numpy as np
from numba import types

from toile.geometry.arrays import Int
from toile.geometry.kernel import I32_1, OUT_I32_1, kernel


def aggregate_nodes(indptr: Int, indices: Int, size: int, *, rounds: int = 3) -> Int:
    """Return the group of each node, shape (node_count,), groups numbered from 0 without gaps.

    Groups of at most `size` nodes grow breadth first, each from the border of those before it; groups
    under a third of that are given up to their neighbours, unless a connected part of the graph has
    no other. `rounds` of Lloyd's algorithm on the graph (every group grows anew from its innermost
    node) then make them round. Deterministic.
    """
    group = np.empty(len(indptr) - 1, np.int32)
    count = _grow(indptr, indices, size, group)
    _dissolve_small(indptr, indices, max(1, size // 3), count, group)
    group = np.unique(group, return_inverse=True)[1].astype(np.int32)
    for _ in range(rounds):
        _regrow_from_centres(indptr, indices, int(group.max(initial=-1)) + 1, group)
    return np.asarray(group, dtype=np.int32)


@kernel(types.int64(I32_1, I32_1, types.int64, OUT_I32_1))
def _grow(indptr: Int, indices: Int, size: int, group: Int) -> int:
    """Grow groups one after the other; the next seed is the oldest free neighbour of those before."""
    count = group.shape[0]
    for i in range(count):
        group[i] = -1
    queue = np.empty(count, np.int32)
    front = np.empty(count, np.int32)
    in_front = np.zeros(count, np.bool_)
    head = 0
    tail = 0
    first_free = 0
    groups = 0
    while True:
        seed = -1
        while head < tail and seed < 0:
            if group[front[head]] < 0:
                seed = front[head]
            head += 1
        while seed < 0 and first_free < count:
            if group[first_free] < 0:
                seed = first_free
            first_free += 1
        if seed < 0:
            break
        group[seed] = groups
        queue[0] = seed
        begin = 0
        end = 1
        while begin < end:
            i = queue[begin]
            begin += 1
            for k in range(indptr[i], indptr[i + 1]):
                j = indices[k]
                if group[j] < 0:
                    if end < size:
                        group[j] = groups
                        queue[end] = j
                        end += 1
                    elif not in_front[j]:
                        in_front[j] = True
                        front[tail] = j
                        tail += 1
        groups += 1
    return groups


@kernel(types.void(I32_1, I32_1, types.int64, types.int64, OUT_I32_1))
def _dissolve_small(indptr: Int, indices: Int, minimum: int, groups: int, group: Int) -> None:
    """Give nodes of groups under `minimum` nodes to neighbouring larger ones, outermost first."""
    count = group.shape[0]
    sizes = np.zeros(groups, np.int32)
    for i in range(count):
        sizes[group[i]] += 1
    queue = np.empty(count, np.int32)
    tail = 0
    for i in range(count):
        if sizes[group[i]] >= minimum:
            queue[tail] = i
            tail += 1
    head = 0
    while head < tail:
        i = queue[head]
        head += 1
        for k in range(indptr[i], indptr[i + 1]):
            j = indices[k]
            if sizes[group[j]] < minimum:
                group[j] = group[i]
                queue[tail] = j
                tail += 1


@kernel(types.void(I32_1, I32_1, types.int64, OUT_I32_1))
def _regrow_from_centres(indptr: Int, indices: Int, groups: int, group: Int) -> None:
    """Find each group's node farthest from other groups, then grow all groups from there at once."""
    count = group.shape[0]
    reached = np.zeros(count, np.bool_)
    queue = np.empty(count, np.int32)
    tail = 0
    for i in range(count):
        for k in range(indptr[i], indptr[i + 1]):
            if group[indices[k]] != group[i]:
                reached[i] = True
                queue[tail] = i
                tail += 1
                break
    head = 0
    while head < tail:
        i = queue[head]
        head += 1
        for k in range(indptr[i], indptr[i + 1]):
            j = indices[k]
            if not reached[j]:
                reached[j] = True
                queue[tail] = j
                tail += 1
    centres = np.zeros(groups, np.int32)
    for i in range(count - 1, -1, -1):
        if not reached[i]:  # a connected part of the graph that is one group
            centres[group[i]] = i
    for q in range(tail):
        centres[group[queue[q]]] = queue[q]
    for i in range(count):
        group[i] = -1
    for g in range(groups):
        group[centres[g]] = g
        queue[g] = centres[g]
    head = 0
    tail = groups
    while head < tail:
        i = queue[head]
        head += 1
        for k in range(indptr[i], indptr[i + 1]):
            j = indices[k]
            if group[j] < 0:
                group[j] = group[i]
                queue[tail] = j
                tail += 1
