"""Faults of exported surfaces that can be mended without a doubt: doubled faces, gaps, faces without area."""

from collections import defaultdict
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from toile.dressing.files.corner_surface import Surface
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import first_connected
from toile.geometry.normals import area_normals
from toile.geometry.topology import triangle_topology

AnyInt = npt.NDArray[np.integer]
SMALLEST_AREA = 1e-11
"""Faces below this area [m^2] count as degenerate: (3 micrometres)^2 is no cloth."""
SMALLEST_HEIGHT = 1e-5
"""Smallest height of a triangle over its longest edge, relative to that edge: thinner is degenerate."""
WELD_WITHIN = 1e-4
"""Borders this close belong together [m]: a tenth of what cloth keeps from cloth."""
WELD_SHARE = 0.2
"""The same in the shortest edge at a vertex at most, so that no triangle collapses."""
NEEDLE = 0.01
"""A face without area whose shortest side is below this share of its longest is a needle, else a cap."""
ROUNDS = 50
"""Rounds of mending at most: each mends faces that do not touch each other."""


Birth = tuple[int, int, float]
"""A texture corner between two earlier ones, and how far from the first towards the second it lies."""


class Mended(NamedTuple):
    """A mended surface [m], sentences on what was done, and corners born between others, after the file's."""

    surface: Surface
    notes: tuple[str, ...]
    births: list[Birth]


def mended_surface(surface: Surface) -> Mended:
    """Return a surface [m] without doubled faces and faces without area, its borders joined; say so.

    A face counts as doubled if another one has the same vertices, or the same places in the other direction.
    Vertices inside a layer are left alone, so that two layers that touch do not grow together.
    """
    surface, doubled = _without_doubles(surface, by_place=True)
    faces = exactly_welded(surface.positions, surface.faces)
    faces, joined, widest = _nearly_welded(surface.positions, faces)
    surface, again = _without_doubles(replace(surface, faces=faces), by_place=False)
    surface, flat, births = _with_area(surface)
    doubled = np.concatenate([doubled, again])
    notes = []
    if len(doubled):
        notes.append(f"{named(doubled)} left out: other faces lie there")
    if joined:
        notes.append(f"{joined} vertices on borders that lie up to {1e6 * widest:.0f} um apart are joined")
    if len(flat):
        notes.append(f"{named(flat)} mended: no area")
    return Mended(surface, tuple(notes), births)


def exactly_welded(positions: Float, faces: Int) -> Int:
    """Return faces in which border vertices at the same place are one: exporters split them at seams."""
    target = np.arange(len(positions), dtype=np.int32)
    border = _border(faces)
    if len(border):
        _, first, index = np.unique(positions[border], axis=0, return_index=True, return_inverse=True)
        target[border] = border[first][index.ravel()]
    return np.asarray(target[faces])


def without_area(positions: Float, faces: Int) -> Bool:
    """Mark faces that repeat a vertex or have no area, shape (t,)."""
    corners = positions[faces]
    doubled = np.linalg.norm(area_normals(corners), axis=1)
    longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    return np.asarray((doubled < 2.0 * SMALLEST_AREA) | (doubled < SMALLEST_HEIGHT * longest**2))


def named(faces: Int, one: str = "is", many: str = "are") -> str:
    """Return "face 3 is" or "7 faces (3, 5, 9, ...) are", numbered from 0, or other words than is and are."""
    numbers = sorted({int(face) for face in faces})
    if len(numbers) == 1:
        return f"face {numbers[0]} {one}"
    listed = ", ".join(str(number) for number in numbers[:5]) + (", ..." if len(numbers) > 5 else "")
    return f"{len(numbers)} faces ({listed}) {many}"


def _border(faces: Int) -> Int:
    """Vertices of edges with one face, sorted."""
    return np.unique(triangle_topology(faces).border_edges)


def _without_doubles(surface: Surface, by_place: bool) -> tuple[Surface, Int]:
    """Leave out polygons that lie on earlier ones; return their numbers in the file as well.

    Polygons of other vertices at the same places, `by_place`, are doubles only if they face the other way:
    two layers of a garment face the same way.
    """
    faces = surface.faces
    numbers, polygon = np.unique(surface.file_face, return_inverse=True)
    corners = surface.positions[faces]
    normal = np.zeros((len(numbers), 3))
    np.add.at(normal, polygon, area_normals(corners))
    own = _corner_sets(polygon, faces)
    at = own
    if by_place:
        at = _corner_sets(
            polygon, np.unique(surface.positions, axis=0, return_inverse=True)[1].ravel()[faces]
        )
    leaders: dict[bytes, int] = {}
    doubled = np.zeros(len(numbers), bool)
    for number, key in enumerate(at):
        leader = leaders.setdefault(key, number)
        if leader != number:
            doubled[number] = own[leader] == own[number] or normal[leader] @ normal[number] < 0.0
    return surface.with_faces(~doubled[polygon]), numbers[doubled].astype(np.int32)


def _corner_sets(polygon: AnyInt, corners: AnyInt) -> list[bytes]:
    """Return the corners of every polygon as a key, from triangles of shape (t, 3) and their polygons."""
    pairs = np.unique(np.column_stack([np.repeat(polygon, 3), corners.ravel()]), axis=0)
    ends = np.flatnonzero(np.diff(pairs[:, 0])) + 1
    return [part.tobytes() for part in np.split(np.ascontiguousarray(pairs[:, 1]), ends)]


def _nearly_welded(positions: Float, faces: Int) -> tuple[Int, int, float]:
    """Join border vertices that all but touch; return the faces, how many were joined, and how wide [m]."""
    border = _border(faces)
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    length = np.linalg.norm(positions[ends[:, 0]] - positions[ends[:, 1]], axis=1)
    shortest = np.full(len(positions), np.inf)
    for side in (0, 1):
        np.minimum.at(shortest, ends[:, side], length)
    pairs = border[cKDTree(positions[border]).query_pairs(WELD_WITHIN, output_type="ndarray")]
    if not len(pairs):
        return faces, 0, 0.0
    apart = np.linalg.norm(positions[pairs[:, 0]] - positions[pairs[:, 1]], axis=1)
    near = apart < WELD_SHARE * shortest[pairs].min(axis=1)
    if not near.any():
        return faces, 0, 0.0
    pairs, count = pairs[near], len(positions)
    target = first_connected(pairs, count)
    return target[faces], int(np.count_nonzero(target != np.arange(count))), float(apart[near].max())


def _with_area(surface: Surface) -> tuple[Surface, Int, list[Birth]]:
    """Mend faces without area; return the numbers of those in the file, and corners born, as well.

    The short side of a needle becomes one vertex. The long side of a cap, whose third vertex lies on it, is
    turned: the face behind it is split at that vertex.
    """
    mended: list[Int] = []
    births: list[Birth] = []
    for _ in range(ROUNDS):
        bad = np.flatnonzero(without_area(surface.positions, surface.faces)).astype(np.int32)
        if not len(bad):
            break
        mended.append(surface.file_face[bad])
        surface, born = _mend_round(surface, bad)
        births += born
    return surface, np.unique(np.concatenate(mended)) if mended else np.empty(0, np.int32), births


def _mend_round(surface: Surface, bad: Int) -> tuple[Surface, list[Birth]]:
    """Mend faces that do not touch each other; those left over have their turn in the next round."""
    births: list[Birth] = []
    faces, uv_faces, panel = surface.faces.copy(), surface.uv_faces.copy(), surface.panel.copy()
    keep, busy = np.ones(len(faces), bool), np.zeros(len(surface.positions), bool)
    target = np.arange(len(surface.positions), dtype=np.int32)
    uv = [surface.uv]
    count = len(surface.uv)
    beside: dict[tuple[int, int], list[int]] = defaultdict(list)
    for face, corners in enumerate(faces.tolist()):
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            beside[min(a, b), max(a, b)].append(face)
    for face in bad.tolist():
        corners = faces[face]
        if busy[corners].any():
            continue
        sides = np.linalg.norm(surface.positions[corners] - surface.positions[np.roll(corners, -1)], axis=1)
        shortest, longest = int(sides.argmin()), int(sides.argmax())
        if sides[shortest] <= NEEDLE * sides[longest]:
            a, b = sorted((int(corners[shortest]), int(corners[(shortest + 1) % 3])))
            around = [other for pair in beside if a in pair or b in pair for other in beside[pair]]
            busy[faces[around]] = True
            target[b] = a
            continue
        a, b, c = (int(corners[(longest + k) % 3]) for k in range(3))
        behind = [other for other in beside[min(a, b), max(a, b)] if other != face]
        if len(behind) != 1 or c in faces[behind[0]]:
            keep[face] = False
            busy[corners] = True
            continue
        other = behind[0]
        if busy[faces[other]].any():
            continue
        busy[faces[other]] = busy[corners] = True
        turn = next(k for k in range(3) if faces[other][(k + 2) % 3] not in (a, b))
        p, q, d = np.roll(faces[other], -turn).tolist()
        up, uq, ud = np.roll(uv_faces[other], -turn).tolist()
        uc = -1
        if min(up, uq) >= 0:
            reach = surface.positions[q] - surface.positions[p]
            share = float((surface.positions[c] - surface.positions[p]) @ reach / (reach @ reach))
            births.append((up, uq, share))
            uv.append((1.0 - share) * surface.uv[[up]] + share * surface.uv[[uq]])
            uc, count = count, count + 1
        faces[other], faces[face] = (p, c, d), (c, q, d)
        uv_faces[other], uv_faces[face] = (up, uc, ud), (uc, uq, ud)
        panel[face] = panel[other]
    faces = target[faces]
    keep &= (faces != np.roll(faces, -1, axis=1)).all(axis=1)
    mended = replace(surface, faces=faces, uv_faces=uv_faces, panel=panel, uv=np.concatenate(uv))
    return mended.with_faces(keep), births
