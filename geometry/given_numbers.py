"""Numbers that users give: of any real type, finite, within limits."""

import math
from numbers import Integral, Real

import numpy as np

from toile.geometry.errors import InputError


def is_real(value: object) -> bool:
    """Whether a value is a finite real number of any type; True and False are none."""
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # a whole number beyond 1e308
        return False


def is_whole(value: object) -> bool:
    """Whether a value is a whole number of any type; True and False are none."""
    return isinstance(value, Integral) and not isinstance(value, bool)


def real(
    value: object, name: str, low: float, high: float, unit: str = "", *, field: str | None = None
) -> float:
    """Return a number within [low, high] as a float.

    Raises InputError naming it `name`, with its unit, if it is none; `field` is its field if not `name`.
    """
    return float(_within(value, is_real(value), "a number", name, low, high, unit, field or name))


def whole(value: object, name: str, low: float, high: float, *, field: str | None = None) -> int:
    """Return a whole number within [low, high] as an int. Raises InputError if it is none."""
    return int(_within(value, is_whole(value), "a whole number", name, low, high, "", field or name))


def truth(value: object, name: str) -> bool:
    """Return True or False, of Python or numpy. Raises InputError if a value is neither."""
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{name} must be True or False, got {shown(value)}", field=name)
    return bool(value)


def shown(value: object) -> str:
    """Return a value as messages show it: numbers plain, long ones shortened."""
    try:
        text = f"{float(value):g}" if is_real(value) and not is_whole(value) else repr(value)  # type: ignore[arg-type]
    except ValueError:  # Python spells no whole number of more than 4,300 digits
        return "a whole number of thousands of digits"
    return text if len(text) <= 80 else f"{text[:60]}... ({type(value).__name__})"


def _within(
    value: object, fits: bool, kind: str, name: str, low: float, high: float, unit: str, field: str
) -> float:
    """Return a number if it is of its kind and within its limits."""
    if not fits:
        raise InputError(f"{name} must be {kind}, got {shown(value)}", field=field)
    number: float = value  # type: ignore[assignment]
    if not low <= number <= high:
        between = f"{low:g} and {high:g} {unit}".rstrip()
        raise InputError(f"{name} must lie between {between}, got {shown(value)}", field=field)
    return number
