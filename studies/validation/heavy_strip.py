"""A heavy strip held at one end: mesh, static equilibrium under its weight, how far its tip drops."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from toile.engine.forces.bend import Bending, bending_tensor
from toile.engine.forces.membrane import Membrane
from toile.geometry.arrays import Bool, Float, Int
from toile.studies.scenes.flat_meshes import mesh

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Corners whose coupling each of the six blocks of an element Hessian holds."""
ITERATIONS = 400
TOLERANCE = 1e-9
"""Energy over Gamma^2 that the last Newton step of a sagging strip promises."""


@dataclass(frozen=True)
class Strip:
    """Strip along x from 0 to 1, one row of held faces behind x = 0 (the clamp ends exactly there)."""

    points: Float
    faces: Int
    held: Bool


def clamped_strip(kind: str, width: float, edge: float, seed: int = 1) -> Strip:
    """Return a strip of the given kind of mesh with its held row."""
    points, faces = mesh(kind, 1.0, width, edge, seed)
    root = np.flatnonzero(np.abs(points[:, 0]) < 1e-9)
    root = root[np.argsort(points[root, 1])]
    behind = np.column_stack((np.full(len(root), -edge), points[root, 1]))
    new = len(points) + np.arange(len(root))
    quads = np.concatenate(
        (
            np.column_stack((new[:-1], root[:-1], root[1:])),
            np.column_stack((new[:-1], root[1:], new[1:])),
        )
    )
    held = np.zeros(len(points) + len(root), bool)
    held[root] = held[new] = True
    return Strip(np.concatenate((points, behind)), np.concatenate((faces, quads)).astype(np.int32), held)


class ElasticStrip:
    """A strip of length L = 1 and bending rigidity D = 1, with the engine's membrane and bending.

    Attributes
    ----------
    node_area
        Rest area per node, shape (n,).
    tip
        Nodes of the free end, shape (n,).
    """

    def __init__(self, strip: Strip, stiffness: float = 1e5, poisson: float = 0.0) -> None:
        """Build with a membrane whose stiffness times L^2 / D is `stiffness`."""
        faces, count = strip.faces, len(strip.points)
        ones = np.ones(len(faces))
        rest = np.ascontiguousarray(strip.points[faces])
        self.strip = strip
        self.membrane = Membrane(faces, rest, stiffness * ones, stiffness * ones, 0.5 * stiffness * ones)
        tensor = bending_tensor(ones, ones, ones, poisson)
        self.bending = Bending(faces, rest, tensor, count, pinned=strip.held)
        area = 0.5 * np.abs(np.linalg.det(rest[:, 1:] - rest[:, :1]))
        shares = np.bincount(faces.ravel(), np.repeat(area / 3, 3), count)
        self.node_area: Float = np.asarray(shares, np.float64)
        self.tip: Bool = np.abs(strip.points[:, 0] - 1.0) < 1e-9
        self._bending_matrix = sp.kron(self.bending.stiffness, sp.eye(3)).tocsc()

    def gradient(self, x: Float, gamma: float) -> Float:
        """Gradient of the energy at positions x, shape (n, 3), under the weight gamma per area along -y."""
        self.membrane.evaluate(x)
        gradient = self.bending.gradient(x)
        gradient[:, 1] += gamma * self.node_area
        np.add.at(gradient, self.strip.faces, self.membrane.element_gradient)
        return gradient

    def energy(self, x: Float, gamma: float) -> float:
        """Energy at positions x, shape (n, 3)."""
        weight = gamma * float(self.node_area @ x[:, 1])
        return self.membrane.energy(x) + self.bending.energy(x) + weight

    def settled(self, x: Float, gamma: float, fixed: Bool, tolerance: float) -> Float:
        """Return the equilibrium from positions x, shape (n, 3), with coordinates fixed, shape (n, 3).

        Newton steps on the projected Hessian, each shortened until the energy falls; the last one promises
        less than `tolerance` of it.
        """
        free = np.flatnonzero(~fixed.ravel())
        for _ in range(ITERATIONS):
            gradient = self.gradient(x, gamma)
            matrix = (self._bending_matrix + self._membrane_matrix()).tocsc()[free][:, free]
            step = np.zeros(x.size)
            step[free] = -splu(matrix).solve(gradient.ravel()[free])
            slope = float(step @ gradient.ravel())
            if -slope < tolerance:
                break
            scale, before = 1.0, self.energy(x, gamma)
            while (
                self.energy(x + scale * step.reshape(-1, 3), gamma) > before + 1e-4 * scale * slope
                and scale > 1e-6
            ):
                scale *= 0.5
            x = x + scale * step.reshape(-1, 3)
        return x

    def _membrane_matrix(self) -> sp.csc_array:
        """Hessian of the membrane where it was evaluated last, its negative part dropped."""
        faces, blocks, count = self.strip.faces, self.membrane.element_hessian, len(self.strip.points)
        rows, columns, values = [], [], []
        axis = np.arange(3)
        for pair, (a, b) in enumerate(PAIRS):
            for i, j, block in ((a, b, blocks[:, pair]),) + (
                ((b, a, blocks[:, pair].swapaxes(1, 2)),) if a != b else ()
            ):
                rows.append(np.broadcast_to(3 * faces[:, i, None, None] + axis[:, None], block.shape).ravel())
                columns.append(np.broadcast_to(3 * faces[:, j, None, None] + axis, block.shape).ravel())
                values.append(block.ravel())
        entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
        return sp.csc_array(sp.coo_array(entries, shape=(3 * count, 3 * count)))


def equilibrium(
    strip: Strip, gammas: list[float], stiffness: float = 1e5, poisson: float = 0.0
) -> list[tuple[float, float]]:
    """Return (drop, reach) of the tip of a strip clamped level, for increasing Gamma = weight L^3 / D."""
    elastic = ElasticStrip(strip, stiffness, poisson)
    x: Float = np.column_stack((strip.points[:, 0], np.zeros(len(strip.points)), strip.points[:, 1]))
    fixed = np.repeat(strip.held[:, None], 3, axis=1)
    result = []
    for gamma in gammas:
        x = elastic.settled(x, gamma, fixed, TOLERANCE * gamma**2)
        result.append((float(-x[elastic.tip, 1].mean()), float(x[elastic.tip, 0].mean())))
    return result
