"""Dataclasses that hold arrays, compared by value."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np


class ByValue:
    """Compares a dataclass with `eq=False` field by field, arrays element by element.

    Python's own comparison of dataclasses raises where a field is an array, and their hash where one is a
    dictionary. NaN equals NaN here.
    """

    def __eq__(self, other: object) -> bool:
        """Whether the other is of the same class and has the same values."""
        if other.__class__ is not self.__class__:
            return NotImplemented
        return all(_same(getattr(self, name), getattr(other, name)) for name in _names(self))

    def __hash__(self) -> int:
        """Return a number that equal values share; of arrays it knows the shape, of mappings the keys."""
        return hash((self.__class__, *(_sketch(getattr(self, name)) for name in _names(self))))


def _names(value: Any) -> list[str]:
    """Return the fields of a dataclass that count."""
    return [field.name for field in fields(value) if field.compare]


def _same(one: Any, other: Any) -> bool:
    """Whether two values are equal, arrays in them by their elements."""
    if one is other:
        return True
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        if np.shape(one) != np.shape(other):
            return False
        unequal = np.asarray(one) != np.asarray(other)
        return not np.any(unequal & ((one == one) | (other == other)))
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_same(one[key], other[key]) for key in one)
    if isinstance(one, list | tuple) and type(one) is type(other):
        return len(one) == len(other) and all(map(_same, one, other))
    return bool(one == other)


def _sketch(value: Any) -> object:
    """Return something to hash that equal values share."""
    if isinstance(value, np.ndarray):
        return value.shape
    if isinstance(value, Mapping):
        return frozenset(value)
    if isinstance(value, list | tuple):
        return tuple(map(_sketch, value))
    try:
        hash(value)
    except TypeError:
        return type(value).__name__
    return value
