"""Stanford PLY, in text or binary of either byte order: polygons of any mixture of sizes, strips, texture.

Turk (1994), The PLY polygon file format.
"""

import itertools
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from toile.dressing.files.corner_surface import Surface, node_attributes
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

MAGIC = b"ply"
TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
    "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4",
    "uint32": "u4", "float32": "f4", "float64": "f8", "int64": "i8", "uint64": "u8",
}  # fmt: skip
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
CORNERS = ("vertex_indices", "vertex_index")
TEXTURE = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"), ("texture_s", "texture_t"))
"""Names of texture coordinates of vertices; those of corners are a list called texcoord."""
Numbers = npt.NDArray[Any]


@dataclass(frozen=True, kw_only=True)
class _Property:
    """A column: its type, and that of the length before it where it is a list."""

    name: str
    kind: str
    length: str | None


@dataclass(frozen=True, kw_only=True)
class _Element:
    """Rows of a kind."""

    name: str
    count: int
    properties: list[_Property]


def read_ply(path: Path, shape: Float | None = None) -> Surface:
    """Return the surface of a PLY file in the file's units.

    `shape` are positions by which polygons are split, see `Surface.from_polygons`. Raises InputError naming
    what is wrong with the file.
    """
    try:
        columns = _columns(path.read_bytes())
        corners = [_whole(row) for name in CORNERS for row in columns.get("face", {}).get(name, ())]
        corners += [face for strip in _strips(columns) for face in strip]
    except (ValueError, LookupError, OverflowError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"{path}: cannot be read as a mesh ({reason}); export it again", file=path) from None
    vertex = columns.get("vertex", {})
    if not all(axis in vertex for axis in "xyz"):
        raise InputError(f"{path}: its vertices have no x, y and z; export it again", file=path)
    positions = np.stack([np.asarray(vertex[axis], np.float64) for axis in "xyz"], axis=1)
    wedges = columns.get("face", {}).get("texcoord", ())
    kept = [number for number, face in enumerate(corners) if len(face) > 2]
    for number in kept:
        if not all(0 <= corner < len(positions) for corner in corners[number]):
            raise InputError(
                f"{path}: face {number} refers to a vertex that does not exist; export it again", (number,),
                file=path,
            )  # fmt: skip
    chosen = [corners[number] for number in kept]
    uv, uv_corners = _texture(vertex, wedges, kept, chosen)
    surface = Surface.from_polygons(
        positions=positions, corners=chosen, uv=uv, uv_corners=uv_corners,
        panel=np.zeros(len(chosen), np.int32), shape=shape,
    )  # fmt: skip
    attributes = node_attributes(
        vertex, len(positions), (*"xyz", *(name for pair in TEXTURE for name in pair))
    )
    return replace(surface.with_panel_names(("",)), attributes=attributes)


def _whole(row: Numbers) -> list[int]:
    """Return a row as whole numbers."""
    return [int(value) for value in row.tolist()]


def _texture(
    vertex: dict[str, Any], wedges: Any, kept: list[int], corners: list[list[int]]
) -> tuple[Float, list[list[int]]]:
    """Texture coordinates, shape (k, 2), and the corners of faces into them; -1 where there are none."""
    if len(wedges) and all(
        number < len(wedges) and len(wedges[number]) == 2 * len(face)
        for number, face in zip(kept, corners, strict=True)
    ):
        uv = np.concatenate([np.asarray(wedges[number], np.float64).reshape(-1, 2) for number in kept])
        ends = itertools.accumulate(len(face) for face in corners)
        return uv, [list(range(end - len(face), end)) for end, face in zip(ends, corners, strict=True)]
    for names in TEXTURE:
        if all(name in vertex for name in names):
            uv = np.stack([np.asarray(vertex[name], np.float64) for name in names], axis=1)
            if np.isfinite(uv).all():
                return uv, corners
    return np.empty((0, 2)), [[-1] * len(face) for face in corners]


def _strips(columns: dict[str, dict[str, Any]]) -> list[list[list[int]]]:
    """Triangles of strips of triangles; -1 begins a strip anew."""
    found: list[list[list[int]]] = []
    for row in columns.get("tristrips", {}).get("vertex_indices", ()):
        faces: list[list[int]] = []
        for _, group in itertools.groupby(_whole(row), key=lambda corner: corner < 0):
            run = list(group)
            for k in range(len(run) - 2):
                face = run[k : k + 3] if k % 2 == 0 else [run[k + 1], run[k], run[k + 2]]
                if min(face) >= 0 and len(set(face)) == 3:
                    faces.append(face)
        found.append(faces)
    return found


def _columns(data: bytes) -> dict[str, dict[str, Any]]:
    """Columns of all elements by their names: arrays, or lists of arrays. Raises ValueError."""
    order, elements, start = _header(data)
    body: _Text | _Binary = _Text(data[start:]) if order == "" else _Binary(data[start:], order)
    return {element.name: body.read(element) for element in elements}


def _header(data: bytes) -> tuple[str, list[_Element], int]:
    """Byte order ("" for text), elements, and where the header ends."""
    end = data.find(b"end_header")
    if data[:3] != MAGIC or end < 0:
        raise ValueError("it is no PLY file")
    after = end + len(b"end_header")
    newline = b"\r\n" if data[after : after + 2] == b"\r\n" else data[after : after + 1]
    order: str | None = None
    elements: list[_Element] = []
    for line in data[3:end].decode("utf-8", errors="replace").replace("\r", "\n").split("\n"):
        words = line.split()
        if not words or words[0] in ("comment", "obj_info"):
            continue
        if words[0] == "format" and len(words) > 1 and words[1] in ORDERS:
            order = ORDERS[words[1]]
        elif words[0] == "element" and len(words) == 3 and words[2].isdecimal():
            elements.append(_Element(name=words[1], count=int(words[2]), properties=[]))
        elif words[0] == "property" and elements and len(words) in (3, 5) and _known(words[1:-1]):
            length = TYPES[words[2]] if words[1] == "list" else None
            elements[-1].properties.append(_Property(name=words[-1], kind=TYPES[words[-2]], length=length))
        else:
            raise ValueError(f"line '{line.strip()[:60]}' of its header is not understood")
    if order is None:
        raise ValueError("its header does not say the format")
    return order, elements, after + len(newline)


def _known(words: list[str]) -> bool:
    """Whether the types of a property are."""
    return all(word in TYPES for word in (words[1:] if words[0] == "list" else words)) and len(words) in (
        1,
        3,
    )


class _Text:
    """Numbers of a text file, one after the other."""

    def __init__(self, data: bytes) -> None:
        self._values = np.array(data.split(), dtype=np.float64)
        self._place = 0

    def read(self, element: _Element) -> dict[str, Any]:
        """Columns of an element."""
        properties = element.properties
        if all(entry.length is None for entry in properties):
            table = self._next(element.count * len(properties)).reshape(-1, max(len(properties), 1))
            return {entry.name: table[:, k] for k, entry in enumerate(properties)}
        found: dict[str, list[Any]] = {entry.name: [] for entry in properties}
        # Every row takes a number at least, which bounds the loop.
        for _ in range(element.count):
            for entry in properties:
                count = 1 if entry.length is None else _length(self._next(1)[0])
                values = self._next(count)
                found[entry.name].append(values[0] if entry.length is None else values)
        return found

    def _next(self, count: int) -> Numbers:
        """Return the next numbers."""
        if count > len(self._values) - self._place:
            raise ValueError("it is cut off")
        self._place += count
        return self._values[self._place - count : self._place]


class _Binary:
    """Bytes of a binary file, row by row."""

    def __init__(self, data: bytes, order: str) -> None:
        self._data = data
        self._order = order
        self._place = 0

    def read(self, element: _Element) -> dict[str, Any]:
        """Columns of an element."""
        properties = element.properties
        sizes = [0] * len(properties)
        if any(entry.length for entry in properties) and element.count:
            place = self._place
            sizes = [
                len(row) if entry.length else 0
                for entry, row in zip(properties, self._row(properties), strict=True)
            ]
            self._place = place
        table = self._alike(element, sizes)
        if table is not None:
            return {entry.name: table[f"{k}"] for k, entry in enumerate(properties)}
        found: dict[str, list[Any]] = {entry.name: [] for entry in properties}
        for _ in range(element.count):
            for entry, value in zip(properties, self._row(properties), strict=True):
                found[entry.name].append(value if entry.length else value[0])
        return found

    def _alike(self, element: _Element, sizes: list[int]) -> Numbers | None:
        """Return all rows at once where their lists are as long as in the first, else None."""
        fields: list[Any] = []
        for k, (entry, size) in enumerate(zip(element.properties, sizes, strict=True)):
            if entry.length:
                fields.append((f"length{k}", self._order + entry.length))
            fields.append((f"{k}", self._order + entry.kind, (size,) if entry.length else ()))
        row = np.dtype(fields)
        if element.count * row.itemsize > len(self._data) - self._place:
            if not any(entry.length for entry in element.properties):
                raise ValueError("it is cut off")
            return None
        table: Numbers = np.frombuffer(self._data, row, element.count, self._place)
        for k, (entry, size) in enumerate(zip(element.properties, sizes, strict=True)):
            if entry.length and (table[f"length{k}"] != size).any():
                return None
        self._place += element.count * row.itemsize
        return table

    def _row(self, properties: list[_Property]) -> list[Numbers]:
        """Return the values of the next row."""
        return [
            self._next(1 if entry.length is None else _length(self._next(1, entry.length)[0]), entry.kind)
            for entry in properties
        ]

    def _next(self, count: int, kind: str) -> Numbers:
        """Return the next numbers."""
        dtype = np.dtype(self._order + kind)
        if count * dtype.itemsize > len(self._data) - self._place:
            raise ValueError("it is cut off")
        self._place += count * dtype.itemsize
        return np.frombuffer(self._data, dtype, count, self._place - count * dtype.itemsize)


def _length(value: Any) -> int:
    """Return the length of a list."""
    if not value >= 0 or value != int(value):
        raise ValueError(f"a list has {value:g} entries")
    return int(value)
