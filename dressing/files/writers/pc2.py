"""PC2 point caches: vertices over time, as Blender and other programs play them."""

import os
import struct
from pathlib import Path

import numpy as np

from toile.geometry.arrays import Float

HEADER = struct.Struct("<12siiffi")


class PointCache:
    """A PC2 file that grows frame by frame; the header counts only frames that are whole."""

    def __init__(self, path: Path, points: int, first_frame: int) -> None:
        self.path = path
        self._points, self._first, self._frames = points, first_frame, 0
        self._write_header("wb")

    def add(self, points: Float) -> None:
        """Append a frame, shape (n, 3)."""
        with open(self.path, "ab") as file:
            file.write(np.ascontiguousarray(points, "<f4").tobytes())
            file.flush()
            os.fsync(file.fileno())
        self._frames += 1
        self._write_header("r+b")

    def _write_header(self, mode: str) -> None:
        with open(self.path, mode) as file:
            file.write(HEADER.pack(b"POINTCACHE2", 1, self._points, float(self._first), 1.0, self._frames))
