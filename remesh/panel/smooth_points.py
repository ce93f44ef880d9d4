"""Smoothing of a flat triangulation: inner points move to the size-weighted centroid of their triangles."""

import numpy as np
from numba import types

from toile.geometry.arrays import Int
from toile.geometry.kernel import F64_1, I32_1, I32_2, OUT_F64_2, helper, kernel
from toile.remesh.panel.plane import after, before, quality, turn


def stars(corners: Int, vertex_count: int) -> tuple[Int, Int]:
    """Triangles around each vertex, as offsets and one flat list.

    Those of vertex v are triangles[offsets[v] : offsets[v + 1]].
    """
    flat = corners.ravel()
    order = np.argsort(flat, kind="stable")
    offsets = np.concatenate([[0], np.cumsum(np.bincount(flat, minlength=vertex_count))])
    return offsets.astype(np.int32), (order // 3).astype(np.int32)


@helper
def worst_quality_at(points, corners, offsets, around, v, px, py):  # type: ignore[no-untyped-def]
    """Smallest quality of the triangles around v, were it at p."""
    worst = 1.0
    for i in range(offsets[v], offsets[v + 1]):
        t = around[i]
        k = 0
        while corners[t, k] != v:
            k += 1
        b, c = corners[t, after(k)], corners[t, before(k)]
        worst = min(worst, quality(px, py, points[b, 0], points[b, 1], points[c, 0], points[c, 1]))
    return worst


@kernel(types.float64(OUT_F64_2, I32_2, F64_1, I32_1, I32_1, types.int64, types.int64, types.float64))
def smooth_points(points, corners, size, offsets, around, first, passes, enough):  # type: ignore[no-untyped-def]
    """Smooth vertices `first` and later in place, in order (Gauss-Seidel); returns the longest move [m].

    A move is taken if it leaves every triangle around with quality `enough`, or better than before the move.
    """
    longest = 0.0
    for _ in range(passes):
        longest = 0.0
        for v in range(first, len(points)):
            total, sx, sy = 0.0, 0.0, 0.0
            for i in range(offsets[v], offsets[v + 1]):
                a, b, c = corners[around[i], 0], corners[around[i], 1], corners[around[i], 2]
                ax, ay = points[a, 0], points[a, 1]
                bx, by = points[b, 0], points[b, 1]
                cx, cy = points[c, 0], points[c, 1]
                wanted = size[a] + size[b] + size[c]
                weight = abs(turn(ax, ay, bx, by, cx, cy)) / (wanted * wanted * wanted)
                total += weight
                sx += weight * (ax + bx + cx) / 3.0
                sy += weight * (ay + by + cy) / 3.0
            if total <= 0.0:
                continue
            old_x, old_y = points[v, 0], points[v, 1]
            dx, dy = sx / total - old_x, sy / total - old_y
            before = worst_quality_at(points, corners, offsets, around, v, old_x, old_y)
            for _halving in range(3):
                after = worst_quality_at(points, corners, offsets, around, v, old_x + dx, old_y + dy)
                if after > before or after >= enough:
                    points[v, 0], points[v, 1] = old_x + dx, old_y + dy
                    longest = max(longest, (dx * dx + dy * dy) ** 0.5)
                    break
                dx, dy = 0.5 * dx, 0.5 * dy
    return longest


@kernel(types.int64(OUT_F64_2, I32_2, I32_1, I32_1, types.int64, types.int64, types.float64))
def lift_worst(points, corners, offsets, around, first, passes, enough):  # type: ignore[no-untyped-def]
    """Move vertices whose worst triangle is below quality `enough` by pattern search; returns the moves."""
    moves = 0
    for _ in range(passes):
        for v in range(first, len(points)):
            x, y = points[v, 0], points[v, 1]
            best = worst_quality_at(points, corners, offsets, around, v, x, y)
            if best >= enough:
                continue
            t = around[offsets[v]]
            a, b = corners[t, 0], corners[t, 1]
            step = 0.2 * ((points[a, 0] - points[b, 0]) ** 2 + (points[a, 1] - points[b, 1]) ** 2) ** 0.5
            for _halving in range(6):
                improved = True
                while improved:
                    improved = False
                    for way in range(8):
                        # Eight compass directions, without trigonometry.
                        dx = step * (1.0 if way in (0, 1, 7) else (-1.0 if way in (3, 4, 5) else 0.0))
                        dy = step * (1.0 if way in (1, 2, 3) else (-1.0 if way in (5, 6, 7) else 0.0))
                        trial = worst_quality_at(points, corners, offsets, around, v, x + dx, y + dy)
                        if trial > best + 1e-6:
                            best, x, y = trial, x + dx, y + dy
                            improved = True
                            break
                step *= 0.5
            if x != points[v, 0] or y != points[v, 1]:
                points[v, 0], points[v, 1] = x, y
                moves += 1
    return moves
