"""Vertices over time in an .npz file, written frame by frame: a film may be larger than memory."""

from pathlib import Path
from typing import Any
from zipfile import ZIP_STORED, ZipFile

import numpy as np

from toile.geometry.arrays import Float


class MotionWriter:
    """An .npz with an array `name` of shape (frames, vertices, 3) that grows; others come last."""

    def __init__(self, path: Path, name: str, frames: int, vertices: int) -> None:
        self._zip = ZipFile(path, "w", ZIP_STORED)
        self._stream = self._zip.open(f"{name}.npy", "w", force_zip64=True)
        header = {"descr": "<f4", "fortran_order": False, "shape": (frames, vertices, 3)}
        np.lib.format.write_array_header_1_0(self._stream, header)

    def add(self, vertices: Float) -> None:
        """Append a frame, shape (v, 3)."""
        self._stream.write(np.ascontiguousarray(vertices, "<f4").tobytes())

    def close(self, **arrays: Any) -> None:
        """Complete the file with other arrays."""
        self._stream.close()
        for name, array in arrays.items():
            with self._zip.open(f"{name}.npy", "w") as stream:
                np.lib.format.write_array(stream, np.asarray(array))
        self._zip.close()
