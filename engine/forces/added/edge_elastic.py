"""Elastic along runs of edges: a spring per edge that pulls and never pushes.

E = k L/2 (|d|/L - 1)^2 while |d| > L, else 0: L is the edge's length in the pattern times the rest length of
the elastic over that of the run, k its stiffness [N], d from one end to the other. The tension k (|d|/L - 1)
does not depend on the mesh. Where it is shortened elastic buckles, as threads do.
"""

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fields.edge_runs import RunEdges, run_edges
from toile.engine.forces.force import StepState
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float, Int

LEAST_LENGTH = 1e-9
"""Length [m] below which an edge has no direction."""


class EdgeElastic:
    """Elastic on the runs of a cloth whose seams are closed.

    Attributes
    ----------
    edges
        The edges that lie on runs.
    """

    elastic = True
    constant_matrix = None

    def __init__(self, cloth: Cloth, edges: RunEdges) -> None:
        self.edges = edges
        self.nodes: Int = edges.nodes
        self._runs = cloth.elastic
        self._keep(cloth.now)

    @classmethod
    def for_cloth(cls, cloth: Cloth) -> "EdgeElastic | None":
        """Return the elastic of a cloth; None where it has none, or while seams are open."""
        if not cloth.elastic or len(cloth.stitches):
            return None
        owner = np.column_stack([cloth.garment, cloth.panel])
        edges = run_edges(cloth.elastic, cloth.node, cloth.faces, owner, cloth.rest_space)
        return cls(cloth, edges) if len(edges.nodes) else None

    def _keep(self, seconds: float) -> None:
        self._lengths, self._stiffness = self.edges.numbers(self._runs, seconds)

    def begin(self, step: StepState, x: Float) -> bool:
        """Take lengths and stiffness at the end of the step."""
        self._keep(step.request.seconds)
        return True

    def _ways(self, x: Float) -> tuple[Float, Float]:
        """Return unit vectors along the edges, shape (e, 3), and their lengths [m], shape (e,)."""
        way = x[self.nodes[:, 0]] - x[self.nodes[:, 1]]
        length = np.linalg.norm(way, axis=1)
        return way / np.maximum(length, LEAST_LENGTH)[:, None], length

    def tension(self, x: Float) -> Float:
        """Tension of every edge at node positions x [N], shape (e,)."""
        _, length = self._ways(x)
        return np.asarray(self._stiffness * np.maximum(length / self._lengths - 1.0, 0.0))

    def energy(self, x: Float) -> float:
        """Energy [J] at node positions x [m], shape (n, 3)."""
        strain = np.maximum(self._ways(x)[1] / self._lengths - 1.0, 0.0)
        return 0.5 * float((self._stiffness * self._lengths) @ strain**2)

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add the derivative of the energy [N] to an array of shape (n, 3)."""
        along, _ = self._ways(x)
        pull = self.tension(x)[:, None] * along
        for axis in range(3):
            gradient[:, axis] += np.bincount(self.nodes[:, 0], pull[:, axis], len(x))
            gradient[:, axis] -= np.bincount(self.nodes[:, 1], pull[:, axis], len(x))

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add the gradient and the second derivatives, k/L along an edge, T/|d| across it."""
        self.add_gradient(x, gradient)
        along, length = self._ways(x)
        tension = self.tension(x)
        taut = tension > 0.0
        across = np.where(taut, tension / np.maximum(length, LEAST_LENGTH), 0.0)
        rest = np.where(taut, self._stiffness / self._lengths, 0.0) - across
        block = across[:, None, None] * np.eye(3) + rest[:, None, None] * along[:, :, None] * along[:, None]
        hessian.add_elements(self.nodes, np.stack([block, block, -block], axis=1))
