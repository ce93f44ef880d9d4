"""Binary PLY: nodes and triangles, perhaps with texture coordinates of their corners."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from toile.geometry.arrays import Float, Int

HEADER = (
    "ply\nformat binary_little_endian 1.0\n"
    "element vertex {vertices}\n"
    "property double x\nproperty double y\nproperty double z\n"
    "element face {faces}\n"
    "property list uchar int vertex_indices\n"
)
TEXCOORD = "property list uchar float texcoord\n"
END = "end_header\n"


class PlyMesh(NamedTuple):
    """Vertices, shape (n, 3), triangles, (t, 3), and texture coordinates of their corners, (t, 3, 2)."""

    positions: Float
    faces: Int
    corner_uv: Float | None


def ply_bytes(positions: Float, faces: Int, corner_uv: Float | None = None) -> bytes:
    """Return a binary little-endian PLY file; float64 keeps gaps that float32 would round away.

    `corner_uv`, shape (t, 3, 2), becomes the face property `texcoord`: seams have two values per vertex.
    """
    header = HEADER.format(vertices=len(positions), faces=len(faces))
    header += END if corner_uv is None else TEXCOORD + END
    rows = np.empty(len(faces), dtype=_row(corner_uv is not None))
    rows["count"] = 3
    rows["corners"] = faces
    if corner_uv is not None:
        rows["uv_count"] = 6
        rows["uv"] = corner_uv.reshape(-1, 6)
    return header.encode() + np.ascontiguousarray(positions, dtype="<f8").tobytes() + rows.tobytes()


def read_own_ply(path: Path) -> PlyMesh:
    """Read a file that `ply_bytes` made."""
    content = path.read_bytes()
    head, _, data = content.partition(END.encode())
    lines = head.decode().splitlines()
    vertices, faces = (int(line.split()[2]) for line in lines if line.startswith("element"))
    has_uv = TEXCOORD.strip() in lines
    positions = np.frombuffer(data, "<f8", 3 * vertices).reshape(-1, 3)
    rows = np.frombuffer(data, _row(has_uv), faces, 24 * vertices)
    corner_uv = rows["uv"].astype(np.float64).reshape(-1, 3, 2) if has_uv else None
    return PlyMesh(positions, np.ascontiguousarray(rows["corners"]), corner_uv)


def _row(has_uv: bool) -> np.dtype[np.void]:
    """Return the layout of a face."""
    uv: list[tuple[str, str] | tuple[str, str, tuple[int]]] = [("uv_count", "u1"), ("uv", "<f4", (6,))]
    return np.dtype([("count", "u1"), ("corners", "<i4", (3,)), *(uv if has_uv else [])])
