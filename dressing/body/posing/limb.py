"""A limb of a body: rings at equal distance from its tip along the surface, up to where it leaves the trunk.

Distances run along the mesh, so that a limb is found even where its skin touches or crosses the trunk's, as
long as both are not one surface there.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from toile.geometry.arrays import Float, Int
from toile.geometry.connected import connected_vertices

STEP = 0.01
"""Distance between rings, in body heights."""
WRIST = 0.115
"""Distance of the wrist from the fingertips, in body heights: beyond it, fingers have rings of their own."""
SHORTEST, LONGEST = 0.24, 0.56
"""Distance of the armpit from the fingertips, in body heights."""
WIDER = 1.6
"""Where rings are this much longer than on the limb before, they run around the trunk."""
BEFORE_TRUNK = 2
"""Rings between the limb's last and the first that is wider."""
SMOOTHED = 2
"""Rings on either side over which centres are averaged."""


@dataclass(frozen=True, kw_only=True)
class Limb:
    """An arm of a body.

    Attributes
    ----------
    distance
        From its tip along the surface [m], shape (v,); infinite on other pieces of the mesh.
    levels
        Distances of its rings from the tip [m], from trunk to wrist, shape (r,).
    centres
        Of these rings [m], shape (r, 3).
    """

    distance: Float
    levels: Float
    centres: Float


def arms_of(vertices: Float, faces: Int) -> tuple[Limb, Limb] | None:
    """Return the arms of a body that stands on y = 0 [m], shapes (v, 3) and (f, 3); None if it shows none.

    Feet and hands are where the surface is farthest from the crown and from each other; hands are the higher
    two of the four.
    """
    piece = connected_vertices(faces, len(vertices))
    own = piece == np.bincount(piece).argmax()
    height = float(np.ptp(vertices[own, 1]))
    graph = _edges(vertices, faces)
    nearest = _from(graph, int(np.where(own, vertices[:, 1], -np.inf).argmax()))
    tips: list[int] = []
    for _ in range(4):
        tips.append(int(np.where(own, nearest, -np.inf).argmax()))
        nearest = np.minimum(nearest, _from(graph, tips[-1]))
    arms = [
        _limb(vertices, faces, _from(graph, tip), height)
        for tip in sorted(tips, key=lambda tip: -vertices[tip, 1])[:2]
    ]
    if arms[0] is None or arms[1] is None:
        return None
    return arms[0], arms[1]


def _edges(vertices: Float, faces: Int) -> csr_array:
    """Lengths of the edges of a closed mesh [m], each in both directions, shape (v, v)."""
    a, b = faces.ravel(), faces[:, [1, 2, 0]].ravel()
    lengths = np.linalg.norm(vertices[a] - vertices[b], axis=1)
    return csr_array(coo_array((lengths, (a, b)), shape=(len(vertices),) * 2))


def _from(graph: csr_array, vertex: int) -> Float:
    """Distance from a vertex along the edges [m], shape (v,)."""
    return np.asarray(dijkstra(graph, directed=True, indices=np.array([vertex]))[0], np.float64)


def _limb(vertices: Float, faces: Int, distance: Float, height: float) -> Limb | None:
    """Return the limb that ends at distance 0; None if nothing tells where it leaves the trunk."""
    levels = height * np.arange(WRIST, LONGEST, STEP)
    rings = [_ring(vertices, faces, distance, level) for level in levels]
    lengths = np.array([length for length, _ in rings])
    for k in range(round((SHORTEST - WRIST) / STEP), len(levels)):
        if lengths[k] > WIDER * np.median(lengths[: k - BEFORE_TRUNK]):
            last = k - BEFORE_TRUNK
            centres = _smoothed(np.array([centre for _, centre in rings[: last + 1]]))
            return Limb(distance=distance, levels=levels[last::-1], centres=centres[::-1])
    return None


def _ring(vertices: Float, faces: Int, distance: Float, level: float) -> tuple[float, Float]:
    """Length of the line at a distance [m] on the surface, and its centre [m], shape (3,)."""
    above = distance[faces] > level
    crossed = np.flatnonzero(above.any(axis=1) & ~above.all(axis=1))
    corner, above = faces[crossed], above[crossed]
    # The corner that lies alone on its side of the line.
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (~above).argmax(axis=1))
    row = np.arange(len(crossed))
    tip = corner[row, alone]
    ends = []
    for other in (corner[row, (alone + 1) % 3], corner[row, (alone + 2) % 3]):
        share = (level - distance[tip]) / (distance[other] - distance[tip])
        ends.append(vertices[tip] + share[:, None] * (vertices[other] - vertices[tip]))
    length = np.linalg.norm(ends[1] - ends[0], axis=1)
    whole = float(length.sum())
    centre = (length[:, None] * 0.5 * (ends[0] + ends[1])).sum(axis=0) / max(whole, 1e-12)
    return whole, np.asarray(centre)


def _smoothed(centres: Float) -> Float:
    """Centres averaged with their neighbours, ends included, shape (r, 3)."""
    before = 2.0 * centres[:1] - centres[SMOOTHED:0:-1]
    after = 2.0 * centres[-1:] - centres[-2 : -2 - SMOOTHED : -1]
    padded = np.concatenate([before, centres, after])
    return np.asarray(sum(padded[k : k + len(centres)] for k in range(2 * SMOOTHED + 1)) / (2 * SMOOTHED + 1))
