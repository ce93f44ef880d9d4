"""Rigid trims: buttons, rivets and buckles, shells of their own in a garment file, ride along with it."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from toile.dressing.files.corner_surface import Surface
from toile.geometry.arrays import Float, Int
from toile.geometry.by_value import ByValue
from toile.geometry.connected import connected_vertices
from toile.geometry.topology import triangle_topology

LARGEST = 0.08
"""Largest diagonal of the box of a trim [m]: a belt buckle."""
LARGEST_OPEN = 0.03
"""The same of a shell with a border [m]: a flat button; larger ones may be cloth."""
SMALLER = 0.2
"""A trim is at most this large, in the diagonal of the piece it sits on."""
REACH = 0.02
"""A trim is at most this far from that piece [m]."""
FEWEST = 4
"""Faces of a trim at least: a loose triangle is cloth."""
SMALLEST_PATCH = 0.01
"""Least radius of the cloth that a trim follows [m]: a sewn button turns with its surroundings."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Trims(ByValue):
    """Rigid pieces on a garment.

    Attributes
    ----------
    positions
        Vertices where the garment starts [m], shape (k, 3).
    faces
        Triangles into positions, shape (t, 3).
    panel
        Panel of every face, counted in the garment's panel names, shape (t,).
    piece
        Which trim a vertex belongs to, shape (k,).
    seat
        Place of the garment that each trim sits on [m], shape (p, 3).
    """

    positions: Float
    faces: Int
    panel: Int
    piece: Int
    seat: Float

    def carried(self, start: Float, positions: Float) -> Float:
        """Return where the vertices are, shape (k, 3) [m], once the garment has moved.

        `start` and `positions` are where its material vertices started and where they are, shape (m, 3) [m].
        Every trim moves as the cloth around its seat does on average, as a rigid body (Kabsch 1976).
        """
        moved = np.empty_like(self.positions)
        for number, seat in enumerate(self.seat):
            own = self.piece == number
            size = max(SMALLEST_PATCH, 0.5 * float(np.linalg.norm(np.ptp(self.positions[own], axis=0))))
            distance = np.linalg.norm(start - seat, axis=1)
            # Coarse cloth has few vertices around: the nearest three define a place in any case.
            reach = max(size, float(np.partition(distance, 2)[2]))
            weight = np.exp(-((distance / reach) ** 2)) * (distance < 3.0 * reach)
            weight /= weight.sum()
            middle, centre = weight @ start, weight @ positions
            spread = ((start - middle) * weight[:, None]).T @ (positions - centre)
            moved[own] = (self.positions[own] - middle) @ _rotation(spread) + centre
        return moved


def _rotation(spread: Float) -> Float:
    """Return the rotation, shape (3, 3), that turns rows so that they correlate best as `spread` says."""
    u, _, v = np.linalg.svd(spread)
    flip = np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ v))])
    return np.asarray(u @ flip @ v)


def without_trims(surface: Surface) -> tuple[Surface, Trims | None, tuple[str, ...]]:
    """Take small shells that sit on a larger piece off a welded surface [m]; say how many and which."""
    count = len(surface.positions)
    shell = connected_vertices(surface.faces, count)[surface.faces[:, 0]]
    shells, first, owner, faces_of = np.unique(
        shell, return_index=True, return_inverse=True, return_counts=True
    )
    if len(shells) == 1:
        return surface, None, ()
    topology = triangle_topology(surface.faces)
    lone = (topology.edge_face_count == 1)[topology.face_edges].any(axis=1)
    is_open = np.zeros(len(shells), bool)
    is_open[owner[lone]] = True
    low, high = np.full((2, len(shells), 3), np.inf)
    for k in range(3):
        np.minimum.at(low, owner, surface.positions[surface.faces[:, k]])
        np.minimum.at(high, owner, -surface.positions[surface.faces[:, k]])
    size = np.linalg.norm(-high - low, axis=1)
    small = (size <= np.where(is_open, LARGEST_OPEN, LARGEST)) & (faces_of >= FEWEST)
    if not small.any() or small.all():
        return surface, None, ()
    cloth_nodes = np.unique(surface.faces[~small[owner]])
    base = np.zeros(count, np.int64)
    base[surface.faces] = owner[:, None]
    ends = surface.positions[np.stack([surface.faces, np.roll(surface.faces, -1, axis=1)])]
    spacing = float(np.median(np.linalg.norm(ends[1] - ends[0], axis=-1)))
    tree = cKDTree(surface.positions[cloth_nodes])
    pieces, seats = [], []
    for number in np.flatnonzero(small).tolist():
        own = np.unique(surface.faces[owner == number])
        distance, nearest = map(np.asarray, tree.query(surface.positions[own]))
        at = cloth_nodes[nearest[distance.argmin()]]
        if distance.min() <= REACH + spacing and size[number] <= SMALLER * size[base[at]]:
            pieces.append(number)
            seats.append(surface.positions[own].mean(axis=0))
    if not pieces:
        return surface, None, ()
    chosen = np.isin(owner, pieces)
    nodes, local = np.unique(surface.faces[chosen], return_inverse=True)
    faces = local.reshape(-1, 3).astype(np.int32)
    piece = np.empty(len(nodes), np.int32)
    piece[faces] = np.searchsorted(pieces, owner[chosen])[:, None]
    trims = Trims(
        positions=surface.positions[nodes], faces=faces, panel=surface.panel[chosen], piece=piece,
        seat=np.array(seats),
    )  # fmt: skip
    numbers = surface.file_face[first[pieces]].tolist()
    listed = ", ".join(map(str, numbers[:5])) + (", ..." if len(numbers) > 5 else "")
    what = "a small shell rides" if len(pieces) == 1 else f"{len(pieces)} small shells ride"
    return (
        surface.with_faces(~chosen),
        trims,
        (f"{what} along as rigid trims, such as buttons (first faces: {listed})",),
    )
