"""Garments exported with thickness: their two walls are one layer of cloth."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from toile.dressing.files.corner_surface import Surface
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import connected
from toile.geometry.normals import area_normals
from toile.geometry.topology import triangle_topology

THINNEST, THICKEST = 5e-5, 2e-3
"""Distance of two walls that are one layer of cloth [m]."""
OPPOSED = -0.5
"""Largest dot product of the normals of faces that are opposite."""
CANDIDATES = 24
"""Nearest faces among which the opposite one is sought."""
COVERED = 0.9
"""Share of a piece's area that must have an opposite wall."""
EVEN = 1.6
"""Nine tenths of the distances lie within this factor of their median."""
APART = 2e-3
"""How far apart two walls start that are two layers [m]: twice what cloth keeps from cloth."""
SHARP = 0.0
"""Dot product of the normals of neighbours below which walls meet at a rim."""


@dataclass(frozen=True)
class _Walls:
    """Which face lies opposite to each, -1: none, and how far away [m]; shapes (t,)."""

    opposite: Int
    distance: Float


def as_layers(surface: Surface, walls: int) -> tuple[Surface, float | None, tuple[str, ...]]:
    """Return a welded surface [m] whose pieces with two walls are `walls` layers, 1 or 2; say so.

    Of one layer the larger wall stays, and its thickness, the distance of the walls [m], is returned; else
    None. Of two layers the larger wall moves outwards so far that cloth has room. Rims are left out.
    """
    corners = surface.positions[surface.faces]
    normal = area_normals(corners)
    area = 0.5 * np.linalg.norm(normal, axis=1)
    normal /= 2.0 * area[:, None]
    neighbours = triangle_topology(surface.faces).neighbour_pairs
    drop, found, positions = np.zeros(len(area), bool), [], surface.positions.copy()
    for side in (-1.0, 1.0):
        walls_here = _opposite(corners, normal, side)
        hit = walls_here.opposite >= 0
        for own, distance in _double(walls_here, neighbours, area, drop):
            larger = _larger_walls(own & hit, neighbours, normal, area, walls_here.opposite)
            if not 0.3 < area[own & ~larger].sum() / area[own].sum() < 0.7:
                continue
            found.append(distance)
            drop |= own & ~(larger if walls == 1 else hit)
            if walls == 2:
                nodes, outwards = _vertex_normals(
                    surface.faces[larger], -side * normal[larger], len(positions)
                )
                positions[nodes] += max(0.0, APART - distance) * outwards
    if not found:
        return surface, None, ()
    kept = replace(surface.with_faces(~drop), positions=positions)
    thickness = float(np.median(found))
    said = f"it has two walls {1e3 * thickness:.2g} mm apart"
    if walls == 2:
        return kept, None, (f"{said}: worn as two layers, {1e3 * APART:g} mm apart at the start",)
    return kept, thickness, (f"{said}: worn as one layer of that thickness (walls = 2 wears both)",)


def _double(walls: _Walls, neighbours: Int, area: Float, taken: Bool) -> Iterator[tuple[Bool, float]]:
    """Yield the faces of every piece that has two walls, and how far these are apart [m]."""
    hit = walls.opposite >= 0
    pairs = np.concatenate([neighbours, np.column_stack([np.flatnonzero(hit), walls.opposite[hit]])])
    piece = connected(pairs, len(area))
    covered = np.bincount(piece, area * hit) / np.bincount(piece, area)
    for number in np.flatnonzero(covered >= COVERED).tolist():
        own = piece == number
        distances = walls.distance[own & hit]
        middle = float(np.median(distances))
        even = np.mean((distances < middle * EVEN) & (distances > middle / EVEN)) >= COVERED
        if even and not taken[own].any():
            yield own, middle


def _vertex_normals(faces: Int, normal: Float, count: int) -> tuple[Int, Float]:
    """Return the vertices of faces and their unit normals, shapes (k,) and (k, 3)."""
    sums = np.zeros((count, 3))
    for k in range(3):
        np.add.at(sums, faces[:, k], normal)
    nodes = np.unique(faces)
    return nodes, sums[nodes] / np.maximum(np.linalg.norm(sums[nodes], axis=1, keepdims=True), 1e-12)


def _opposite(corners: Float, normal: Float, side: float) -> _Walls:
    """Find the face that a ray meets from the middle of every face, along its normal times `side`."""
    middle = corners.mean(axis=1)
    near = np.asarray(cKDTree(middle).query(middle, k=min(CANDIDATES, len(middle)))[1])
    best, found = np.full(len(middle), np.inf), np.full(len(middle), -1, np.int64)
    for column in near.T[1:]:
        towards = np.einsum("ti,ti->t", normal, normal[column])
        along = side * normal
        slope = np.einsum("ti,ti->t", along, normal[column])
        facing = (towards < OPPOSED) & (slope != 0.0)
        height = np.einsum("ti,ti->t", corners[column, 0] - middle, normal[column])
        distance = np.where(facing, height / np.where(facing, slope, 1.0), np.inf)
        hit = facing & (distance > THINNEST) & (distance < THICKEST) & (distance < best)
        point = middle + np.where(hit, distance, 0.0)[:, None] * along
        hit &= _within(point, corners[column], normal[column])
        best[hit], found[hit] = distance[hit], column[hit]
    return _Walls(found.astype(np.int32), best)


def _within(point: Float, corners: Float, normal: Float) -> Bool:
    """Whether points in the planes of triangles lie in them, a little slack included."""
    inside = np.ones(len(point), bool)
    scale = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    for k in range(3):
        side = corners[:, (k + 1) % 3] - corners[:, k]
        turn = np.einsum("ti,ti->t", np.cross(side, point - corners[:, k]), normal)
        inside &= turn >= -0.05 * scale * np.linalg.norm(side, axis=1)
    return inside


def _larger_walls(walls: Bool, neighbours: Int, normal: Float, area: Float, opposite: Int) -> Bool:
    """Mark the faces of the larger of two opposite walls, among those marked in `walls`."""
    smooth = np.einsum("ei,ei->e", normal[neighbours[:, 0]], normal[neighbours[:, 1]]) > SHARP
    inner = walls[neighbours].all(axis=1) & smooth
    wall = connected(neighbours[inner], len(walls))
    size = np.bincount(wall, area * walls)
    keep, gone = np.zeros(len(walls), bool), np.zeros(len(size), bool)
    for number in sorted(np.unique(wall[walls]).tolist(), key=lambda each: (-size[each], each)):
        if gone[number]:
            continue
        own = walls & (wall == number)
        keep |= own
        # Its own opposite faces go, most of whose wall lies opposite.
        partner, times = np.unique(wall[opposite[own]], return_counts=True)
        gone[partner[(partner != number) & (times >= 0.1 * times.max())]] = True
    return keep
