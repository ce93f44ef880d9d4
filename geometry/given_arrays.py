"""Arrays that users give: of any numeric type and layout, checked, as kernels take them."""

from typing import Any

import numpy as np
import numpy.typing as npt

from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError


def floats(value: object, what: str, shape: tuple[int | None, ...], field: str) -> Float:
    """Return finite numbers as contiguous float64; None in `shape` is any length.

    Raises InputError that begins with `what`.
    """
    array = _of_shape(value, what, shape, field, "fiu")
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        row = int(np.flatnonzero(~np.isfinite(array).reshape(len(array), -1).all(axis=1))[0])
        raise InputError(f"{what} have NaN or infinite values (first: row {row}); clean them", field=field)
    return np.ascontiguousarray(array, np.float64)


def indices(value: object, what: str, shape: tuple[int | None, ...], count: int, field: str) -> Int:
    """Return numbers of things, of which there are `count`, as contiguous int32; raises as `floats` does."""
    array = _of_shape(value, what, shape, field, "iu")
    if array.size and not (0 <= int(array.min()) and int(array.max()) < count):
        wrong = ((array < 0) | (array >= count)).reshape(len(array), -1).any(axis=1)
        row = int(np.flatnonzero(wrong)[0])
        raise InputError(
            f"{what} name what does not exist: row {row} is {array[row].tolist()}, of 0..{count - 1}",
            np.flatnonzero(wrong).tolist() if shape[1:] == (3,) else (),
            field=field,
        )
    return np.ascontiguousarray(array, np.int32)


def _of_shape(
    value: object, what: str, shape: tuple[int | None, ...], field: str, kinds: str
) -> npt.NDArray[Any]:
    """Return a value as an array of that shape and of numbers of these kinds."""
    try:
        array = np.asarray(value)
    except ValueError:
        array = np.empty(0, object)
    if not array.size and array.dtype.kind == "f" and len(shape) == array.ndim:
        array = array.astype(np.float64 if "f" in kinds else np.int32)
    fits = array.ndim == len(shape) and all(
        want is None or want == have for want, have in zip(shape, array.shape, strict=True)
    )
    if not fits or array.dtype.kind not in kinds:
        wanted = ", ".join("n" if length is None else str(length) for length in shape)
        kind = "whole numbers" if "f" not in kinds else "numbers"
        raise InputError(
            f"{what} must be {kind} of shape ({wanted}{',' if len(shape) == 1 else ''}), got "
            f"{array.dtype} of shape {array.shape}",
            field=field,
        )
    return array
