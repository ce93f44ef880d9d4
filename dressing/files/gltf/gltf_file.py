"""A glTF file as a container: its JSON, its buffers, and the numbers of its accessors.

Khronos Group, glTF 2.0 specification, sections 3.6 (buffers, accessors) and 4 (GLB).
"""

import base64
import binascii
import json
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import unquote, unquote_to_bytes

import numpy as np
import numpy.typing as npt

from toile.dressing.files.on_disk import is_file
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

MAGIC = b"glTF"
DTYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
"""Component type to numpy's."""
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
UNREADABLE = {
    "KHR_draco_mesh_compression": "without Draco compression",
    "EXT_meshopt_compression": "without meshopt compression",
    "KHR_meshopt_compression": "without meshopt compression",
}
"""Extensions that change where vertices are and are not read, to how to export instead."""
MOST_ZEROS = 10_000_000
"""Rows of an accessor that holds no numbers of its own but zeros; no file backs them."""


@contextmanager
def checked_shape(path: Path) -> Iterator[None]:
    """Turn what comes of JSON of any other shape than glTF's into InputError."""
    try:
        yield
    except InputError:
        raise
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError) as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(f"{path}: is not valid glTF ({reason}); export it again", file=path) from error


def has_animation(path: Path) -> bool:
    """Whether a file is glTF and holds an animation; False where it cannot be read, whatever the reason."""
    try:
        with path.open("rb") as file:
            head = file.read(20)
            if head[:4] == MAGIC:
                text = file.read(min(struct.unpack("<I", head[12:16])[0], path.stat().st_size))
            else:
                text = head + file.read()
        # Most bodies stand still, and some .gltf carry megabytes of base64.
        return b'"animations"' in text and bool(json.loads(text).get("animations"))
    except (OSError, ValueError, AttributeError, RecursionError, struct.error):
        return False


class GltfFile:
    """The JSON of a .glb or .gltf file and the numbers in its buffers.

    Attributes
    ----------
    path
        The file.
    content
        Its JSON.

    Raises
    ------
    InputError
        If it is no glTF 2.0, is cut off, or needs an extension that is not read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        if not is_file(path):
            raise InputError(f"{path}: file not found; check the path", file=path)
        data = path.read_bytes()
        text, self._chunk = self._chunks(data) if data[:4] == MAGIC else (data, None)
        try:
            self.content: dict[str, Any] = json.loads(text)
            version = str(self.content["asset"]["version"])
        except (ValueError, RecursionError, KeyError, TypeError) as error:
            raise self.error(f"cannot be read as a mesh (its JSON: {error})") from None
        if not version.startswith("2"):
            raise self.error(f"is glTF {version}; export it as glTF 2.0", "")
        for name in self.content.get("extensionsRequired", ()):
            if name in UNREADABLE:
                raise self.unreadable(name)
        self._buffers: dict[int, bytes] = {}

    def error(self, what: str, remedy: str = "; export it again") -> InputError:
        """Return the error that names the file."""
        return InputError(f"{self.path}: {' '.join(what.split())}{remedy}", file=self.path)

    def unreadable(self, extension: str) -> InputError:
        """Return the error that names an extension of UNREADABLE and what to do."""
        return self.error(f"needs {extension}, which is not read; export it {UNREADABLE[extension]}", "")

    def refuse_compression(self, primitive: dict[str, Any]) -> None:
        """Raise InputError if the positions of a primitive lie in an extension that is not read only."""
        accessor = self.entry("accessors", primitive["attributes"]["POSITION"])
        for name in primitive.get("extensions", ()):
            if name in UNREADABLE and "bufferView" not in accessor:
                raise self.unreadable(name)

    def entry(self, kind: str, index: Any) -> dict[str, Any]:
        """Entry of a list of the JSON, such as accessors[7]. Raises InputError if there is none."""
        entries = self.content.get(kind, [])
        if isinstance(index, bool) or not isinstance(index, int) or not 0 <= index < len(entries):
            raise self.error(f"refers to {kind}[{index}], which does not exist")
        found: dict[str, Any] = entries[index]
        return found

    def size_of(self, index: Any) -> int:
        """Return the number of rows of an accessor."""
        return self._size(self.entry("accessors", index), "count", f"accessors[{index}]")

    def numbers(self, index: Any, kind: str, *, finite: bool = True) -> Float:
        """Return the numbers of an accessor, shape (count, width); normalised integers as fractions.

        `kind` is the type it must have, such as "VEC3". Raises InputError if it has another, reads outside
        its buffer, or where numbers must be `finite` and are not.
        """
        accessor = self.entry("accessors", index)
        place = f"accessors[{index}]"
        if accessor["type"] != kind:
            raise self.error(f"{place} must be {kind}, is {accessor['type']}")
        if accessor["componentType"] not in DTYPES:
            raise self.error(f"{place}.componentType {accessor['componentType']} is unknown")
        dtype = np.dtype(DTYPES[accessor["componentType"]])
        count, width = self._size(accessor, "count", place), WIDTHS[kind]
        if "bufferView" in accessor:
            raw = self._read(accessor, dtype, count, width, place).copy()
        elif count <= MOST_ZEROS:
            raw = np.zeros((count, width), dtype)
        else:
            raise self.error(f"{place} has {count} rows, but no bufferView")
        if "sparse" in accessor:
            sparse, place = accessor["sparse"], f"{place}.sparse"
            few = self._size(sparse, "count", place)
            whole = np.dtype(DTYPES[sparse["indices"]["componentType"]])
            rows = self._read(sparse["indices"], whole, few, 1, f"{place}.indices")[:, 0].astype(np.int64)
            if (rows >= count).any():
                raise self.error(f"{place}.indices reach {rows.max()}, but count is {count}")
            raw[rows] = self._read(sparse["values"], dtype, few, width, f"{place}.values")
        values = raw.astype(np.float64)
        if accessor.get("normalized") and dtype.kind != "f":
            values = np.maximum(values / np.iinfo(dtype).max, -1.0)
        if finite and not np.isfinite(values).all():
            raise self.error(f"{place} holds NaN or infinite numbers")
        return values

    def _chunks(self, data: bytes) -> tuple[bytes, bytes | None]:
        """JSON and binary chunk of a GLB file."""
        chunks: list[tuple[bytes, bytes]] = []
        offset = 12
        while offset + 8 <= len(data) and len(chunks) < 2:
            size, kind = struct.unpack_from("<I4s", data, offset)
            if offset + 8 + size > len(data):
                raise self.error("the file is cut off")
            chunks.append((kind, data[offset + 8 : offset + 8 + size]))
            offset += 8 + size
        if not chunks or chunks[0][0] != b"JSON":
            raise self.error("the file has no JSON chunk")
        return chunks[0][1], chunks[1][1] if len(chunks) > 1 and chunks[1][0] == b"BIN\0" else None

    def _has_bytes(self, index: Any) -> bool:
        """Whether a buffer holds bytes; what decoders are to fill need not."""
        return "uri" in self.entry("buffers", index) or (index == 0 and self._chunk is not None)

    def _buffer(self, index: Any) -> bytes:
        """Bytes of a buffer: the binary chunk, a data: URI or a file beside this one."""
        buffer = self.entry("buffers", index)
        if index not in self._buffers:
            self._buffers[index] = self._fetched(buffer, f"buffers[{index}]")
        return self._buffers[index]

    def _fetched(self, buffer: dict[str, Any], place: str) -> bytes:
        """Bytes of a buffer, from wherever it is. Raises InputError if they are not all there."""
        uri = buffer.get("uri")
        if uri is None:
            data = self._chunk or b""
        elif uri.startswith("data:"):
            head, _, body = uri.partition(",")
            try:
                data = base64.b64decode(body) if head.endswith(";base64") else unquote_to_bytes(body)
            except binascii.Error as error:
                raise self.error(f"{place}: its data: URI cannot be read ({error})") from None
        else:
            try:
                data = (self.path.parent / unquote(uri)).read_bytes()
            except OSError as error:
                reason = error.strerror or "cannot be read"
                raise self.error(f"{place}: {uri}: {reason}", "; put it beside the file") from None
        wanted = self._size(buffer, "byteLength", place)
        if len(data) < wanted:
            raise self.error(f"{place} is cut off: {len(data)} of {wanted} bytes")
        return data[:wanted]

    def _size(self, entry: dict[str, Any], key: str, place: str, default: int | None = None) -> int:
        """Return a whole number of the JSON that is not negative."""
        value = entry.get(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or value < 0:
            raise self.error(f"{place}.{key} must be a whole number, is {value!r}")
        return value

    def _read(
        self, entry: dict[str, Any], dtype: np.dtype[Any], count: int, width: int, place: str
    ) -> npt.NDArray[Any]:
        """Return rows of numbers where an accessor's or sparse part's entry says, shape (count, width)."""
        view = self.entry("bufferViews", entry["bufferView"])
        name = f"bufferViews[{entry['bufferView']}]"
        for extension in view.get("extensions", ()):
            if extension in UNREADABLE and not self._has_bytes(view["buffer"]):
                raise self.unreadable(extension)
        data = self._buffer(view["buffer"])
        begin, size = self._size(view, "byteOffset", name, 0), self._size(view, "byteLength", name)
        if begin + size > len(data):
            raise self.error(f"{name} reads bytes {begin} to {begin + size} of a buffer of {len(data)}")
        row = dtype.itemsize * width
        stride = self._size(view, "byteStride", name, row)
        offset = self._size(entry, "byteOffset", place, 0)
        if stride < row or (count and offset + stride * (count - 1) + row > size):
            raise self.error(
                f"{place} reads {count} rows of {row} bytes, {stride} apart, from byte {offset} "
                f"of a bufferView of {size}"
            )
        return np.ndarray(
            (count, width), dtype, buffer=data, offset=begin + offset, strides=(stride, dtype.itemsize)
        )
