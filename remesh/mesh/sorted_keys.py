"""Keys of node pairs, and their look-up, in kernels."""

import numpy as np

from toile.geometry.kernel import helper


@helper
def pair_key(i, j):  # type: ignore[no-untyped-def]
    """Return the number of an unordered pair, as `pair_keys` does."""
    return np.int64(min(i, j)) << 32 | np.int64(max(i, j))


@helper
def is_among(ordered, key):  # type: ignore[no-untyped-def]
    """Tell whether a sorted array has a number."""
    low, high = 0, len(ordered)
    while low < high:
        middle = (low + high) >> 1
        if ordered[middle] < key:
            low = middle + 1
        else:
            high = middle
    return low < len(ordered) and ordered[low] == key
