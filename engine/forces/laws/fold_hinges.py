"""Folds as hinges: a moment in proportion to how far the cloth is turned from its rest angle.

E = sum over the edges of a fold  k l/2 (theta - theta_0)^2 with l the edge's rest length and k a moment per
length and turn [N]. theta is the angle between the planes of the two faces, positive where their right sides
face each other. It is told apart from theta - 2 pi by the side on which the fold opens: its range is
theta_0/6 +- pi, so that a fold shut flat may press a little through 180 degrees. The faces beside a fold bend
as if it were a border (`Folds.cut`), so the hinge alone turns there.

With n_1, n_2 the normals, h_1, h_2 the heights of the faces above the edge and s_1, s_2 where these stand on
it, d theta/dx is n_1/h_1 and n_2/h_2 at the far corners, and minus the shares 1 - s and s of both at the
ends. The Hessian is k l of its square (Gauss-Newton). Sources: Bridson, Marino and Fedkiw 2003; Grinspun,
Hirani, Desbrun and Schroeder 2003.
"""

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.force import ElementForce
from toile.engine.solve.assembly import node_pairs, scatter_gradients
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float, Int
from toile.remesh.sizing.row_products import row_dot

_FIRST, _SECOND = (np.array(ends) for ends in zip(*node_pairs(4), strict=True))


class FoldHinges(ElementForce):
    """Hinges of one mesh: `nodes` (e, 4) are both ends of an edge, then the far corners of its faces."""

    nodes: Int

    def __init__(self, nodes: Int, stiffness: Float, angle: Float) -> None:
        """Build for hinges of stiffness times length [N m], shape (e,), and rest angles [rad], shape (e,)."""
        self.nodes = np.ascontiguousarray(nodes, np.int32)
        self._stiffness = stiffness
        self._angle = angle

    @classmethod
    def for_cloth(cls, cloth: Cloth) -> "FoldHinges | None":
        """Return the hinges of a cloth's folds, or None where it has none."""
        if cloth.folds is None:
            return None
        hinges, lines = cloth.folds.hinges(cloth.faces, cloth.uv), cloth.folds.lines
        stiffness, angle = (
            np.array([getattr(line, name) for line in lines]) for name in ("stiffness", "angle")
        )
        return cls(cloth.node[hinges.vertices], stiffness[hinges.line] * hinges.length, angle[hinges.line])

    def angles(self, x: Float) -> Float:
        """Return the angle of every hinge at node positions x [m], shape (n, 3): shape (e,) [rad]."""
        a, b, c, d = (x[self.nodes[:, k]] for k in range(4))
        one, two = np.cross(b - a, c - a), np.cross(a - b, d - b)
        edge = np.linalg.norm(b - a, axis=1)
        sine = -row_dot(np.cross(one, two), b - a) / np.maximum(edge, 1e-300)
        angle = np.arctan2(sine, row_dot(one, two))
        middle = self._angle / 6.0
        return np.asarray(angle - 2.0 * np.pi * np.round((angle - middle) / (2.0 * np.pi)))

    def energy(self, x: Float) -> float:
        """Energy [J] at node positions x [m], shape (n, 3)."""
        return 0.5 * float(self._stiffness @ (self.angles(x) - self._angle) ** 2)

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add the derivative of the energy [N] to an array of shape (n, 3)."""
        moment = self._stiffness * (self.angles(x) - self._angle)
        scatter_gradients(self.nodes, moment[:, None, None] * self._slopes(x), gradient)

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add the gradient and the square of the angle's derivative times the stiffness."""
        slopes = self._slopes(x)
        moment = self._stiffness * (self.angles(x) - self._angle)
        scatter_gradients(self.nodes, moment[:, None, None] * slopes, gradient)
        stiff = self._stiffness[:, None, None] * slopes
        blocks = stiff[:, _FIRST, :, None] * slopes[:, _SECOND, None, :]
        hessian.add_elements(self.nodes, np.ascontiguousarray(blocks))

    def _slopes(self, x: Float) -> Float:
        """Return the derivative of every angle at its nodes [1/m], shape (e, 4, 3)."""
        a, b, c, d = (x[self.nodes[:, k]] for k in range(4))
        along = b - a
        squared = np.maximum(row_dot(along, along), 1e-300)[:, None]
        slopes = np.empty((len(a), 4, 3))
        ends = np.zeros((2, len(a), 3))
        for corner, far, sign in ((2, c, 1.0), (3, d, -1.0)):
            normal = sign * np.cross(along, far - a)
            # the normal's length is the edge's times the height
            slopes[:, corner] = (
                normal * np.sqrt(squared) / np.maximum(row_dot(normal, normal), 1e-300)[:, None]
            )
            share = (row_dot(far - a, along))[:, None] / squared
            ends[0] -= (1.0 - share) * slopes[:, corner]
            ends[1] -= share * slopes[:, corner]
        slopes[:, 0], slopes[:, 1] = ends
        return slopes
