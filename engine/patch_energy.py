"""Membrane energy of the triangles of a patch."""

import numpy as np
from numba import types

from toile.engine.forces.membrane import fill_energies
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_2, F64_3, I32_1, OUT_F64_2, kernel


def patch_energies(
    positions: Float, triangles: Int, rest_corners: Float, stiffness: Float, like: Int
) -> Float:
    """Membrane energy of each triangle (q, 3) [J], shape (q,), as `Membrane` has it.

    Rest corners are (q, 3, 2) [m]; row `like`, shape (q,), of `stiffness` holds what pulls along warp and
    weft and in shear [N/m], and the share of it in compression.
    """
    energies, shape = np.empty(len(triangles)), np.empty((len(triangles), 11))
    _fill_shapes(rest_corners, stiffness, like, shape)
    fill_energies(triangles, shape, positions, energies)
    return energies


@kernel(types.void(F64_3, F64_2, I32_1, OUT_F64_2))
def _fill_shapes(rest, stiffness, like, shape):  # type: ignore[no-untyped-def]
    """Fill the constants (q, 11) that `Membrane` has for its faces; without rest area there is no energy."""
    for q in range(len(rest)):
        warp_1, weft_1 = rest[q, 1, 0] - rest[q, 0, 0], rest[q, 1, 1] - rest[q, 0, 1]
        warp_2, weft_2 = rest[q, 2, 0] - rest[q, 0, 0], rest[q, 2, 1] - rest[q, 0, 1]
        determinant = warp_1 * weft_2 - weft_1 * warp_2
        inverse = 1.0 / determinant if abs(determinant) > 0.0 else 0.0
        shape[q, 0] = 0.5 * abs(determinant)
        for entry in range(3):
            shape[q, 1 + entry] = stiffness[like[q], entry]
        shape[q, 10] = stiffness[like[q], 3]
        shape[q, 5], shape[q, 6] = weft_2 * inverse, -weft_1 * inverse
        shape[q, 8], shape[q, 9] = -warp_2 * inverse, warp_1 * inverse
        shape[q, 4], shape[q, 7] = -shape[q, 5] - shape[q, 6], -shape[q, 8] - shape[q, 9]
