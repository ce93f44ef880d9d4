"""Rasterizer: the nearest face at each pixel."""

import math

import numpy as np
import numpy.typing as npt
from numba import types

from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_2, I32_2, OUT_I32_2, kernel

Image = npt.NDArray[np.float32]
OUT_F32_2 = types.Array(types.float32, 2, "C")


@kernel(types.void(F64_2, I32_2, OUT_F32_2, OUT_I32_2))
def rasterize_into(screen, faces, nearness, face_at):  # type: ignore[no-untyped-def]
    """Draw triangles into a depth buffer; see `rasterize`."""
    height, width = nearness.shape
    for face in range(len(faces)):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        ax, ay, az = screen[a, 0], screen[a, 1], screen[a, 2]
        bx, by, bz = screen[b, 0], screen[b, 1], screen[b, 2]
        cx, cy, cz = screen[c, 0], screen[c, 1], screen[c, 2]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area == 0.0 or not math.isfinite(area):
            continue
        left = int(max(0.0, math.ceil(min(ax, bx, cx))))
        right = int(min(width - 1.0, math.floor(max(ax, bx, cx))))
        top = int(max(0.0, math.ceil(min(ay, by, cy))))
        bottom = int(min(height - 1.0, math.floor(max(ay, by, cy))))
        for row in range(top, bottom + 1):
            for column in range(left, right + 1):
                wa = ((bx - column) * (cy - row) - (by - row) * (cx - column)) / area
                wb = ((cx - column) * (ay - row) - (cy - row) * (ax - column)) / area
                wc = 1.0 - wa - wb
                if wa < 0.0 or wb < 0.0 or wc < 0.0:
                    continue
                near = wa * az + wb * bz + wc * cz
                if near > nearness[row, column]:
                    nearness[row, column] = near
                    face_at[row, column] = face


def rasterize(screen: Float, faces: Int, width: int, height: int, *, far: float) -> tuple[Image, Int]:
    """Draw triangles from scratch.

    Parameters
    ----------
    screen
        Pixel column, pixel row and nearness of every vertex, shape (n, 3). Nearness must be linear on the
        screen (1 / depth in perspective) and grow towards the eye.
    faces
        Triangles, shape (t, 3), seen from either side.
    width, height
        Size of the image in pixels.
    far
        Nearness of empty pixels; nothing below it is drawn.

    Returns
    -------
    nearness, face_at
        Nearness of the face shown and its number, -1 where empty, shape (height, width).
    """
    nearness = np.full((height, width), far, dtype=np.float32)
    face_at = np.full((height, width), -1, dtype=np.int32)
    rasterize_into(
        np.ascontiguousarray(screen, dtype=np.float64),
        np.ascontiguousarray(faces, dtype=np.int32),
        nearness,
        face_at,
    )
    return nearness, face_at
