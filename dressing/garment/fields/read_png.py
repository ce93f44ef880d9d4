"""Brightness of PNG images: 8 or 16 bits, grey or colours, not interlaced (ISO/IEC 15948)."""

import struct
import zlib
from pathlib import Path

import numpy as np
import numpy.typing as npt

from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

SIGNATURE = b"\x89PNG\r\n\x1a\n"
CHANNELS = {0: 1, 2: 3, 4: 2, 6: 4}
"""Channels by colour type: grey, RGB, grey and alpha, RGBA."""
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Shares of red, green and blue in brightness (ITU-R BT.709), of values as they are in the file."""
MOST_PIXELS = 64_000_000


def read_brightness(path: Path) -> Float:
    """Return the brightness of an image, 0 to 1, the upper row first, shape (rows, columns).

    Raises InputError if the file is missing, or no PNG of the kinds above.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(
            f"{path}: image cannot be read ({error.strerror}); check the path", file=path
        ) from None
    try:
        return _decoded(data)
    except (ValueError, zlib.error, struct.error) as error:
        raise InputError(
            f"{path}: {error}; save it as PNG with 8 or 16 bits per channel, not interlaced", file=path
        ) from None


def _decoded(data: bytes) -> Float:
    if data[:8] != SIGNATURE:
        raise ValueError("it is no PNG file")
    at, packed, header = 8, [], b""
    while at + 8 <= len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        if kind == b"IHDR":
            header = data[at + 8 : at + 8 + length]
        elif kind == b"IDAT":
            packed.append(data[at + 8 : at + 8 + length])
        at += length + 12
    width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", header)
    if depth not in (8, 16) or colour not in CHANNELS or interlaced:
        raise ValueError("it has a palette, other bits or is interlaced")
    if not 0 < width * height <= MOST_PIXELS:
        raise ValueError(f"it has {width} x {height} pixels")
    step = CHANNELS[colour] * depth // 8
    unpacker = zlib.decompressobj()
    raw = unpacker.decompress(b"".join(packed), height * (width * step + 1))
    if len(raw) < height * (width * step + 1):
        raise ValueError("it ends too early")
    rows = np.frombuffer(raw, np.uint8)[: height * (width * step + 1)].reshape(height, -1)
    plain = _unfiltered(rows, step)
    pixels = plain.reshape(height, width, step).view(">u2" if depth == 16 else np.uint8)
    shades = pixels.astype(np.float64) / (2**depth - 1)
    return np.asarray(shades[..., :3] @ LUMINANCE if colour in (2, 6) else shades[..., 0])


def _unfiltered(rows: npt.NDArray[np.uint8], step: int) -> npt.NDArray[np.uint8]:
    """Undo the filter of every row, whose number stands in front of it."""
    result = np.zeros((len(rows), rows.shape[1] - 1), np.uint8)
    above = np.zeros(rows.shape[1] - 1, np.int64)
    for number, row in enumerate(rows):
        kind, line = int(row[0]), row[1:].astype(np.int64)
        if kind == 1:
            line = line.reshape(-1, step).cumsum(axis=0).ravel()
        elif kind == 2:
            line = line + above
        elif kind in (3, 4):
            for k in range(len(line)):
                left = line[k - step] % 256 if k >= step else 0
                corner = above[k - step] if k >= step else 0
                line[k] += (left + above[k]) // 2 if kind == 3 else _paeth(left, above[k], corner)
        elif kind:
            raise ValueError(f"row {number} has the unknown filter {kind}")
        above = line % 256
        result[number] = above
    return result


def _paeth(left: int, above: int, corner: int) -> int:
    guess = left + above - corner
    away = abs(guess - left), abs(guess - above), abs(guess - corner)
    return (left, above, corner)[away.index(min(away))]
