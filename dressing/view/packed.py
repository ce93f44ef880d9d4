"""Numbers of a view as text: one deflated block, of which a header names the parts."""

import base64
import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

KINDS = {1: ("u1", "<u1"), 2: ("u2", "<u2"), 4: ("u4", "<u4")}
"""Names of unsigned numbers, in the page and in numpy, by their size."""

Reference = list[Any]
"""Kind of numbers, offset [bytes], and count."""


class Packed:
    """A block that grows, with the places of what is in it."""

    def __init__(self) -> None:
        self._data = bytearray()

    def add(self, numbers: npt.NDArray[Any]) -> Reference:
        """Append unsigned numbers of 1, 2 or 4 bytes; return where they are."""
        name, layout = KINDS[numbers.dtype.itemsize]
        place = len(self._data)
        self._data += numbers.astype(layout).tobytes()
        self._data += bytes(-len(self._data) % 4)
        return [name, place, int(numbers.size)]

    def indices(self, numbers: npt.NDArray[Any]) -> Reference:
        """Append whole numbers from 0 in as few bytes as hold them all."""
        most = int(numbers.max(initial=0))
        layout = np.uint8 if most < 256 else np.uint16 if most < 65536 else np.uint32
        return self.add(np.ascontiguousarray(numbers).ravel().astype(layout))

    def text(self) -> str:
        """Return the block, deflated, in base64."""
        return base64.b64encode(zlib.compress(bytes(self._data), 6)).decode()
