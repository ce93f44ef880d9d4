"""Pieces of a garment that start inside the body and touch nothing that could free them."""

import numpy as np

from toile.dressing.body.avatar import Avatar
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import connected

SOLID = 0.5
"""Winding number from which a point counts as inside: bodies may have holes."""
AT_ONCE = 16
"""Points whose winding numbers are worked out together."""


def faces_inside(mesh: GarmentMesh, avatar: Avatar) -> Int:
    """Return the faces of pieces that lie inside the body with all their vertices, shape (k,).

    Pieces that are sewn to each other count as one.
    """
    pairs = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.stitches.reshape(-1, 2)])
    count = len(mesh.positions)
    piece = connected(pairs, count)
    inside = np.zeros(count, bool)
    for number in np.unique(piece[mesh.faces[:, 0]]):
        own = np.flatnonzero(piece == number)
        inside[own] = _all_inside(mesh.positions[own], avatar)
    return np.flatnonzero(inside[mesh.faces[:, 0]]).astype(np.int32)


def _all_inside(points: Float, avatar: Avatar) -> bool:
    """Whether all points, shape (n, 3), are inside a body; most often the first few tell."""
    low, high = avatar.vertices.min(axis=0), avatar.vertices.max(axis=0)
    if not ((points > low) & (points < high)).all():
        return False
    corners = avatar.vertices[avatar.faces]
    parts = np.split(points, range(1, len(points), AT_ONCE))
    return all(bool(_inside(part, corners).all()) for part in parts)


def _inside(points: Float, corners: Float) -> Bool:
    """Mark points, shape (n, 3), inside a surface of triangles, shape (f, 3, 3): by their solid angles.

    The winding number is the sum of the signed solid angles of all triangles over 4 pi (van Oosterom and
    Strackee 1983).
    """
    a, b, c = np.moveaxis(corners[None] - points[:, None, None], 2, 0)
    la, lb, lc = (np.linalg.norm(side, axis=-1) for side in (a, b, c))
    volume = np.einsum("nfi,nfi->nf", a, np.cross(b, c))
    ab, bc, ca = (np.einsum("nfi,nfi->nf", *sides) for sides in ((a, b), (b, c), (c, a)))
    angle = 2.0 * np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb)
    return np.asarray(angle.sum(axis=1) / (4.0 * np.pi) > SOLID)
