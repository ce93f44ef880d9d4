"""Binary PLY: nodes and triangles, perhaps with velocities and with texture coordinates of corners."""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from toile.geometry.arrays import Float, Int

HEADER = (
    "ply\nformat binary_little_endian 1.0\n"
    "element vertex {vertices}\n"
    "property double x\nproperty double y\nproperty double z\n{more}"
    "element face {faces}\n"
    "property list uchar int vertex_indices\n"
)
VELOCITY = "property float vx\nproperty float vy\nproperty float vz\n"
TEXCOORD = "property list uchar float texcoord\n"
END = "end_header\n"


class PlyMesh(NamedTuple):
    """A mesh.

    positions: vertices, shape (n, 3). faces: triangles, (t, 3). corner_uv: texture coordinates of their
    corners, (t, 3, 2). velocities: of the vertices, per second, (n, 3).
    """

    positions: Float
    faces: Int
    corner_uv: Float | None = None
    velocities: Float | None = None


def ply_bytes(
    positions: Float, faces: Int, corner_uv: Float | None = None, velocities: Float | None = None,
    fields: Mapping[str, Float] | None = None,
) -> bytes:  # fmt: skip
    """Return a binary little-endian PLY file; float64 keeps gaps that float32 would round away.

    `corner_uv`, shape (t, 3, 2), becomes the face property `texcoord`: seams have two values per vertex;
    `velocities`, shape (n, 3), and `fields`, shape (n,) by their names, become vertex properties.
    """
    fields = fields or {}
    more = "" if velocities is None else VELOCITY
    more += "".join(f"property float {name}\n" for name in fields)
    header = HEADER.format(vertices=len(positions), faces=len(faces), more=more)
    header += END if corner_uv is None else TEXCOORD + END
    rows = np.empty(len(faces), dtype=_row(corner_uv is not None))
    rows["count"] = 3
    rows["corners"] = faces
    if corner_uv is not None:
        rows["uv_count"] = 6
        rows["uv"] = corner_uv.reshape(-1, 6)
    vertices = np.empty(len(positions), dtype=_vertex_row(velocities is not None, tuple(fields)))
    vertices["place"] = positions
    if velocities is not None:
        vertices["velocity"] = velocities
    for name, values in fields.items():
        vertices[name] = values
    return header.encode() + vertices.tobytes() + rows.tobytes()


def read_own_ply(path: Path) -> PlyMesh:
    """Read a file that `ply_bytes` made without fields."""
    content = path.read_bytes()
    head, _, data = content.partition(END.encode())
    lines = head.decode().splitlines()
    vertices, faces = (int(line.split()[2]) for line in lines if line.startswith("element"))
    has_uv = TEXCOORD.strip() in lines
    has_velocity = "property float vx" in lines
    layout = _vertex_row(has_velocity)
    held = np.frombuffer(data, layout, vertices)
    rows = np.frombuffer(data, _row(has_uv), faces, layout.itemsize * vertices)
    return PlyMesh(
        positions=np.ascontiguousarray(held["place"]),
        faces=np.ascontiguousarray(rows["corners"]),
        corner_uv=rows["uv"].astype(np.float64).reshape(-1, 3, 2) if has_uv else None,
        velocities=held["velocity"].astype(np.float64) if has_velocity else None,
    )


def _vertex_row(has_velocity: bool, fields: tuple[str, ...] = ()) -> np.dtype[np.void]:
    """Return the layout of a vertex."""
    velocity = [("velocity", "<f4", (3,))] if has_velocity else []
    return np.dtype([("place", "<f8", (3,)), *velocity, *((name, "<f4") for name in fields)])


def _row(has_uv: bool) -> np.dtype[np.void]:
    """Return the layout of a face."""
    uv: list[tuple[str, str] | tuple[str, str, tuple[int]]] = [("uv_count", "u1"), ("uv", "<f4", (6,))]
    return np.dtype([("count", "u1"), ("corners", "<i4", (3,)), *(uv if has_uv else [])])
