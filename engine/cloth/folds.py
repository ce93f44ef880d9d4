"""Folds: lines of panels along which cloth is folded at rest.

The lines cut a panel into parts. Edges between parts are borders to remeshing, which splits them and removes
nodes from straight rows only, so that a fold stays where it was drawn.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.topology import Topology, triangle_topology
from toile.remesh.adapt.transfer import TransferMap

ON_LINE = 1e-7
"""Vertices so far from a fold lie on it [m]: they are put there to rounding."""

SHARP = 2.0
"""Turn of a fold from which on its faces touch each other [rad]."""
PRESSED = 0.035
"""Contact radius of the nodes beside such a fold, as a share of the height of its faces: 2 degrees."""


class FoldLine(NamedTuple):
    """One fold.

    Attributes
    ----------
    points
        Its corners in pattern coordinates [m], shape (k, 2).
    angle
        By how much the cloth is turned there at rest [rad], -pi to pi; positive: right sides face each other.
    stiffness
        Moment per length and turn [N].
    parts
        Parts of its panel.
    """

    points: Float
    angle: float
    stiffness: float
    parts: tuple[int, ...]


class Hinges(NamedTuple):
    """Edges on folds.

    Attributes
    ----------
    sides
        Face and side of it that every edge is, and the face and side across, shape (e, 4).
    vertices
        Material vertices: both ends of the edge, counter-clockwise in the first face, the corner of that face
        opposite, that of the other face, shape (e, 4).
    length
        Rest length [m], shape (e,).
    line
        Number of the fold, shape (e,).
    """

    sides: Int
    vertices: Int
    length: Float
    line: Int


@dataclass(frozen=True, kw_only=True)
class Folds:
    """Folds of a cloth: part of every face, shape (t,), and the lines between parts."""

    part: Int
    lines: tuple[FoldLine, ...]

    @staticmethod
    def together(parts: "Sequence[Folds | None]", faces: Sequence[int]) -> "Folds | None":
        """Return the folds of garments with so many faces that become one cloth; None if none has any."""
        if all(part is None for part in parts):
            return None
        numbers, lines, first = [], list[FoldLine](), 0
        for folds, count in zip(parts, faces, strict=True):
            own = np.zeros(count, np.int32) if folds is None else folds.part
            numbers.append(own + np.int32(first))
            if folds is not None:
                lines += [
                    line._replace(parts=tuple(part + first for part in line.parts)) for line in folds.lines
                ]
            first += int(own.max(initial=0)) + 1
        return Folds(part=np.concatenate(numbers).astype(np.int32), lines=tuple(lines))

    def carried(self, transfer: TransferMap) -> "Folds":
        """Return the folds of the same cloth on another mesh."""
        return replace(self, part=self.part[transfer.faces])

    def hinges(self, faces: Int, uv: Float) -> Hinges:
        """Return the edges on folds of faces (t, 3) of vertices with pattern coordinates (m, 2) [m]."""
        topology = triangle_topology(faces)
        ahead = topology.neighbours > np.arange(len(faces))[:, None]
        face, side = np.nonzero(ahead)
        across, across_side = topology.neighbours[face, side], topology.neighbour_sides[face, side]
        differ = self.part[face] != self.part[across]
        face, side, across, across_side = face[differ], side[differ], across[differ], across_side[differ]
        a, b = faces[face, (side + 1) % 3], faces[face, (side + 2) % 3]
        number = np.full(len(face), -1, np.int32)
        for index, line in enumerate(self.lines):
            of_panel = np.isin(self.part[face], line.parts) & np.isin(self.part[across], line.parts)
            number[of_panel & _on_line(uv[a], line.points) & _on_line(uv[b], line.points)] = index
        found = number >= 0
        face, side, across, across_side = face[found], side[found], across[found], across_side[found]
        a, b = a[found], b[found]
        return Hinges(
            sides=np.column_stack((face, side, across, across_side)).astype(np.int32),
            vertices=np.column_stack((a, b, faces[face, side], faces[across, across_side])).astype(np.int32),
            length=np.linalg.norm(uv[b] - uv[a], axis=1),
            line=number[found],
        )

    def cut(self, topology: Topology, faces: Int, uv: Float) -> Topology:
        """Return a topology of the cloth's faces in which those across a fold are no neighbours."""
        face, side, across, across_side = self.hinges(faces, uv).sides.T
        neighbours, neighbour_sides = topology.neighbours.copy(), topology.neighbour_sides.copy()
        for one, at in ((face, side), (across, across_side)):
            neighbours[one, at] = neighbour_sides[one, at] = -1
        return topology._replace(neighbours=neighbours, neighbour_sides=neighbour_sides)


def pressed_radius(folds: Folds, faces: Int, uv: Float, node: Int) -> Float:
    """Return the largest contact radius of nodes beside sharp folds [m], infinite elsewhere, shape (n,).

    Both faces at a fold that shuts come as near as its angle wants: a radius that is not small beside their
    height would keep them open.
    """
    hinges = folds.hinges(faces, uv)
    sharp = np.array([abs(line.angle) > SHARP for line in folds.lines])[hinges.line]
    a, b, c, d = (uv[hinges.vertices[sharp, k]] for k in range(4))
    radius = np.full(int(node.max(initial=-1)) + 1, np.inf)
    along = (b - a) / hinges.length[sharp, None]
    for far in (c, d):
        height = np.abs(along[:, 0] * (far - a)[:, 1] - along[:, 1] * (far - a)[:, 0])
        for k in range(4):
            np.minimum.at(radius, node[hinges.vertices[sharp, k]], PRESSED * height)
    return radius


def _on_line(points: Float, line: Float) -> Bool:
    """Mark points (n, 2) that lie on a polyline (k, 2)."""
    found = np.zeros(len(points), bool)
    for start, end in pairwise(line):
        along = end - start
        share = np.clip((points - start) @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
        away = points - start - share[:, None] * along
        found |= np.einsum("ij,ij->i", away, away) <= ON_LINE**2
    return found
