"""What hangs together is one piece, numbered by its first member."""

import numpy as np

from toile.geometry.connected import connected, connected_vertices, first_connected
from toile.geometry.normals import area_normals, vertex_normals
from toile.geometry.topology import triangle_topology

PAIRS = np.array([(4, 2), (5, 0), (2, 6)])
FACES = np.array([(0, 1, 2), (2, 1, 3), (5, 6, 7), (7, 8, 9)], np.int32)


def test_pieces_are_numbered_by_their_first_things() -> None:
    assert connected(PAIRS, 7).tolist() == [0, 1, 2, 3, 2, 0, 2]
    assert connected(PAIRS[:0], 3).tolist() == [0, 1, 2]
    assert first_connected(PAIRS, 7).tolist() == [0, 1, 2, 3, 2, 0, 2]
    assert first_connected(np.array([(3, 1)]), 4).tolist() == [0, 1, 2, 1]


def test_vertices_of_faces_that_share_one_are_a_piece() -> None:
    assert connected_vertices(FACES, 10).tolist() == [0, 0, 0, 0, 1, 2, 2, 2, 2, 2]


def test_neighbours_share_a_side_of_two_faces() -> None:
    assert triangle_topology(FACES).neighbour_pairs.tolist() == [[0, 1]]
    fin = np.array([(0, 1, 2), (2, 1, 3), (2, 1, 4), (4, 1, 5)], np.int32)
    assert triangle_topology(fin).neighbour_pairs.tolist() == [[2, 3]]


def test_normals_of_faces_are_twice_their_area_long_and_sum_up_to_those_of_vertices() -> None:
    corners = np.array([[(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 3.0, 0.0)]])
    assert area_normals(corners).tolist() == [[0.0, 0.0, 6.0]]
    points = np.random.default_rng(1).normal(size=(10, 3))
    sums = np.zeros((10, 3))
    for face, normal in zip(FACES, area_normals(points[FACES]), strict=True):
        sums[face] += normal
    used = np.unique(FACES)
    expected = sums[used] / np.linalg.norm(sums[used], axis=1, keepdims=True)
    assert np.abs(vertex_normals(points, FACES)[used] - expected).max() < 1e-14
