"""What hangs together: connected pieces of pairs and of meshes."""

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from toile.geometry.arrays import Int


def connected(pairs: npt.NDArray[np.integer], count: int) -> Int:
    """Return the piece of each of `count` things, of which pairs (p, 2) hang together, shape (count,).

    Pieces are numbered from 0 by their first things.
    """
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int32)


def connected_vertices(faces: npt.NDArray[np.integer], count: int) -> Int:
    """Return the piece of each of `count` vertices of faces (t, 3), shape (count,)."""
    return connected(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]]), count)


def first_connected(pairs: npt.NDArray[np.integer], count: int) -> Int:
    """Return the first thing of the piece of each of `count` things, shape (count,): see `connected`."""
    _, first, piece = np.unique(connected(pairs, count), return_index=True, return_inverse=True)
    return np.asarray(first[piece.ravel()], np.int32)
