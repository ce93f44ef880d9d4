"""Animated GLB: meshes over time that three.js, model viewers and Blender play.

Where faces stay the same from frame to frame, the frames are morph targets of one mesh, whose weights go from
one to the next. Where remeshing changes them, another mesh begins; each is shown in its own frames only, its
scale being zero in all others.
"""

import json
import struct
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from toile.dressing.files.writers.atomic import replacing
from toile.dressing.files.writers.ply import PlyMesh
from toile.geometry.arrays import Float, Int
from toile.geometry.normals import drawn_normals

FLOAT, UNSIGNED_INT = 5126, 5125
VERTICES, INDICES = 34962, 34963
"""Constants of the glTF 2.0 specification (component types and buffer targets)."""
LARGEST = 2**32 - 2**20
"""A GLB file cannot be larger [bytes]."""


class MovingMesh(NamedTuple):
    """One mesh over time: its name, linear colour, a PlyMesh per frame [m], and whether both sides show."""

    name: str
    colour: tuple[float, float, float]
    frames: Iterable[PlyMesh]
    double_sided: bool = False


class _Stretch(NamedTuple):
    """Frames in a row with the same faces: their number, and the index of their mesh."""

    first: int
    length: int
    mesh: int


class _Document:
    """The file's JSON, and its binary chunk on disk."""

    def __init__(self, chunk: IO[bytes]) -> None:
        self.chunk = chunk
        self.length = 0
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []
        self.meshes: list[dict[str, Any]] = []
        self.nodes: list[dict[str, Any]] = []
        self.samplers: list[dict[str, Any]] = []
        self.channels: list[dict[str, Any]] = []

    def add(
        self, array: npt.NDArray[Any], kind: str, target: int | None = None, *, bounds: bool = False
    ) -> int:
        """Append an array of 4-byte numbers and return its accessor's index."""
        view = {"buffer": 0, "byteOffset": self.length, "byteLength": array.nbytes}
        self.views.append(view if target is None else view | {"target": target})
        accessor: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": UNSIGNED_INT if array.dtype == np.uint32 else FLOAT,
            "count": len(array),
            "type": kind,
        }
        if bounds:
            accessor |= {"min": np.atleast_1d(array.min(axis=0)).tolist()}
            accessor |= {"max": np.atleast_1d(array.max(axis=0)).tolist()}
        self.chunk.write(array.tobytes())
        self.length += array.nbytes
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def animate(self, node: int, path: str, times: Float, values: Float, interpolation: str) -> None:
        """Let something of a node take on values at times [s]."""
        kind = "VEC3" if path == "scale" else "SCALAR"
        self.samplers.append(
            {
                "input": self.add(times.astype("<f4"), "SCALAR", bounds=True),
                "output": self.add(values.astype("<f4"), kind),
                "interpolation": interpolation,
            }
        )
        target = {"node": node, "path": path}
        self.channels.append({"sampler": len(self.samplers) - 1, "target": target})


def write_moving_glb(path: Path, fps: float, meshes: Sequence[MovingMesh]) -> Path | None:
    """Write a .glb file of meshes over time, frame 0 at time 0, and return its path.

    None if it would be larger than the format allows. Arrays go to disk as they come: a film may be larger
    than memory.
    """
    with ExitStack() as stack:
        chunk = stack.enter_context(TemporaryFile(dir=path.parent))
        document = _Document(chunk)
        count = 0
        for index, mesh in enumerate(meshes):
            stretches = list(_stretches(document, mesh, index))
            count = stretches[-1].first + stretches[-1].length
            for stretch in stretches:
                _play(document, stretch, count, fps)
            if document.length > LARGEST:
                return None
        text = _text(document, meshes)
        with replacing(path) as temporary, open(temporary, "wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + document.length))
            file.write(struct.pack("<I4s", len(text), b"JSON") + text)
            file.write(struct.pack("<I4s", document.length, b"BIN\0"))
            chunk.seek(0)
            while block := chunk.read(1 << 20):
                file.write(block)
    return path


def _stretches(document: _Document, mesh: MovingMesh, material: int) -> Iterator[_Stretch]:
    """Write the frames of a mesh; yield those with the same faces."""
    first = length = 0
    base: PlyMesh | None = None
    node: Int = np.empty(0, np.int32)
    for index, frame in enumerate(mesh.frames):
        if base is not None and np.array_equal(base.faces, frame.faces):
            _add_target(document, base, node, frame)
        else:
            if base is not None:
                yield _Stretch(first, length, len(document.meshes) - 1)
            base, first, length = frame, index, 0
            node = _add_mesh(document, mesh.name, material, frame)
        length += 1
    yield _Stretch(first, length, len(document.meshes) - 1)


def _add_mesh(document: _Document, name: str, material: int, frame: PlyMesh) -> Int:
    """Add a mesh that begins with a frame; return the node of every vertex."""
    node, triangles, uv = _split(frame.faces, frame.corner_uv, len(frame.positions))
    normals = drawn_normals(frame.positions, frame.faces)[node]
    attributes = {
        "POSITION": document.add(frame.positions[node].astype("<f4"), "VEC3", VERTICES, bounds=True),
        "NORMAL": document.add(normals.astype("<f4"), "VEC3", VERTICES),
    }
    if uv is not None:
        # glTF counts v downwards.
        flipped = np.column_stack([uv[:, 0], 1.0 - uv[:, 1]]).astype("<f4")
        attributes["TEXCOORD_0"] = document.add(flipped, "VEC2", VERTICES)
    indices = document.add(triangles.ravel().astype(np.uint32), "SCALAR", INDICES)
    primitive = {"attributes": attributes, "indices": indices, "material": material}
    document.meshes.append({"name": name, "primitives": [primitive]})
    return node


def _add_target(document: _Document, base: PlyMesh, node: Int, frame: PlyMesh) -> None:
    """Add a frame as a morph target of the last mesh, whose vertices have these nodes in `base`."""
    moved = (frame.positions - base.positions)[node].astype("<f4")
    turned = drawn_normals(frame.positions, base.faces) - drawn_normals(base.positions, base.faces)
    target = {
        "POSITION": document.add(moved, "VEC3", VERTICES, bounds=True),
        "NORMAL": document.add(turned[node].astype("<f4"), "VEC3", VERTICES),
    }
    mesh = document.meshes[-1]
    mesh["primitives"][0].setdefault("targets", []).append(target)
    mesh.setdefault("weights", []).append(0.0)


def _split(faces: Int, corner_uv: Float | None, count: int) -> tuple[Int, Int, Float | None]:
    """Return the node, of `count`, of every vertex, faces into vertices, and their texture coordinates.

    A node at a seam, where corners have several, becomes several vertices.
    """
    if corner_uv is None:
        return np.arange(count, dtype=np.int32), faces, None
    rows = np.column_stack([faces.ravel().astype(np.float64), corner_uv.reshape(-1, 2)])
    unique, index = np.unique(rows, axis=0, return_inverse=True)
    return unique[:, 0].astype(np.int32), index.reshape(-1, 3).astype(np.int32), unique[:, 1:]


def _play(document: _Document, stretch: _Stretch, count: int, fps: float) -> None:
    """Show a mesh in its frames: its weights follow them, and its scale is zero in all others."""
    node = len(document.nodes)
    document.nodes.append({"name": document.meshes[stretch.mesh]["name"], "mesh": stretch.mesh})
    if stretch.length > 1:
        times = (stretch.first + np.arange(stretch.length)) / fps
        document.animate(node, "weights", times, np.eye(stretch.length)[:, 1:].ravel(), "LINEAR")
    if stretch.length < count:
        last = stretch.first + stretch.length
        keys = sorted({0, stretch.first, last} - {count})
        shown = np.array([float(stretch.first <= key < last) for key in keys])
        times = np.array(keys, float) / fps
        document.animate(node, "scale", times, np.repeat(shown[:, None], 3, axis=1), "STEP")


def _text(document: _Document, meshes: Sequence[MovingMesh]) -> bytes:
    """Return the JSON chunk, padded."""
    materials = [
        {
            "name": mesh.name,
            "doubleSided": mesh.double_sided,
            "pbrMetallicRoughness": {
                "baseColorFactor": [*mesh.colour, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9,
            },
        }
        for mesh in meshes
    ]  # fmt: skip
    content: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "toile"},
        "scene": 0,
        "scenes": [{"name": "dressed", "nodes": list(range(len(document.nodes)))}],
        "nodes": document.nodes,
        "meshes": document.meshes,
        "materials": materials,
        "accessors": document.accessors,
        "bufferViews": document.views,
        "buffers": [{"byteLength": document.length}],
    }
    if document.channels:
        content["animations"] = [
            {"name": "film", "samplers": document.samplers, "channels": document.channels}
        ]
    text = json.dumps(content, separators=(",", ":")).encode()
    return text + b" " * (-len(text) % 4)
