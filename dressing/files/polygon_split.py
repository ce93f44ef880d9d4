"""Splits polygons of five corners and more into triangles that cover them once, without any of no area.

A fan where one does; else ears are clipped (Meisters 1975), those nearest to equilateral first. Polygons that
are not flat are split as they appear along their mean normal (Newell's).
"""

import numpy as np

from toile.geometry.arrays import Float, Int

GOOD = 1e-3
"""Height of a triangle over its longest side above which a fan is as good as any split."""
FLAT = 1e-5
"""Below this ratio a triangle has no area."""
LARGEST_FAN = 32
"""Corners above which fans are not tried: they would be slivers."""


def split_polygons(points: Float) -> Int:
    """Return corner numbers of triangles, shape (p, n - 2, 3), of polygons, shape (p, n, 3)."""
    count, corners = points.shape[:2]
    plane = _projected(points)
    split = np.empty((count, corners - 2, 3), np.int32)
    done = np.zeros(count, np.bool_)
    if corners <= LARGEST_FAN:
        tip = np.arange(corners)[:, None]
        step = np.arange(1, corners - 1)[None, :]
        # One fan from every corner, shape (corners, n - 2, 3).
        fans = np.stack(np.broadcast_arrays(tip, (tip + step) % corners, (tip + step + 1) % corners), axis=-1)
        worst = np.stack([_thickness(plane[:, fan]).min(axis=1) for fan in fans], axis=1)
        best = worst.argmax(axis=1)
        done = worst[np.arange(count), best] > GOOD
        split[done] = fans[best[done]]
    for polygon in np.flatnonzero(~done).tolist():
        split[polygon] = _ears_clipped(plane[polygon])
    return split


def _projected(points: Float) -> Float:
    """Polygons in their mean planes, counter-clockwise, shape (p, n, 2)."""
    centred = points - points.mean(axis=1, keepdims=True)
    normal = np.cross(centred, np.roll(centred, -1, axis=1)).sum(axis=1)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.where(length > 0.0, normal / np.where(length > 0.0, length, 1.0), (0.0, 0.0, 1.0))
    helper = np.eye(3)[np.abs(normal).argmin(axis=1)]
    first = np.cross(helper, normal)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normal, first)
    return np.stack(
        [np.einsum("pni,pi->pn", centred, first), np.einsum("pni,pi->pn", centred, second)], axis=-1
    )


def _doubled(triangles: Float) -> Float:
    """Twice the signed areas of flat triangles, shape (..., 3, 2)."""
    u = triangles[..., 1, :] - triangles[..., 0, :]
    v = triangles[..., 2, :] - triangles[..., 0, :]
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def _thickness(triangles: Float) -> Float:
    """Smallest height over longest side of flat triangles, shape (..., 3, 2); negative where turned over."""
    sides = np.roll(triangles, -1, axis=-2) - triangles
    longest = (sides * sides).sum(axis=-1).max(axis=-1)
    return np.asarray(_doubled(triangles) / np.where(longest > 0.0, longest, 1.0))


def _ears_clipped(plane: Float) -> list[tuple[int, int, int]]:
    """Triangles of one polygon, shape (n, 2), counter-clockwise."""
    ring = list(range(len(plane)))
    size = float(np.ptp(plane, axis=0).max())
    thickness = {
        tip: _ear_thickness(plane, ring[k - 1], tip, ring[(k + 1) % len(ring)]) for k, tip in enumerate(ring)
    }
    ears: list[tuple[int, int, int]] = []
    while len(ring) > 3:
        ordered = sorted(range(len(ring)), key=lambda k: (-thickness[ring[k]], ring[k]))
        chosen = ordered[0]
        for k in ordered:
            if thickness[ring[k]] <= FLAT:
                break
            if _is_clear(plane, ring, k, FLAT * size):
                chosen = k
                break
        before, tip, after = ring[chosen - 1], ring[chosen], ring[(chosen + 1) % len(ring)]
        ears.append((before, tip, after))
        del ring[chosen]
        for corner in (before, after):
            k = ring.index(corner)
            thickness[corner] = _ear_thickness(plane, ring[k - 1], corner, ring[(k + 1) % len(ring)])
    ears.append((ring[0], ring[1], ring[2]))
    return ears


def _ear_thickness(plane: Float, before: int, tip: int, after: int) -> float:
    """Smallest height over longest side of one triangle."""
    return float(_thickness(plane[[before, tip, after]]))


def _is_clear(plane: Float, ring: list[int], k: int, margin: float) -> bool:
    """Whether no other corner of the ring lies in the ear at place k, or within a margin of its diagonal."""
    a, b, c = (plane[ring[(k + step) % len(ring)]] for step in (-1, 0, 1))
    others = plane[[corner for place, corner in enumerate(ring) if (place - k + 1) % len(ring) > 2]]
    # Bridges to holes come twice to the same place.
    apart = [np.abs(others - corner).max(axis=1) > 0.0 for corner in (a, b, c)]
    others = others[np.logical_and.reduce(apart)]
    sides = [
        (end[0] - start[0]) * (others[:, 1] - start[1]) - (end[1] - start[1]) * (others[:, 0] - start[0])
        for start, end in ((a, b), (b, c), (c, a))
    ]
    close = margin * max(float(np.linalg.norm(a - c)), 1e-300)
    return not ((sides[0] >= 0.0) & (sides[1] >= 0.0) & (sides[2] >= -close)).any()
