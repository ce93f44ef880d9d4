"""Splits of edges that are longer than the metric wants."""

import numpy as np

from toile.geometry.arrays import Bool, Float, Int
from toile.remesh.adapt.disjoint_pairs import first_disjoint
from toile.remesh.adapt.mesh_in_work import MeshInWork
from toile.remesh.adapt.transfer import Births
from toile.remesh.mesh.mesh_edges import BORDER, SEAM, TANGLED, MeshEdges, corner_after
from toile.remesh.sizing.edge_size import LONGEST, edge_sizes

BESIDE = 0.75
"""Sides of a triangle are not split if they are shorter than this share of a side that must stay."""


def long_edges(work: MeshInWork) -> int:
    """Count the edges that are too long and can be split."""
    size = edge_sizes(work.faces, work.rest, work.tensors, work.edges)
    return int(np.count_nonzero((size > LONGEST) & ~_must_stay(work.edges, size)))


def split_round(work: MeshInWork) -> tuple[int, Bool]:
    """Halve the longest edges that share no face; return how many, and which faces changed, shape (t,).

    The surface stays where it is. Both sides of a seam are split at once.
    """
    edges = work.edges
    size = edge_sizes(work.faces, work.rest, work.tensors, edges)
    long = np.flatnonzero((size > LONGEST) & ~_must_stay(edges, size))
    long = long[np.argsort(-size[long], kind="stable")]
    long = long[first_disjoint(edges.faces[long], len(work.faces))]
    if not len(long):
        return 0, np.zeros(len(work.faces), bool)

    new_node = len(work.positions) + np.arange(len(long), dtype=np.int32)
    first = _ends(work.faces, edges.faces[long, 0], edges.sides[long, 0])
    paired = np.flatnonzero(edges.faces[long, 1] >= 0)
    second = _ends(work.faces, edges.faces[long[paired], 1], edges.sides[long[paired], 1])
    apart = (np.sort(second, axis=1) != np.sort(first[paired], axis=1)).any(axis=1)
    middle = len(work.rest) + np.arange(len(long), dtype=np.int32)
    other_middle = middle[paired]
    other_middle[apart] = len(work.rest) + len(long) + np.arange(int(apart.sum()), dtype=np.int32)
    births = Births(
        node_parents=edges.nodes[long],
        vertex_parents=np.concatenate([first, second[apart]]),
        vertex_node=np.concatenate([new_node, new_node[paired[apart]]]),
        on_line=np.isin(edges.kind[long], (SEAM, BORDER)),
    )
    halved = np.concatenate([edges.faces[long, 0], edges.faces[long[paired], 1]])
    sides = np.concatenate([edges.sides[long, 0], edges.sides[long[paired], 1]])
    _halve(work, halved, sides, np.concatenate([middle, other_middle]))
    work.add_vertices(births)
    work.forget_edges()
    touched = np.zeros(len(work.faces), bool)
    touched[halved] = True
    touched[-len(halved) :] = True
    return len(long), touched


def _must_stay(edges: MeshEdges, size: Float) -> Bool:
    """Edges that cannot be split, and those beside them that would be split for ever, shape (e,).

    Two sides of a triangle are together longer than its third. If that one stays, halving them again and
    again only flattens the triangle; so sides up to `BESIDE` of it stay too, and so on from side to side.
    """
    stay = edges.frozen | (edges.kind == TANGLED)
    count = 0
    while (long := stay & (size > LONGEST)).sum() > count:
        count = int(long.sum())
        limit = np.zeros(len(size))
        beside = BESIDE * np.where(long, size, 0.0)[edges.face_edges].max(axis=1)
        near = np.flatnonzero(beside > LONGEST)
        np.maximum.at(limit, edges.face_edges[near].ravel(), np.repeat(beside[near], 3))
        stay = stay | (size <= limit)
    return np.asarray(stay)


def _ends(faces: Int, face: Int, side: Int) -> Int:
    """Material vertices at both ends of a side, shape (k, 2)."""
    return np.stack([corner_after(faces, face, side, 1), corner_after(faces, face, side, 2)], axis=1)


def _halve(work: MeshInWork, face: Int, side: Int, middle: Int) -> None:
    """Cut faces from their corner `side` to the vertex `middle` on the opposite side; all shape (k,)."""
    apex = work.faces[face, side]
    end = corner_after(work.faces, face, side, 2)
    work.faces[face, (side + 2) % 3] = middle
    work.add_faces(np.stack([apex, middle, end], axis=1), face)
