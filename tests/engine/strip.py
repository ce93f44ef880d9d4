"""A heavy strip held horizontally at one end: mesh, static equilibrium, how far its tip drops."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from tests.engine.meshes import mesh
from toile.engine.forces.bend import Bending, bending_tensor
from toile.engine.forces.membrane import Membrane
from toile.geometry.arrays import Bool, Float, Int

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


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


def equilibrium(
    strip: Strip, gammas: list[float], stiffness: float = 1e5, poisson: float = 0.0
) -> list[tuple[float, float]]:
    """Return (drop, reach) of the tip for increasing Gamma = weight L^3 / D, with L = D = 1.

    `stiffness` is that of the membrane times L^2 / D. Newton steps on the projected Hessian, each shortened
    until the energy falls.
    """
    points, faces, held = strip.points, strip.faces, strip.held
    count = len(points)
    ones = np.ones(len(faces))
    rest = np.ascontiguousarray(points[faces])
    membrane = Membrane(faces, rest, stiffness * ones, stiffness * ones, 0.5 * stiffness * ones)
    bending = Bending(faces, rest, bending_tensor(ones, ones, ones, poisson), count, pinned=held)
    area = 0.5 * np.abs(np.linalg.det(rest[:, 1:] - rest[:, :1]))
    node_area = np.bincount(faces.ravel(), np.repeat(area / 3, 3), count)
    x = np.column_stack((points[:, 0], np.zeros(count), points[:, 1]))
    free = np.flatnonzero(np.repeat(~held, 3))
    tip = np.abs(points[:, 0] - 1.0) < 1e-9
    constant = sp.kron(bending.stiffness, sp.eye(3)).tocsc()
    result = []
    for gamma in gammas:
        weight: Float = np.asarray(gamma * node_area, np.float64)

        def energy(y: Float, weight: Float = weight) -> float:
            return membrane.energy(y) + bending.energy(y) + float(weight @ y[:, 1])

        for _ in range(400):
            membrane.evaluate(x)
            gradient = bending.gradient(x)
            gradient[:, 1] += weight
            np.add.at(gradient, faces, membrane.element_gradient)
            matrix = (constant + _assembled(faces, membrane.element_hessian, count)).tocsc()[free][:, free]
            step = np.zeros(3 * count)
            step[free] = -splu(matrix).solve(gradient.ravel()[free])
            slope = float(step @ gradient.ravel())
            if -slope < 1e-9 * gamma**2:
                break
            scale, before = 1.0, energy(x)
            while energy(x + scale * step.reshape(-1, 3)) > before + 1e-4 * scale * slope and scale > 1e-6:
                scale *= 0.5
            x = x + scale * step.reshape(-1, 3)
        result.append((float(-x[tip, 1].mean()), float(x[tip, 0].mean())))
    return result


def _assembled(faces: Int, blocks: Float, count: int) -> sp.csc_array:
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
