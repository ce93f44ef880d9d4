"""Readers of garment files, by extension; `toile.register_reader` adds one."""

from collections.abc import Callable
from pathlib import Path

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.mesh_garment import FORMATS as MESH_FORMATS
from toile.dressing.pattern.drawn.read_drawn import DRAWN_FORMATS
from toile.dressing.pattern.garmentcode import check_pattern, read_garmentcode
from toile.dressing.pattern.pattern import Pattern
from toile.geometry.errors import InputError

Reader = Callable[[Path], Pattern | GarmentMesh]
"""Takes the path of a file that exists and is not empty; raises InputError naming what is wrong in it."""

_READERS: dict[str, Reader] = {".json": read_garmentcode}


def register_reader(suffix: str, read: Reader) -> None:
    """Read garment files of another format: scenes of this process may name them as a source.

    Parameters
    ----------
    suffix
        Extension of the files, such as ".pds"; upper and lower case are the same. A reader of ".dxf" or
        ".svg" takes the place of toile's own.
    read
        Takes the file's path and returns its pattern, which is checked and meshed as finely as the scene asks
        for, or its mesh. Both are placed around the body, in metres, Y up, the body facing +Z, feet at y = 0.

    Raises
    ------
    InputError
        If the extension is none, or if another function reads it already.
    """
    key = suffix.lower()
    if not key.startswith(".") or len(key) < 2 or Path(f"garment{key}").suffix != key:
        raise InputError(f"register_reader: {suffix!r} is no file extension; give one such as '.pds'")
    if key in MESH_FORMATS or _READERS.get(key, read) is not read:
        raise InputError(f"register_reader: '{key}' files have a reader already; choose another extension")
    _READERS[key] = read


def garment_formats() -> tuple[str, ...]:
    """Return the extensions of all garment files that can be read."""
    return tuple(dict.fromkeys((*_READERS, *DRAWN_FORMATS, *MESH_FORMATS)))


def is_registered(path: Path) -> bool:
    """Tell whether files of this extension have a reader that was registered."""
    return path.suffix.lower() in _READERS


def read_garment(path: str | Path) -> Pattern | GarmentMesh:
    """Return what a file holds, by the reader of its extension. Raises InputError naming what is wrong."""
    path = Path(path)
    read = _READERS[path.suffix.lower()]
    garment = read(path)
    if isinstance(garment, Pattern):
        check_pattern(garment)
    elif not isinstance(garment, GarmentMesh):
        raise TypeError(f"the reader of '{path.suffix}' returned {type(garment).__name__}, not a garment")
    return garment
