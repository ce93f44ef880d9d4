"""Membrane energy of the triangles of a patch."""

import numpy as np

from toile.engine.forces.membrane import fill_energies, fill_rest_shapes
from toile.geometry.arrays import Float, Int


def patch_energies(
    positions: Float, triangles: Int, rest_corners: Float, stiffness: Float, like: Int
) -> Float:
    """Membrane energy of each triangle (q, 3) [J], shape (q,), as `Membrane` has it.

    Rest corners are (q, 3, 2) [m]; row `like`, shape (q,), of `stiffness` holds what pulls along warp and
    weft and in shear [N/m], and the share of it in compression.
    """
    energies, shape = np.empty(len(triangles)), np.empty((len(triangles), 11))
    fill_rest_shapes(rest_corners, shape)
    shape[:, [1, 2, 3, 10]] = stiffness[like]
    fill_energies(triangles, shape, positions, energies)
    return energies
