"""MDD point caches: vertices over time, as Blender, Maya and Houdini play them on a mesh."""

import struct
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from toile.dressing.files.writers.atomic import replacing
from toile.dressing.files.writers.ply import PlyMesh


def write_mdd(path: Path, fps: float, count: int, frames: Iterable[PlyMesh]) -> Path | None:
    """Write the vertices of `count` frames, in their order and units, and return the path.

    None if faces change from frame to frame: such a cache has one mesh for all.
    """
    first: PlyMesh | None = None
    try:
        with replacing(path) as temporary, open(temporary, "wb") as file:
            for frame in frames:
                if first is None:
                    first = frame
                    file.write(struct.pack(">2i", count, len(frame.positions)))
                    file.write((np.arange(count) / fps).astype(">f4").tobytes())
                elif not np.array_equal(frame.faces, first.faces):
                    raise _OtherFaces
                file.write(frame.positions.astype(">f4").tobytes())
    except _OtherFaces:
        return None
    return path


class _OtherFaces(Exception):
    """A frame has other faces than the first."""
