"""Springs between pairs of nodes, of which mass-spring cloth is made.

E = k/2 (|d| - L)^2 with d the vector between the two nodes. The Hessian is k n n^T + k (1 - L/|d|)(I - n
n^T), n = d/|d|; a shortened spring pushes its ends sideways, so the second term is left out while |d| < L
(Choi and Ko 2002). A spring resists being lengthened by c (n . (v_a - v_b)) n, which no rigid motion calls
forth.
"""

from math import sqrt

import numpy as np
from numba import types

from toile.engine.forces.element_damping import ElementDamping
from toile.engine.forces.force import ElementForce
from toile.engine.solve.assembly import scatter_gradients
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_1, F64_2, I32_2, OUT_F64_1, OUT_F64_3, OUT_F64_4, kernel


@kernel(types.void(I32_2, F64_1, F64_1, F64_2, OUT_F64_1))
def _energies(pairs: Int, lengths: Float, stiffness: Float, x: Float, energy: Float) -> None:
    """Fill spring energies [J], shape (s,)."""
    for s in range(len(pairs)):
        i, j = pairs[s, 0], pairs[s, 1]
        dx, dy, dz = x[i, 0] - x[j, 0], x[i, 1] - x[j, 1], x[i, 2] - x[j, 2]
        extension = sqrt(dx * dx + dy * dy + dz * dz) - lengths[s]
        energy[s] = 0.5 * stiffness[s] * extension * extension


@kernel(types.void(I32_2, F64_1, F64_1, F64_2, OUT_F64_3))
def _gradients(pairs: Int, lengths: Float, stiffness: Float, x: Float, gradient: Float) -> None:
    """Fill gradients at the two ends [N], shape (s, 2, 3)."""
    d = np.empty(3, np.float64)
    for s in range(len(pairs)):
        i, j = pairs[s, 0], pairs[s, 1]
        for c in range(3):
            d[c] = x[i, c] - x[j, c]
        distance = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        pull = stiffness[s] * (1.0 - lengths[s] / distance) if distance > 0.0 else 0.0
        for c in range(3):
            gradient[s, 0, c] = pull * d[c]
            gradient[s, 1, c] = -pull * d[c]


@kernel(types.void(I32_2, F64_1, F64_1, F64_2, OUT_F64_4))
def _hessians(pairs: Int, lengths: Float, along: Float, x: Float, hessian: Float) -> None:
    """Fill blocks (0,0), (1,1), (0,1) [N/m] of the stiffness `along`, shape (s, 3, 3, 3).

    Across a spring acts its tension over its length; a spring without rest length is alike in all directions,
    one whose ends meet has no direction and counts as such.
    """
    d = np.empty(3, np.float64)
    for s in range(len(pairs)):
        i, j = pairs[s, 0], pairs[s, 1]
        for c in range(3):
            d[c] = x[i, c] - x[j, c]
        squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
        across = along[s] * max(0.0, 1.0 - lengths[s] / sqrt(squared)) if squared > 0.0 else along[s]
        rest = (along[s] - across) / squared if squared > 0.0 else 0.0
        for r in range(3):
            for c in range(3):
                value = rest * d[r] * d[c]
                if r == c:
                    value += across
                hessian[s, 0, r, c] = value
                hessian[s, 1, r, c] = value
                hessian[s, 2, r, c] = -value


class Springs(ElementForce):
    """Springs of one topology.

    Attributes
    ----------
    pairs
        Their two nodes, shape (s, 2).
    lengths, stiffness
        Rest lengths [m] and stiffness [N/m], shape (s,).
    element_energy, element_gradient, element_hessian
        Energies [J], shape (s,), gradients at the ends [N], shape (s, 2, 3), and positive semi-definite
        blocks (0,0), (1,1), (0,1) [N/m], shape (s, 3, 3, 3).
    """

    def __init__(self, pairs: Int, lengths: Float, stiffness: Float) -> None:
        self.pairs = self.nodes = pairs
        self.lengths = lengths
        self.stiffness = stiffness
        self.element_energy = np.zeros(len(pairs))
        self.element_gradient = np.zeros((len(pairs), 2, 3))
        self.element_hessian = np.zeros((len(pairs), 3, 3, 3))

    def energy(self, x: Float) -> float:
        """Energy [J] at node positions x [m], shape (n, 3)."""
        _energies(self.pairs, self.lengths, self.stiffness, x, self.element_energy)
        return float(self.element_energy.sum())

    def evaluate_gradient(self, x: Float) -> None:
        """Fill the gradients at node positions x [m], shape (n, 3)."""
        _gradients(self.pairs, self.lengths, self.stiffness, x, self.element_gradient)

    def evaluate(self, x: Float) -> None:
        """Fill gradients and Hessian blocks at node positions x [m], shape (n, 3)."""
        self.evaluate_gradient(x)
        _hessians(self.pairs, self.lengths, self.stiffness, x, self.element_hessian)

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add the derivative of the energy [N] to an array of shape (n, 3)."""
        self.evaluate_gradient(x)
        scatter_gradients(self.pairs, self.element_gradient, gradient)

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add gradient and projected Hessian at node positions x [m], shape (n, 3)."""
        self.evaluate(x)
        scatter_gradients(self.pairs, self.element_gradient, gradient)
        hessian.add_elements(self.pairs, self.element_hessian)


class SpringDamping(ElementDamping):
    """Damping of the lengthening of springs, c (n . (v_a - v_b)) n."""

    def __init__(self, springs: Springs, seconds: float) -> None:
        """Build for coefficients of `seconds` times each spring's stiffness."""
        super().__init__(springs.pairs)
        self._coefficients: Float = seconds * springs.stiffness
        # An endless rest length leaves nothing but what acts along the spring.
        self._along_only: Float = np.full(len(springs.pairs), np.inf)

    def evaluate(self, x: Float) -> None:
        """Fill the blocks at node positions x [m], shape (n, 3)."""
        _hessians(self.nodes, self._along_only, self._coefficients, x, self.element_damping)
