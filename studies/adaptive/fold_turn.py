"""The RMS curvature of a draped surface, a measure of how strongly it is folded that ignores where."""

import numpy as np

from toile.dressing.garment.mesh_garment import flattened, warp_directions
from toile.geometry.arrays import Float, Int
from toile.geometry.patch import bending_patches
from toile.geometry.topology import triangle_topology


def fold_turn(positions: Float, faces: Int) -> float:
    """Return how far a surface turns along it, root of k1^2 + k2^2 in the mean over its area [rad/m].

    Nodes (n, 3) [m], faces (t, 3). A fold adds the angle between its sides for as long as it is, wherever it
    is, so this is the number of folds weighed by how sharp they are. Curvature is that of `bending_patches`
    with every triangle laid flat as it is, exact on quadratics: angles between triangles would grow with the
    disorder of the mesh. Vertices at one place, as on both sides of a seam, count as one.
    """
    places, vertex = np.unique(positions, axis=0, return_inverse=True)
    faces = np.ascontiguousarray(vertex.reshape(-1)[faces], np.int32)
    corners = places[faces]
    flat = flattened(corners, warp_directions(corners, None))
    patches = bending_patches(faces, flat, triangle_topology(faces), len(places))
    bent = (patches.second_derivatives @ places).reshape(-1, 3, 3)
    turn = np.sqrt(np.einsum("tai,tai,a->t", bent, bent, [1.0, 1.0, 2.0]))
    return float(np.average(turn, weights=patches.areas))
