"""The mass-spring cloth: point masses and springs, on grids and on any triangle mesh.

It is the model to learn from and to compare with: what its springs weigh and resist depends on the mesh, its
bending grows with the fourth power of the turn instead of the second, and its Poisson's ratio is fixed.
"""

from typing import NamedTuple

import numpy as np

from toile.engine.cloth.fabric import Fabric
from toile.engine.forces.force import Force
from toile.engine.forces.spring import SpringDamping, Springs
from toile.engine.forces.wind import Wind
from toile.engine.step.nodes import Nodes
from toile.engine.step.options import StepOptions
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.stage_clock import StageClock
from toile.geometry.topology import triangle_topology
from toile.remesh.panel.grid import grid_mesh

BENDING_TURN = 0.3
"""Turn between neighbouring springs at which bending springs have the energy of the fabric [rad]."""


class SpringNet(NamedTuple):
    """Springs of a cloth, its masses and the faces that wind blows on.

    pairs: shape (s, 2). lengths [m], stiffness [N/m]: shape (s,). mass [kg]: shape (n,). faces: shape (t, 3).
    """

    pairs: Int
    lengths: Float
    stiffness: Float
    mass: Float
    faces: Int


def grid_springs(width: float, height: float, columns: int, rows: int, fabric: Fabric) -> SpringNet:
    """Return the classic net on a `grid_mesh`: structural, shear and bending springs (Provot 1995).

    Cells of du x dv: a structural spring along warp has the stiffness of its strip, k_u dv/du, half of it on
    borders; the diagonals of a cell resist its shear like the fabric, k_s (du^2 + dv^2) / (2 du dv) each; a
    bending spring joins every second node of a row or column, 16 D dv / (BENDING_TURN^2 du^3).
    """
    du, dv = width / columns, height / rows
    grid = grid_mesh(width, height, columns, rows)
    node = np.arange(len(grid.points), dtype=np.int32).reshape(rows + 1, columns + 1)
    border_row, border_column = np.ones(node.shape), np.ones(node.shape)
    border_row[[0, -1]] = 0.5
    border_column[:, [0, -1]] = 0.5
    shear = np.full((rows, columns), fabric.shear * (du**2 + dv**2) / (2.0 * du * dv))
    warp, weft = fabric.stretch_warp * dv / du, fabric.stretch_weft * du / dv
    bend_warp = 16.0 * fabric.bending_warp * dv / (BENDING_TURN**2 * du**3)
    bend_weft = 16.0 * fabric.bending_weft * du / (BENDING_TURN**2 * dv**3)
    groups = [
        (node[:, :-1], node[:, 1:], warp * border_row[:, 1:]),
        (node[:-1], node[1:], weft * border_column[1:]),
        (node[:-1, :-1], node[1:, 1:], shear),
        (node[:-1, 1:], node[1:, :-1], shear),
        (node[:, :-2], node[:, 2:], bend_warp * border_row[:, 2:]),
        (node[:-2], node[2:], bend_weft * border_column[2:]),
    ]
    pairs = np.concatenate([np.stack((a.ravel(), b.ravel()), 1) for a, b, _ in groups])
    stiffness = np.concatenate([k.ravel() for _, _, k in groups])
    kept = stiffness > 0.0
    mass = fabric.areal_density * du * dv * border_row * border_column
    return _net(pairs[kept], stiffness[kept], mass.ravel(), grid.faces, grid.points)


def mesh_springs(points: Float, faces: Int, fabric: Fabric) -> SpringNet:
    """Return the net of a triangle mesh at rest, points [m] (n, 3) or (n, 2), faces (t, 3).

    Edges are structural springs of stiffness k A/|e|^2, A the area of their faces and k the mean stretch
    stiffness (Van Gelder 1998: no choice of constants is exact); bending springs join the two nodes across an
    edge, of 16 D |e| / (BENDING_TURN^2 height^3) with the mean height of its faces and the mean rigidity.
    """
    corners = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))[faces]
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    topology = triangle_topology(faces)
    edges = topology.edges
    edge_area = np.bincount(topology.face_edges.ravel(), np.repeat(area, 3), len(edges))
    squared = ((points[edges[:, 0]] - points[edges[:, 1]]) ** 2).sum(axis=1)
    structural = 0.5 * (fabric.stretch_warp + fabric.stretch_weft) * edge_area / squared

    face, side = np.nonzero(topology.neighbours > np.arange(len(faces))[:, None])
    other = faces[topology.neighbours[face, side], topology.neighbour_sides[face, side]]
    across = np.stack((faces[face, side], other), axis=1)
    inner = topology.face_edges[face, side]
    length = np.sqrt(squared[inner])
    height = edge_area[inner] / length
    rigidity = (fabric.bending_warp + fabric.bending_weft + fabric.bending_bias) / 3.0
    bending = 16.0 * rigidity * length / (BENDING_TURN**2 * height**3)
    mass = np.bincount(faces.ravel(), np.repeat(fabric.areal_density * area / 3.0, 3)).astype(np.float64)
    pairs = np.concatenate((edges, across)).astype(np.int32)
    stiffness = np.concatenate((structural, bending)).astype(np.float64)
    kept = stiffness > 0.0
    return _net(pairs[kept], stiffness[kept], mass, faces, points)


def spring_stepper(
    net: SpringNet, positions: Float, pinned: Bool, options: StepOptions, damping: float = 0.0
) -> ClothStepper:
    """Return the stepper of a net at positions [m], shape (n, 3), at rest; pinned: shape (n,).

    `damping` is the time [s] by which damping exceeds the stiffness of every spring, number for number.
    """
    springs = Springs(net.pairs, net.lengths, net.stiffness)
    forces: list[Force] = [springs]
    if damping > 0.0:
        forces.append(SpringDamping(springs, damping))
    if options.air is not None:
        forces.append(Wind(net.faces, len(net.mass), options.air))
    nodes = Nodes(positions, np.zeros_like(positions), net.mass, pinned)
    return ClothStepper(nodes, forces, None, options, StageClock())


def _net(pairs: Int, stiffness: Float, mass: Float, faces: Int, points: Float) -> SpringNet:
    """Return a net whose springs have their length at `points` [m]."""
    lengths = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    return SpringNet(np.ascontiguousarray(pairs), lengths, stiffness, mass, faces)
