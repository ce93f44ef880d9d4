"""Validation of arrays where they enter the program."""

import numpy as np
import numpy.typing as npt

Float = npt.NDArray[np.float64]
Int = npt.NDArray[np.int32]
Bool = npt.NDArray[np.bool_]


def as_positions(values: npt.ArrayLike, name: str = "positions") -> Float:
    """Return C-contiguous float64 (n, 3). Raises ValueError naming the array, its shape or the bad rows."""
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} must have shape (n, 3), got {array.shape}")
    bad = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if len(bad):
        raise ValueError(f"{name} must be finite, but {len(bad)} rows are not (first: row {bad[0]})")
    return array


def as_faces(values: npt.ArrayLike, vertex_count: int, name: str = "faces") -> Int:
    """Return C-contiguous int32 (n, 3), indices in [0, vertex_count). Raises ValueError naming bad rows."""
    array = np.ascontiguousarray(values, dtype=np.int32)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} must have shape (n, 3), got {array.shape}")
    bad = np.flatnonzero(((array < 0) | (array >= vertex_count)).any(axis=1))
    if len(bad):
        raise ValueError(f"{name} refer to vertices outside 0..{vertex_count - 1} (first: face {bad[0]})")
    return array
