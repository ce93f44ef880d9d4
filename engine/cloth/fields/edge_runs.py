"""Elastic sewn along edges of panels: a waistband, a cuff, a hem."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from toile.engine.cloth.fields.keyed import Keyed, later, value_at
from toile.geometry.arrays import Bool, Float, Int

ON_LINE = 1e-7
"""Distance within which a point lies on a run [m]."""


@dataclass(frozen=True, kw_only=True)
class EdgeRun:
    """A run of edges of one panel with elastic along it.

    It is kept as lines in rest space: which edges of the mesh lie on it can be told on every mesh.

    Attributes
    ----------
    garment, panel
        The panel.
    lines
        Straight pieces that it is made of, start and end in rest space [m], shape (k, 2, 3).
    rest
        Length of the elastic at rest over that of the edge in the pattern.
    stiffness
        Its tension per strain [N].
    """

    garment: int
    panel: int
    lines: Float
    rest: float | Keyed
    stiffness: float | Keyed

    def later(self, seconds: float) -> "EdgeRun":
        """Return the run in a film whose frame 0 is at a time [s]."""
        return replace(self, rest=later(self.rest, seconds), stiffness=later(self.stiffness, seconds))


class RunEdges(NamedTuple):
    """The edges of a mesh that lie on runs.

    Attributes
    ----------
    nodes
        Both nodes of every edge, shape (e, 2).
    lengths
        Their lengths in rest space [m], shape (e,).
    run
        The run of each, shape (e,).
    """

    nodes: Int
    lengths: Float
    run: Int

    def numbers(self, runs: tuple[EdgeRun, ...], seconds: float) -> tuple[Float, Float]:
        """Return rest length [m] and stiffness [N] of every edge at a time [s], both shape (e,)."""
        rest = np.array([value_at(run.rest, seconds) for run in runs])
        stiffness = np.array([value_at(run.stiffness, seconds) for run in runs])
        return rest[self.run] * self.lengths, stiffness[self.run]


def run_edges(runs: tuple[EdgeRun, ...], node: Int, faces: Int, owner: Int, rest: Float) -> RunEdges:
    """Return the edges of a mesh that lie on runs.

    Parameters
    ----------
    runs
        The runs.
    node
        Node of every material vertex, shape (m,).
    faces
        Material vertices of every face, shape (t, 3).
    owner
        Garment and panel of every face, shape (t, 2).
    rest
        Material vertices in rest space [m], shape (m, 3).
    """
    sides, face = border_sides(faces)
    nodes, lengths, numbers = [np.empty((0, 2), np.int32)], [np.empty(0)], [np.empty(0, np.int32)]
    for number, run in enumerate(runs):
        own = sides[(owner[face] == (run.garment, run.panel)).all(axis=1)]
        ends = rest[own]
        own = own[_on_lines(ends[:, 0], ends[:, 1], run.lines)]
        nodes.append(node[own])
        lengths.append(np.linalg.norm(rest[own[:, 1]] - rest[own[:, 0]], axis=1))
        numbers.append(np.full(len(own), number, np.int32))
    return RunEdges(
        np.ascontiguousarray(np.concatenate(nodes), np.int32), np.concatenate(lengths),
        np.concatenate(numbers),
    )  # fmt: skip


def end_vertices(lines: Float, vertices: Int, rest: Float) -> Int:
    """Return those of some vertices (k,) that lie where lines, shape (l, 2, 3), begin and end as a whole.

    `rest` are all material vertices in rest space [m], shape (m, 3). They must stay, or the run would end
    within an edge of the mesh.
    """
    points = lines.reshape(-1, 3)
    apart = np.linalg.norm(points[:, None] - points, axis=2)
    ends = points[(apart <= ON_LINE).sum(axis=1) == 1]
    near = np.linalg.norm(rest[vertices][:, None] - ends, axis=2).min(axis=1, initial=np.inf)
    return np.asarray(vertices[near <= ON_LINE])


def border_sides(faces: Int) -> tuple[Int, Int]:
    """Return the sides that only one face has, as vertex pairs (b, 2), and the face of each, shape (b,)."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    face = np.tile(np.arange(len(faces)), 3)
    _, first, count = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True)
    lone = np.sort(first[count == 1])
    return sides[lone], face[lone]


def _on_lines(start: Float, end: Float, lines: Float) -> Bool:
    """Mark the sides whose two ends and middle lie on some line each, shape (b,)."""
    marked = np.ones(len(start), bool)
    for points in (start, end, 0.5 * (start + end)):
        along = lines[:, 1] - lines[:, 0]
        away = points[:, None] - lines[:, 0]
        square = np.maximum((along**2).sum(axis=1), 1e-300)
        share = np.clip(np.einsum("bki,ki->bk", away, along) / square, 0.0, 1.0)
        distance = np.linalg.norm(away - share[:, :, None] * along, axis=2)
        marked &= distance.min(axis=1, initial=np.inf) <= ON_LINE
    return marked
