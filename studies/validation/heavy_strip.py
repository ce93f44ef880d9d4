"""A heavy strip held at one end: mesh, static equilibrium under its weight, how far its tip drops."""

from dataclasses import dataclass
from math import inf

import numpy as np

from toile.engine.forces.bend import Bending, bending_tensor
from toile.engine.forces.force import Force
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.nodes import Nodes
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.stage_clock import StageClock
from toile.studies.scenes.flat_meshes import mesh
from toile.studies.scenes.motion import free_options

LONG_STEP = 1e4
"""Of the one step in which a strip finds its rest: inertia no longer counts [s]."""
SETTLED = StepRequest(
    h=LONG_STEP, at_rest=False, newton=400, newton_tolerance=1e-7, cg_tolerance=1e-4, cg_iterations=20_000,
    motion_max=inf,
)  # fmt: skip
"""The step of the engine that finds it, the last move less than 1e-7 of the length."""


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
    """A strip of length L = 1, rigidity D = 1, areal density 1, with the engine's forces: gravity is Gamma.

    Attributes
    ----------
    membrane, bending
        Its forces.
    node_area
        Rest area per node, shape (n,): its mass, too.
    tip
        Nodes of the free end, shape (n,).
    """

    def __init__(self, strip: Strip, stiffness: float = 1e5, poisson: float = 0.0) -> None:
        """Build with a membrane whose stiffness times L^2 / D is `stiffness`."""
        faces, count = strip.faces, len(strip.points)
        ones = np.ones(len(faces))
        rest = np.ascontiguousarray(strip.points[faces])
        self.strip = strip
        self.stiffness = stiffness * ones
        self.membrane = Membrane(faces, rest, stiffness * ones, stiffness * ones, 0.5 * stiffness * ones)
        tensor = bending_tensor(ones, ones, ones, poisson)
        self.bending = Bending(faces, rest, tensor, count, pinned=strip.held)
        area = 0.5 * np.abs(np.linalg.det(rest[:, 1:] - rest[:, :1]))
        shares = np.bincount(faces.ravel(), np.repeat(area / 3, 3), count)
        self.node_area: Float = np.asarray(shares, np.float64)
        self.tip: Bool = np.abs(strip.points[:, 0] - 1.0) < 1e-9

    def gradient(self, x: Float, gamma: float) -> Float:
        """Gradient of the energy at positions x, shape (n, 3), under the weight gamma per area along -y."""
        gradient = np.zeros_like(x)
        gradient[:, 1] = gamma * self.node_area
        self.membrane.add_gradient(x, gradient)
        self.bending.add_gradient(x, gradient)
        return gradient

    def settled(self, x: Float, gamma: float, pinned: Bool) -> Float:
        """Return the equilibrium from positions x, shape (n, 3), with nodes pinned, shape (n,).

        One step of the engine, so long that inertia does not count.
        """
        nodes = Nodes(x, np.zeros_like(x), self.node_area, pinned)
        forces: list[Force] = [self.membrane, self.bending]
        stepper = ClothStepper(nodes, forces, None, free_options(gravity=gamma), StageClock())
        stepper.step(SETTLED)
        return stepper.x


def equilibrium(
    strip: Strip, gammas: list[float], stiffness: float = 1e5, poisson: float = 0.0
) -> list[tuple[float, float]]:
    """Return (drop, reach) of the tip of a strip clamped level, for increasing Gamma = weight L^3 / D."""
    elastic = ElasticStrip(strip, stiffness, poisson)
    x: Float = np.column_stack((strip.points[:, 0], np.zeros(len(strip.points)), strip.points[:, 1]))
    result = []
    for gamma in gammas:
        x = elastic.settled(x, gamma, strip.held)
        result.append((float(-x[elastic.tip, 1].mean()), float(x[elastic.tip, 0].mean())))
    return result
