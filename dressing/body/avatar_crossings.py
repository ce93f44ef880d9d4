"""Places where a surface crosses itself."""

import numpy as np
import numpy.typing as npt

from toile.geometry.arrays import Bool, Float, Int

LARGE_FACE = 4.0
"""Faces larger than this many cells are compared with all others instead of being hashed."""


def crossing_pairs(vertices: Float, faces: Int) -> Int:
    """Pairs of faces without a common vertex that cross, shape (p, 2), first < second, sorted.

    An edge of one passes through the other; faces that only touch in one plane do not count.
    """
    pairs = _near_pairs(vertices, faces)
    if not len(pairs):
        return pairs
    crosses = np.zeros(len(pairs), dtype=np.bool_)
    for edge_side, face_side in ((0, 1), (1, 0)):
        corners = vertices[faces[pairs[:, face_side]]]
        ends = vertices[faces[pairs[:, edge_side]]]
        for k in range(3):
            crosses |= _segment_crosses_triangle(ends[:, k], ends[:, (k + 1) % 3], corners)
    return np.ascontiguousarray(pairs[crosses])


def describe_places(points: Float, limit: int = 4, radius: float = 0.05) -> str:
    """Centres [m] of the clusters that points form, largest first: "(0.12, 1.30, -0.01) m (12x)"."""
    remaining = points
    places: list[tuple[int, str]] = []
    while len(remaining):
        centre = remaining[0]
        for _ in range(3):
            near = np.linalg.norm(remaining - centre, axis=1) < 2.0 * radius
            if not near.any():
                near[0] = True
            centre = remaining[near].mean(axis=0)
        x, y, z = (centre + 0.0).round(2).tolist()
        places.append((int(np.count_nonzero(near)), f"({x:.2f}, {y:.2f}, {z:.2f}) m"))
        remaining = remaining[~near]
        if len(places) > 200:
            break
    places.sort(key=lambda place: -place[0])
    text = ", ".join(label for _, label in places[:limit])
    rest = len(places) - limit
    return text + (f" and {rest} more places" if rest > 0 else "")


def _near_pairs(vertices: Float, faces: Int) -> Int:
    """Pairs of faces whose boxes overlap and that share no vertex, shape (p, 2), sorted."""
    corners = vertices[faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    extent = (high - low).max(axis=1)
    cell = max(2.0 * float(np.median(extent)), 1e-9)
    large = np.flatnonzero(extent > LARGE_FACE * cell)
    small = np.flatnonzero(extent <= LARGE_FACE * cell)
    found = [_pairs_in_cells(low, high, small, cell)]
    for index in large:
        hits = np.flatnonzero(((low <= high[index]) & (high >= low[index])).all(axis=1))
        found.append(np.column_stack([np.minimum(hits, index), np.maximum(hits, index)]))
    pairs = np.concatenate(found)
    pairs = pairs[(low[pairs[:, 0]] <= high[pairs[:, 1]]).all(axis=1)]
    pairs = pairs[(high[pairs[:, 0]] >= low[pairs[:, 1]]).all(axis=1)]
    shared = np.zeros(len(pairs), dtype=np.bool_)
    for i in range(3):
        for k in range(3):
            shared |= faces[pairs[:, 0], i] == faces[pairs[:, 1], k]
    pairs = pairs[~shared]
    key = np.unique(pairs[:, 0].astype(np.int64) * len(faces) + pairs[:, 1])
    return np.column_stack([key // len(faces), key % len(faces)]).astype(np.int32)


def _pairs_in_cells(
    low: Float, high: Float, members: npt.NDArray[np.int64], cell: float
) -> npt.NDArray[np.int64]:
    """Pairs of members that enter a common cell of a uniform grid, shape (p, 2), first < second."""
    origin = low.min(axis=0)
    first = np.floor((low[members] - origin) / cell).astype(np.int64)
    last = np.floor((high[members] - origin) / cell).astype(np.int64)
    size = last.max(axis=0, initial=0) + 1 if len(members) else np.ones(3, dtype=np.int64)
    reach = (last - first + 1).max(axis=0, initial=1)
    cells: list[npt.NDArray[np.int64]] = []
    owners: list[npt.NDArray[np.int64]] = []
    for dx in range(reach[0]):
        for dy in range(reach[1]):
            for dz in range(reach[2]):
                at = first + np.array([dx, dy, dz])
                inside = (at <= last).all(axis=1)
                x, y, z = at[inside].T
                cells.append((x * size[1] + y) * size[2] + z)
                owners.append(members[inside])
    cell_of, owner = np.concatenate(cells), np.concatenate(owners)
    order = np.argsort(cell_of, kind="stable")
    cell_of, owner = cell_of[order], owner[order]
    found: list[npt.NDArray[np.int64]] = []
    # Faces of one cell are neighbours in the sorted list: compare at growing distance until none is left.
    for step in range(1, len(cell_of)):
        together = np.flatnonzero(cell_of[:-step] == cell_of[step:])
        if not len(together):
            break
        a, b = owner[together], owner[together + step]
        overlap = ((low[a] <= high[b]) & (high[a] >= low[b])).all(axis=1)
        a, b = a[overlap], b[overlap]
        found.append(np.column_stack([np.minimum(a, b), np.maximum(a, b)]))
    return np.concatenate(found) if found else np.empty((0, 2), dtype=np.int64)


def _segment_crosses_triangle(start: Float, end: Float, corners: Float) -> Bool:
    """Whether segments (n, 3) pass through triangles (n, 3, 3): signs of five tetrahedron volumes."""
    a, b, c = corners[:, 0] - start, corners[:, 1] - start, corners[:, 2] - start
    along = end - start
    ab, bc, ca = (np.einsum("ij,ij->i", along, np.cross(p, q)) for p, q in ((a, b), (b, c), (c, a)))
    # Through an edge or corner counts: bodies are symmetric, and cross themselves just there.
    within = ((ab >= 0) & (bc >= 0) & (ca >= 0)) | ((ab <= 0) & (bc <= 0) & (ca <= 0))
    normal = np.cross(b - a, c - a)
    side_start = -np.einsum("ij,ij->i", a, normal)
    side_end = side_start + np.einsum("ij,ij->i", along, normal)
    crosses: Bool = within & (side_start * side_end < 0)
    return crosses
