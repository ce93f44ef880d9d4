"""Membrane energy of the triangles of a patch."""

import numpy as np
from numba import types

from toile.engine.forces.membrane import energy_of
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_2, F64_3, I32_1, I32_2, OUT_F64_1, OUT_F64_2, kernel


def patch_energies(
    positions: Float, triangles: Int, rest_corners: Float, stiffness: Float, like: Int
) -> Float:
    """Membrane energy of each triangle (q, 3) [J], shape (q,), as `Membrane` has it.

    Rest corners are (q, 3, 2) [m]; row `like`, shape (q,), of `stiffness` holds what pulls along warp and
    weft and in shear [N/m], and the share of it in compression.
    """
    energies = np.empty(len(triangles))
    _energies(positions, triangles, rest_corners, stiffness, like, np.empty((1, 11)), energies)
    return energies


@kernel(types.void(F64_2, I32_2, F64_3, F64_2, I32_1, OUT_F64_2, OUT_F64_1))
def _energies(positions, triangles, rest, stiffness, like, shape, energies):  # type: ignore[no-untyped-def]
    """Fill `energies`; `shape` (1, 11) is work space."""
    corners = np.empty((1, 3), np.int32)
    for q in range(len(triangles)):
        warp_1, weft_1 = rest[q, 1, 0] - rest[q, 0, 0], rest[q, 1, 1] - rest[q, 0, 1]
        warp_2, weft_2 = rest[q, 2, 0] - rest[q, 0, 0], rest[q, 2, 1] - rest[q, 0, 1]
        determinant = warp_1 * weft_2 - weft_1 * warp_2
        energies[q] = 0.0
        if not abs(determinant) > 0.0:
            continue
        inverse = 1.0 / determinant
        shape[0, 0] = 0.5 * abs(determinant)
        for entry in range(3):
            shape[0, 1 + entry] = stiffness[like[q], entry]
            corners[0, entry] = triangles[q, entry]
        shape[0, 10] = stiffness[like[q], 3]
        shape[0, 5], shape[0, 6] = weft_2 * inverse, -weft_1 * inverse
        shape[0, 8], shape[0, 9] = -warp_2 * inverse, warp_1 * inverse
        shape[0, 4], shape[0, 7] = -shape[0, 5] - shape[0, 6], -shape[0, 8] - shape[0, 9]
        energies[q] = energy_of(corners, shape, positions, 0)
