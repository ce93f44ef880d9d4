"""The order in which stitches close: from the junctions of seams outward, like a zipper.

Where several panels meet in one point (armpit, crotch), seams that close everywhere at once can trap a
corner of one panel between the others. Closing the junction first leaves no corner to trap.
"""

import numpy as np

from toile.geometry.arrays import Float, Int


def zipper_distance(positions: Float, stitches: Int, seam: Int, weld: Int) -> Float:
    """Distance of every stitch from the nearest junction along its own seam [m], shape (s,).

    Parameters
    ----------
    positions
        Node positions [m], shape (n, 3), panels still flat.
    stitches, seam
        Node pairs in order along each seam, shape (s, 2), and the seam of each, shape (s,).
    weld
        Future node of every node, shape (n,).

    A junction is a future node in which several seams meet. A seam without one closes all at once.
    """
    group = weld[stitches[:, 0]]
    pairs = np.unique(np.stack([group, seam], axis=1), axis=0)
    seams_at = np.bincount(pairs[:, 0], minlength=len(weld))
    distance = np.zeros(len(stitches))
    for index in np.unique(seam):
        rows = np.flatnonzero(seam == index)
        points = positions[stitches[rows, 0]]
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        junctions = along[seams_at[group[rows]] > 1]
        if len(junctions):
            distance[rows] = np.abs(along[:, None] - junctions[None, :]).min(axis=1)
    return distance
