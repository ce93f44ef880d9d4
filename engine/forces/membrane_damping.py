"""Damping of stretch and shear in fabric: Baraff and Witkin's velocity-dependent forces.

Each condition C (stretch along warp and weft, shear) has the force -d (dC/dt) dC/dx (Baraff and Witkin 1998,
section 4.5) with d its stiffness times a time, so it depends on the rate of strain only: no rigid motion
calls it forth. In (f_u, f_v) the blocks are k_u n_u n_u^T, k_v n_v n_v^T and k_s g g^T, with n_u = f_u/|f_u|
and g = (f_v, f_u).
"""

from math import sqrt

import numpy as np
from numba import types

from toile.engine.forces.element_damping import ElementDamping
from toile.engine.forces.membrane import Membrane
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_1, F64_2, I32_2, OUT_F64_4, kernel


@kernel(types.void(I32_2, F64_2, F64_1, F64_2, OUT_F64_4))
def _evaluate(faces: Int, shape: Float, seconds: Float, x: Float, damping: Float) -> None:
    """Fill blocks of the corner pairs [N s/m], shape (t, 6, 3, 3); columns of `shape` as in the membrane."""
    # rows: dC/dx of the corners for warp, weft and shear
    f, slope = np.empty((2, 3), np.float64), np.empty((3, 3, 3), np.float64)
    for t in range(len(faces)):
        i, j, k = faces[t, 0], faces[t, 1], faces[t, 2]
        for c in range(3):
            f[0, c] = shape[t, 4] * x[i, c] + shape[t, 5] * x[j, c] + shape[t, 6] * x[k, c]
            f[1, c] = shape[t, 7] * x[i, c] + shape[t, 8] * x[j, c] + shape[t, 9] * x[k, c]
        length_u = sqrt(f[0, 0] * f[0, 0] + f[0, 1] * f[0, 1] + f[0, 2] * f[0, 2])
        length_v = sqrt(f[1, 0] * f[1, 0] + f[1, 1] * f[1, 1] + f[1, 2] * f[1, 2])
        root_u = sqrt(shape[t, 1]) / length_u if length_u > 0.0 else 0.0
        root_v = sqrt(shape[t, 2]) / length_v if length_v > 0.0 else 0.0
        root_s = sqrt(shape[t, 3])
        for a in range(3):
            du, dv = shape[t, 4 + a], shape[t, 7 + a]
            for c in range(3):
                slope[0, a, c] = root_u * du * f[0, c]
                slope[1, a, c] = root_v * dv * f[1, c]
                slope[2, a, c] = root_s * (du * f[1, c] + dv * f[0, c])
        scale = seconds[t] * shape[t, 0]
        for pair in range(6):
            a = pair if pair < 3 else (0 if pair < 5 else 1)
            b = pair if pair < 3 else (1 if pair == 3 else 2)
            for r in range(3):
                for c in range(3):
                    damping[t, pair, r, c] = scale * (
                        slope[0, a, r] * slope[0, b, c]
                        + slope[1, a, r] * slope[1, b, c]
                        + slope[2, a, r] * slope[2, b, c]
                    )


class MembraneDamping(ElementDamping):
    """Damping of a membrane; blocks are of the corner pairs in the order of `Membrane.element_hessian`."""

    def __init__(self, membrane: Membrane, seconds: Float | float) -> None:
        """Build for damping of `seconds` times the stiffness in tension, for all faces or per face (t,)."""
        super().__init__(membrane.faces)
        self._shape = membrane.damped_shape
        self._seconds = np.full(len(membrane.faces), seconds, np.float64)

    def evaluate(self, x: Float) -> None:
        """Fill the blocks at node positions x [m], shape (n, 3)."""
        _evaluate(self.nodes, self._shape, self._seconds, x, self.element_damping)
