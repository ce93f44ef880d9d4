"""Membrane energy of the triangles of a patch."""

import numpy as np

from toile.engine.forces.laws.stretch_laws import StretchLaws, add_stretch_energies
from toile.engine.forces.membrane import fill_energies, fill_rest_shapes
from toile.geometry.arrays import Float, Int


def patch_energies(
    positions: Float,
    triangles: Int,
    rest_corners: Float,
    stiffness: Float,
    like: Int,
    laws: StretchLaws | None = None,
) -> Float:
    """Membrane energy of each triangle (q, 3) [J], shape (q,), as `Membrane` has it.

    Rest corners are (q, 3, 2) [m]; row `like`, shape (q,), of `stiffness` holds what pulls along warp and
    weft and in shear [N/m], and the share of it in compression. `laws` are those of the faces `like`.
    """
    energies, shape = np.empty(len(triangles)), np.empty((len(triangles), 11))
    fill_rest_shapes(rest_corners, shape)
    shape[:, [1, 2, 3, 10]] = stiffness[like]
    if laws is None:
        fill_energies(triangles, shape, positions, energies)
        return energies
    row = np.full(len(stiffness), -1, np.int32)
    row[laws.laws[:, 0]] = np.arange(len(laws.laws), dtype=np.int32)
    row = row[like]
    curved = np.flatnonzero(row >= 0).astype(np.int32)
    shape[curved, 1:3] = 0.0
    fill_energies(triangles, shape, positions, energies)
    of_triangles = np.column_stack((curved, laws.laws[row[curved], 1]))
    add_stretch_energies(
        of_triangles, laws.table, laws.spans, laws.shares[row[curved]], shape, triangles, positions, energies
    )
    return energies
