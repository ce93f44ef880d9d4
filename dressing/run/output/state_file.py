"""State of a run as a file: arrays in an .npz, everything else in a JSON text among them.

Reading such a file runs no code that it names: it can only describe plain values, arrays, and dataclasses and
named tuples of toile, which are filled field by field without calling anything of theirs.
"""

import io
import json
import math
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from toile.engine.forces.ground import Ground
from toile.geometry.errors import InputError

TREE = "tree"
PLAIN = (str, int, bool, type(None))


def state_bytes(content: object) -> bytes:
    """Return a file that holds a value of plain types, arrays, dataclasses and named tuples of toile."""
    arrays: dict[str, np.ndarray[Any, Any]] = {}
    tree = _packed(content, arrays)
    text = json.dumps(tree, allow_nan=False, separators=(",", ":")).encode()
    file = io.BytesIO()
    np.savez(file, allow_pickle=False, **{TREE: np.frombuffer(text, np.uint8)}, **arrays)
    return file.getvalue()


def read_state(path: Path) -> object:
    """Return what a file of `state_bytes` holds. Raises InputError if it is damaged."""
    try:
        with np.load(path, allow_pickle=False) as arrays:
            return _unpacked(json.loads(arrays[TREE].tobytes()), arrays)
    except (
        OSError, ValueError, KeyError, TypeError, AttributeError, IndexError, ImportError, EOFError,
        RecursionError, MemoryError, zipfile.BadZipFile,
    ) as error:  # fmt: skip
        raise InputError(
            f"{path}: is damaged ({type(error).__name__}); start the run again", file=path
        ) from None


def _packed(value: object, arrays: dict[str, np.ndarray[Any, Any]]) -> Any:
    """Return a value as JSON; arrays are put aside under new names."""

    def put(array: np.ndarray[Any, Any]) -> str:
        name = f"a{len(arrays)}"
        arrays[name] = array
        return name

    if isinstance(value, PLAIN):
        return value
    if isinstance(value, float) and not isinstance(value, np.generic):
        return value if math.isfinite(value) else {"float": repr(value)}
    if isinstance(value, np.ndarray | np.generic):
        return {"scalar" if isinstance(value, np.generic) else "array": put(np.asarray(value))}
    if isinstance(value, csr_array):
        return {"csr": [put(value.data), put(value.indices), put(value.indptr), list(map(int, value.shape))]}
    if isinstance(value, Path):
        return {"path": str(value)}
    if isinstance(value, partial) and value.func == Ground.under:
        return {"ground": _packed(value.args[0], arrays)}
    if is_dataclass(value) and not isinstance(value, type):
        return {_name(value): {e.name: _packed(getattr(value, e.name), arrays) for e in fields(value)}}
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return {_name(value): {name: _packed(getattr(value, name), arrays) for name in value._fields}}
    for kind in (tuple, list, frozenset):
        if isinstance(value, kind):
            entries = sorted(value) if kind is frozenset else value
            return {kind.__name__: [_packed(entry, arrays) for entry in entries]}
    if isinstance(value, Mapping):
        return {"dict": [[_packed(key, arrays), _packed(entry, arrays)] for key, entry in value.items()]}
    raise TypeError(f"a {type(value).__name__} is no state of a run")


def _name(value: object) -> str:
    return f"{type(value).__module__}:{type(value).__qualname__}"


def _unpacked(tree: Any, arrays: Any) -> Any:
    """Return the value of JSON that `_packed` made."""
    if isinstance(tree, PLAIN) or isinstance(tree, float):
        return tree
    ((kind, content),) = tree.items()
    if kind in _KINDS:
        return _KINDS[kind](content, arrays)
    module, name = kind.split(":")
    if not module.startswith("toile."):
        raise ValueError(f"{kind} is no part of toile")
    type_ = getattr(import_module(module), name)
    values = {field: _unpacked(entry, arrays) for field, entry in content.items()}
    if isinstance(type_, type) and issubclass(type_, tuple) and hasattr(type_, "_fields"):
        return tuple.__new__(type_, (values[field] for field in type_._fields))
    if not isinstance(type_, type) or not is_dataclass(type_):
        raise ValueError(f"{kind} is no record")
    made = object.__new__(type_)
    for entry in fields(type_):
        object.__setattr__(made, entry.name, values[entry.name])
    return made


def _list(content: Any, arrays: Any) -> list[Any]:
    return [_unpacked(entry, arrays) for entry in content]


_KINDS: dict[str, Callable[[Any, Any], Any]] = {
    "float": lambda content, _: float(content),
    "array": lambda content, arrays: arrays[content],
    "scalar": lambda content, arrays: arrays[content][()],
    "csr": lambda content, arrays: csr_array(
        (arrays[content[0]], arrays[content[1]], arrays[content[2]]), shape=tuple(content[3])
    ),
    "path": lambda content, _: Path(content),
    "ground": lambda content, arrays: partial(Ground.under, float(_unpacked(content, arrays))),
    "tuple": lambda content, arrays: tuple(_list(content, arrays)),
    "list": _list,
    "frozenset": lambda content, arrays: frozenset(_list(content, arrays)),
    "dict": lambda content, arrays: {
        _unpacked(key, arrays): _unpacked(entry, arrays) for key, entry in content
    },
}
"""How values are made that are no records."""
