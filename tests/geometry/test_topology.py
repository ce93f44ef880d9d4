import numpy as np
import pytest

from toile.geometry.topology import triangle_topology
from toile.studies.scenes.flat_meshes import KINDS, mesh


@pytest.mark.parametrize("kind", KINDS)
def test_sides_agree_with_brute_force(kind: str) -> None:
    points, faces = mesh(kind, 1.0, 1.0, 0.25)
    topology = triangle_topology(faces)
    for face in range(len(faces)):
        for side in range(3):
            ends = {int(faces[face, (side + 1) % 3]), int(faces[face, (side + 2) % 3])}
            assert set(topology.edges[topology.face_edges[face, side]].tolist()) == ends
            across = [t for t in range(len(faces)) if t != face and ends <= set(faces[t].tolist())]
            found = int(topology.neighbours[face, side])
            assert ([] if found < 0 else [found]) == across
            if across:
                assert int(topology.neighbours[found, topology.neighbour_sides[face, side]]) == face
    assert len(points) - len(topology.edges) + len(faces) == 1  # Euler, a disc
    assert len(topology.border_edges) == int(topology.border_sides.sum())


def test_neighbours_do_not_depend_on_orientation() -> None:
    same = triangle_topology(np.array([[0, 1, 2], [2, 1, 3]], np.int32))
    turned = triangle_topology(np.array([[0, 1, 2], [1, 2, 3]], np.int32))
    assert same.neighbours[0, 0] == turned.neighbours[0, 0] == 1


def test_an_edge_of_three_faces_is_a_border_to_each() -> None:
    topology = triangle_topology(np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]], np.int32))
    assert (topology.neighbours == -1).all()
    assert topology.edge_face_count.max() == 3


def test_a_collapsed_side_has_no_neighbour() -> None:
    topology = triangle_topology(np.array([[0, 0, 1], [0, 0, 2]], np.int32))
    assert (topology.neighbours[:, 2] == -1).all()
