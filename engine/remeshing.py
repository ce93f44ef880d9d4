"""Remeshing of cloth in a run: what it asks the mesher for, and how its state follows onto the new mesh."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from toile.engine.cloth import Cloth
from toile.engine.patch_gate import PatchGate
from toile.engine.sizing_field import face_metrics
from toile.engine.step import ClothStepper
from toile.geometry.arrays import Bool, Float, Int
from toile.remesh.adapt import adapt
from toile.remesh.cloth_mesh import ClothMesh
from toile.remesh.momentum import Motion, with_momentum_of
from toile.remesh.sizing import SizingOptions
from toile.remesh.transfer import TransferMap
from toile.remesh.vertex_tensors import vertex_tensors

FEW = 0.02
"""Splits and collapses, as a share of the faces, that are not worth a new mesh: still cloth keeps its own."""


@dataclass(frozen=True, kw_only=True)
class Remeshed:
    """A cloth on its new mesh.

    Attributes
    ----------
    cloth
        The cloth, new nodes half-way on its surface.
    anchors
        Friction anchors of its nodes [m], shape (n, 3).
    changed
        Nodes of the faces that are new or have changed, shape (n,).
    splits, flips, collapses
        What was done.
    """

    cloth: Cloth
    anchors: Float
    changed: Bool
    splits: int
    flips: int
    collapses: int


def remeshed(cloth: Cloth, stepper: ClothStepper, options: SizingOptions) -> Remeshed | None:
    """Adapt the mesh of a cloth to its present shape; None where it is good as it is.

    `cloth` gives the topology, `stepper` the present positions and velocities. Flips and collapses leave the
    cloth free of crossings; momentum is kept.
    """
    mesh = cloth_mesh(cloth, stepper.x)
    tensors = vertex_tensors(mesh, face_metrics(mesh, stepper, options))

    gate = PatchGate(cloth, stepper)
    result = adapt(mesh, tensors, gate)
    if result.splits + result.collapses <= FEW * len(cloth.faces):
        return None
    count = len(stepper.x)
    now = replace(cloth, positions=stepper.x, velocities=stepper.v)
    carried = carried_over(now, result.mesh, result.transfer)
    transfer = result.transfer
    return Remeshed(
        cloth=carried,
        anchors=carried.positions - transfer.at_nodes(stepper.x - stepper.anchor[:count]),
        changed=_changed_nodes(mesh, carried, transfer),
        splits=result.splits,
        flips=result.flips,
        collapses=result.collapses,
    )


def cloth_mesh(cloth: Cloth, x: Float) -> ClothMesh:
    """Return what the mesher works on: the start shape, flat or curved, is the rest space of every panel."""
    rest = cloth.start_positions
    sides = rest[cloth.faces[:, 1:]] - rest[cloth.faces[:, :1]]
    plane = cloth.rest_corners[:, 1:] - cloth.rest_corners[:, :1]
    frames = np.einsum("tci,tdc->tid", sides, np.linalg.inv(plane))
    region = np.unique(
        np.stack([cloth.garment, cloth.panel, cloth.fabric], axis=1), axis=0, return_inverse=True
    )
    kept = np.zeros(len(x), bool)
    kept[cloth.stitches.ravel()] = True
    return ClothMesh(
        rest=rest,
        node=cloth.node,
        faces=cloth.faces,
        frames=np.ascontiguousarray(frames),
        region=region[1].reshape(-1).astype(np.int32),
        positions=x.copy(),
        kept=kept,
        pinned=cloth.pinned,
        frozen_edges=_edges_between(cloth.face_nodes, kept),
    )


def carried_over(cloth: Cloth, mesh: ClothMesh, transfer: TransferMap) -> Cloth:
    """Return a cloth on its new mesh, everything that belongs to it carried along."""

    def marked(nodes: Int) -> Int:
        mask = np.zeros(len(cloth.positions), bool)
        mask[nodes] = True
        return np.flatnonzero(transfer.marked_nodes(mask)).astype(np.int32)

    after = replace(
        cloth,
        positions=mesh.positions,
        velocities=transfer.at_nodes(cloth.velocities),
        node=mesh.node,
        faces=mesh.faces,
        rest_corners=mesh.rest_corners,
        fabric=cloth.fabric[transfer.faces],
        garment=cloth.garment[transfer.faces],
        panel=cloth.panel[transfer.faces],
        uv=transfer.at_vertices(cloth.uv),
        stitches=transfer.node_indices(cloth.stitches),
        held=marked(cloth.held),
        waist=marked(cloth.waist),
        pinned=mesh.pinned,
        rest_curved=cloth.rest_curved[transfer.faces],
        start_positions=mesh.rest,
    )
    if cloth.velocities.any():
        velocities = with_momentum_of(_motion(cloth), _motion(after))
        velocities[after.pinned] = 0.0
        after = replace(after, velocities=velocities)
    return after


def _motion(cloth: Cloth) -> Motion:
    """Return the cloth in motion, its connected pieces told apart."""
    faces = cloth.face_nodes
    count = len(cloth.positions)
    ends = faces[:, [0, 1]].ravel(), faces[:, [1, 2]].ravel()
    graph = coo_array((np.ones(len(ends[0])), ends), shape=(count, count))
    piece = connected_components(graph, directed=False)[1]
    return Motion(cloth.positions, cloth.velocities, cloth.mass, piece)


def _changed_nodes(mesh: ClothMesh, after: Cloth, transfer: TransferMap) -> Bool:
    """Mark the nodes of faces that were not there before, shape (n,)."""
    old = transfer.new_node[mesh.face_nodes][transfer.faces]
    faces = after.face_nodes
    changed = np.zeros(len(after.positions), bool)
    changed[faces[(old != faces).any(axis=1)].ravel()] = True
    return changed


def _edges_between(faces: Int, marked: Bool) -> Int:
    """Return the edges of faces whose two nodes are marked, shape (k, 2)."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    sides = sides[marked[sides].all(axis=1)]
    return np.ascontiguousarray(np.unique(np.sort(sides, axis=1), axis=0).reshape(-1, 2), np.int32)
