"""A small picture of a result, for pages that show thousands."""

from pathlib import Path

import numpy as np

from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.files.writers.png import png_bytes, png_pixels
from toile.dressing.pictures.preview import Pixels

NAME = "thumbnail.png"
SHRINK = 4
"""Pixels of the preview, along each side, that make one of the thumbnail."""


def write_thumbnail(folder: Path) -> Path:
    """Write a small copy of a folder's preview.png and return its path."""
    pixels = png_pixels((folder / "preview.png").read_bytes())
    return write_atomic(folder / NAME, png_bytes(smaller(pixels, SHRINK)))


def smaller(pixels: Pixels, shrink: int) -> Pixels:
    """Return a picture in which blocks of `shrink` by `shrink` pixels have become one, their mean."""
    rows, columns = pixels.shape[0] // shrink, pixels.shape[1] // shrink
    blocks = pixels[: rows * shrink, : columns * shrink].reshape(rows, shrink, columns, shrink, 3)
    small: Pixels = np.rint(blocks.mean(axis=(1, 3))).astype(np.uint8)
    return small
