"""Transfer of data from the old mesh to the new one."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from toile.geometry.arrays import Bool, Float, Int


class Births(NamedTuple):
    """Nodes and material vertices added at once, each half-way between two older ones.

    Attributes
    ----------
    node_parents, vertex_parents
        The two they lie between, shapes (k, 2) and (l, 2).
    vertex_node
        Node of every new material vertex, shape (l,).
    on_line
        True for nodes added on a border or seam, shape (k,).
    """

    node_parents: Int
    vertex_parents: Int
    vertex_node: Int
    on_line: Bool


@dataclass(frozen=True)
class TransferMap:
    """The origin of everything in the new mesh.

    Attributes
    ----------
    nodes
        Weight of old nodes in every new node, sparse (n', n); rows sum to 1.
    vertices
        Weight of old material vertices in every new one, sparse (m', m); rows sum to 1.
    faces
        Old face that every new face comes from, shape (t',).
    new_node
        New number of every old node, -1 where it was removed, shape (n,).
    on_line
        True for new nodes that were added on a border or seam, shape (n',).
    """

    nodes: sp.csr_array
    vertices: sp.csr_array
    faces: Int
    new_node: Int
    on_line: Bool

    def at_nodes(self, values: Float) -> Float:
        """Return a node attribute (n, ...) on the new nodes."""
        return _product(self.nodes, values)

    def at_vertices(self, values: Float) -> Float:
        """Return an attribute of material vertices (m, ...) on the new ones."""
        return _product(self.vertices, values)

    def marked_nodes(self, marked: Bool) -> Bool:
        """Carry marks (n,): survivors keep theirs, nodes added on a line between marked ones are marked."""
        full = np.asarray(self.nodes @ marked.astype(np.float64)) > 1.0 - 1e-9
        survivor = np.zeros(len(full), bool)
        survivor[self.new_node[self.new_node >= 0]] = True
        return np.asarray(full & (survivor | self.on_line))

    def node_indices(self, indices: Int) -> Int:
        """Return the new numbers of old nodes, any shape; -1 where a node was removed."""
        return np.asarray(self.new_node[indices])


def _product(matrix: sp.csr_array, values: Float) -> Float:
    flat = matrix @ values.reshape(len(values), -1)
    return np.ascontiguousarray(flat.reshape(-1, *values.shape[1:]))


def transfer_map(
    births: list[Births],
    node_count: int,
    vertex_count: int,
    node_alive: Bool,
    vertex_alive: Bool,
    parent: Int,
) -> TransferMap:
    """Compose the births of a pass and drop what was removed (alive masks over old and added ones)."""
    new_node = np.cumsum(node_alive[:node_count], dtype=np.int32) - np.int32(1)
    new_node[~node_alive[:node_count]] = -1
    on_line = np.concatenate([np.zeros(node_count, bool), *(batch.on_line for batch in births)])
    nodes = descent([batch.node_parents for batch in births], node_count, node_alive)
    vertices = nodes
    if not _born_alike(births, node_alive, vertex_alive):
        vertices = descent([batch.vertex_parents for batch in births], vertex_count, vertex_alive)
    return TransferMap(
        nodes=nodes,
        vertices=vertices,
        faces=parent,
        new_node=new_node,
        on_line=on_line[node_alive],
    )


def _born_alike(births: list[Births], node_alive: Bool, vertex_alive: Bool) -> bool:
    """Whether vertices were born and removed as their nodes were: so they are without seams."""
    return np.array_equal(node_alive, vertex_alive) and all(
        np.array_equal(np.sort(batch.node_parents, axis=1), np.sort(batch.vertex_parents, axis=1))
        for batch in births
    )


def descent(batches: list[Int], count: int, alive: Bool) -> sp.csr_array:
    """Return the weights of the first `count` items in all that are alive.

    Every batch has the two parents, among all before it, of each of its items: shape (k, 2).
    """
    weights = sp.eye_array(count, format="csr")
    for parents in batches:
        rows = np.repeat(np.arange(len(parents)), 2)
        shape = (len(parents), weights.shape[0])
        halves = sp.csr_array((np.full(2 * len(parents), 0.5), (rows, parents.ravel())), shape=shape)
        weights = sp.csr_array(sp.vstack([weights, halves @ weights], format="csr"))
    return sp.csr_array(weights[np.flatnonzero(alive)])
