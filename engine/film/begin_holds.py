"""The start of a film for cloth whose fields are keyed, or that it holds for a time."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fields.edge_runs import EdgeRun, run_edges
from toile.engine.cloth.fields.timed_pins import RunHold, TimedPins
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Bool

NEAREST = 4
"""Vertices of the avatar that a held node goes along with."""


def at_start(cloth: Cloth, motion: VertexMotion | None) -> Cloth:
    """Return a cloth as a film begins with it: pins where it is held, and keys after the lead-in."""
    if cloth.fields is None and not (cloth.holds or cloth.elastic or cloth.gas or cloth.fastenings):
        return cloth
    lead = 0.0 if motion is None else motion.lead / motion.fps
    return replace(
        cloth,
        fields=None if cloth.fields is None else cloth.fields.later(lead),
        elastic=tuple(run.later(lead) for run in cloth.elastic),
        gas=tuple(gas.later(lead) for gas in cloth.gas),
        fastenings=tuple(row.later(lead) for row in cloth.fastenings),
        timed_pins=tuple(_pins(cloth, hold, motion, lead) for hold in _together(cloth.holds)),
    )


def _together(holds: Sequence[RunHold]) -> list[list[RunHold]]:
    """Return holds that come and go alike in one list each."""
    found: dict[tuple[object, ...], list[RunHold]] = {}
    for hold in holds:
        found.setdefault((hold.share, hold.stiffness, hold.follow), []).append(hold)
    return list(found.values())


def _pins(cloth: Cloth, holds: list[RunHold], motion: VertexMotion | None, lead: float) -> TimedPins:
    held = np.zeros(len(cloth.positions), bool)
    for hold in holds:
        held |= _held_nodes(cloth, hold)
    one = holds[0]
    weights, points = None, None
    if one.follow and motion is not None:
        weights, points = _taken_along(cloth, held, motion)
    return TimedPins(
        stiffness=np.where(held, one.stiffness, 0.0), places=cloth.positions.copy(),
        share=one.share.later(lead), weights=weights, motion=points,
    )  # fmt: skip


def _held_nodes(cloth: Cloth, hold: RunHold) -> Bool:
    """Mark the nodes of a hold, shape (n,)."""
    held = np.zeros(len(cloth.positions), bool)
    if hold.lines is None:
        own = (cloth.garment == hold.garment) & (cloth.panel == hold.panel)
        held[cloth.face_nodes[own].ravel()] = True
        return held
    run = EdgeRun(garment=hold.garment, panel=hold.panel, lines=hold.lines, rest=1.0, stiffness=1.0)
    owner = np.column_stack([cloth.garment, cloth.panel])
    edges = run_edges((run,), cloth.node, cloth.faces, owner, cloth.rest_space)
    held[edges.nodes.ravel()] = True
    return held


def _taken_along(cloth: Cloth, held: Bool, motion: VertexMotion) -> tuple[csr_array, VertexMotion]:
    """Weights of the avatar's vertices near held nodes, sparse (n, p), and the motion of these p alone."""
    nodes = np.flatnonzero(held)
    count = min(NEAREST, motion.frames.shape[1])
    distance, near = cKDTree(motion.at(0.0)).query(cloth.positions[nodes], k=count)
    share = 1.0 / np.maximum(np.asarray(distance).reshape(len(nodes), count), 1e-6) ** 2
    share /= share.sum(axis=1, keepdims=True)
    used, column = np.unique(np.asarray(near), return_inverse=True)
    weights = csr_array(
        (share.ravel(), (np.repeat(nodes, count), column.ravel())), shape=(len(held), len(used))
    )
    return weights, VertexMotion(frames=motion.frames[:, used], fps=motion.fps, lead=motion.lead)
