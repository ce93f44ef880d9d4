"""Candidates found anew in place of known ones: every pair once, in order."""

import numpy as np
import pytest

from toile.collide.merged_pairs import Measured, replaced, unmeasured, with_pairs_of

NONE = np.empty((0, 4), np.int32)


@pytest.mark.parametrize("vertices", [50, 32_767, 32_768, 2_000_000])
def test_pairs_found_twice_are_kept_once_and_in_order(vertices: int) -> None:
    """Numbers small enough to be sorted as one, and others."""
    generator = np.random.default_rng(1)
    found = generator.integers(0, vertices, (400, 4)).astype(np.int32)
    found[0] = vertices - 1
    twice = np.concatenate([found, found[::3]])
    marked = np.ones(vertices, bool)
    vertex_face, edge_edge = with_pairs_of(marked, unmeasured((NONE, NONE)), (twice, NONE)).pairs
    assert np.array_equal(vertex_face, np.unique(found, axis=0))
    assert edge_edge.shape == (0, 4)


def test_known_pairs_without_a_marked_vertex_stay() -> None:
    known = np.array([[0, 1, 2, 3], [4, 5, 6, 7]], np.int32)
    found = np.array([[8, 1, 2, 3], [4, 5, 6, 9]], np.int32)
    marked = np.zeros(10, bool)
    marked[0] = marked[8] = True
    distances = (np.array([0.1, 0.2]), np.array([0.3, 0.4]))
    merged = with_pairs_of(
        marked, Measured((known, known), distances), (found, np.ascontiguousarray(found[:, [1, 0, 3, 2]]))
    )
    vertex_face, edge_edge = merged.pairs
    assert vertex_face.tolist() == [[4, 5, 6, 7], [8, 1, 2, 3]]
    # Of an edge pair the lower ends, and the lower edge, come first.
    assert edge_edge.tolist() == [[4, 5, 6, 7], [1, 8, 2, 3]]
    # So do their distances; those of new ones are not known.
    for rows, kept in zip(merged.distances, (0.2, 0.4), strict=True):
        assert rows[0] == kept and np.isnan(rows[1])


def test_replaced_pairs_are_those_found_with_a_marked_vertex() -> None:
    known = np.array([[0, 1, 2, 3], [4, 5, 6, 7]], np.int32)
    found = np.array([[8, 5, 2, 3], [0, 1, 2, 9], [4, 5, 6, 7]], np.int32)
    marked = np.zeros(10, bool)
    marked[0] = marked[8] = True
    merged = replaced(marked, Measured((known, NONE), (np.array([0.1, 0.2]), np.zeros(0))), (found, NONE))
    assert merged.pairs[0].tolist() == [[4, 5, 6, 7], [8, 5, 2, 3], [0, 1, 2, 9]]
    assert merged.distances[0][0] == 0.2 and np.isnan(merged.distances[0][1:]).all()
