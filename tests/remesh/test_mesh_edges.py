"""Edges against a twin that looks through all sides, on meshes with seams, borders, folds and tangles."""

from collections import defaultdict

import numpy as np
import pytest

from toile.geometry.arrays import Float, Int
from toile.remesh.mesh.mesh_edges import BORDER, FLATNESS, INNER, SEAM, TANGLED, build_edges, pair_keys
from toile.remesh.mesh.node_faces import node_faces
from toile.remesh.panel.panel_mesh import triangulate_panel

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def sample(seed: int) -> tuple[Int, Int, Int, Float, Float]:
    """Faces, nodes and regions of a sheet, sewn to itself at random, its rest positions and normals."""
    random = np.random.default_rng(seed)
    mesh = triangulate_panel(SQUARE, edge_length=float(random.uniform(0.15, 0.5)))
    faces = np.ascontiguousarray(mesh.faces, np.int32)
    count = len(mesh.vertices)
    node = np.arange(count, dtype=np.int32)
    sewn = random.integers(0, count, (seed % 4, 2))
    node[sewn[:, 0]] = node[sewn[:, 1]]
    region = random.integers(0, 1 + seed % 3, len(faces)).astype(np.int32)
    rest = np.column_stack([mesh.vertices, np.zeros(count)])
    if seed % 2:
        rest[random.integers(0, count, 2), 2] = 0.1
    sides = rest[faces[:, 1:]] - rest[faces[:, :1]]
    normals = np.cross(sides[:, 0], sides[:, 1])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return faces, node, region, rest, normals


@pytest.mark.parametrize("seed", range(40))
def test_edges_are_those_of_a_plain_search(seed: int) -> None:
    faces, node, region, rest, normals = sample(seed)
    found = defaultdict(list)
    for t, face in enumerate(faces):
        for k in range(3):
            ends = sorted((int(node[face[(k + 1) % 3]]), int(node[face[(k + 2) % 3]])))
            found[ends[0], ends[1]].append((t, k))
    pairs = sorted(found)
    frozen = pair_keys(*np.array(pairs[::7]).T)
    edges = build_edges(faces, node, region, rest, normals, frozen)
    assert edges.nodes.tolist() == [list(pair) for pair in pairs]
    assert edges.frozen.tolist() == [row % 7 == 0 for row in range(len(pairs))]
    for row, pair in enumerate(pairs):
        at = found[pair]
        assert all(edges.face_edges[t, k] == row for t, k in at)
        assert (edges.faces[row, 0], edges.sides[row, 0]) == at[0]
        kind, creased = BORDER, False
        if len(at) > 2 or pair[0] == pair[1] or (len(at) == 2 and at[0][0] == at[1][0]):
            kind = TANGLED
        elif len(at) == 2:
            (t, k), (u, j) = at
            here, there = faces[t, [(k + 1) % 3, (k + 2) % 3]], faces[u, [(j + 2) % 3, (j + 1) % 3]]
            kind = INNER if (here == there).all() and region[t] == region[u] else SEAM
            far = rest[faces[u, j]] - rest[here[0]]
            raised = abs(far @ normals[t]) > FLATNESS * np.linalg.norm(far)
            creased = kind == INNER and bool(raised or normals[t] @ normals[u] <= 0.0)
        assert (edges.kind[row], edges.creased[row]) == (kind, creased)
        second = at[1] if kind in (INNER, SEAM) else (-1, 0)
        assert (edges.faces[row, 1], edges.sides[row, 1]) == second


@pytest.mark.parametrize("seed", range(0, 40, 4))
def test_faces_around_nodes_and_nodes_across_sides(seed: int) -> None:
    faces, node, region, rest, normals = sample(seed)
    face_nodes = np.ascontiguousarray(node[faces])
    edges = build_edges(faces, node, region, rest, normals, np.empty(0, np.int64))
    near = node_faces(edges, face_nodes, len(node))
    for i in range(len(node)):
        around = near.around[near.offsets[i] : near.offsets[i + 1]]
        assert around.tolist() == np.flatnonzero((face_nodes == i).any(axis=1)).tolist()
    for t in range(len(faces)):
        for k in range(3):
            across = set(edges.faces[edges.face_edges[t, k]].tolist()) - {t, -1}
            far = {i for u in across for i in face_nodes[u].tolist()} - set(
                np.delete(face_nodes[t], k).tolist()
            )
            assert near.across[t, k] == (far.pop() if far else -1)
