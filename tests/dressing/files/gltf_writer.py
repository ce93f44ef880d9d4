"""Writes small glTF files for tests, entry by entry."""

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

TYPES = {"<f4": 5126, "<u1": 5121, "<i1": 5120, "<u2": 5123, "<i2": 5122, "<u4": 5125}
CORNERS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


class Glb:
    """Writes a glTF file: entries of its JSON are added one by one, each answers its number."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.json: dict[str, Any] = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}

    def add(self, kind: str, **entry: Any) -> int:
        self.json.setdefault(kind, []).append(entry)
        return len(self.json[kind]) - 1

    def numbers(self, values: npt.ArrayLike, dtype: str = "<f4", **more: Any) -> int:
        """An accessor of its own bufferView, of the same number."""
        array = np.array(values, dtype)
        self.data += b"\0" * (-len(self.data) % 4)
        view = self.add("bufferViews", buffer=0, byteOffset=len(self.data), byteLength=array.nbytes)
        self.data += array.tobytes()
        kinds = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
        return self.add(
            "accessors",
            **{
                "bufferView": view,
                "componentType": TYPES[dtype],
                "count": len(array),
                "type": kinds[array.shape[1:]],
                **more,
            },
        )

    def mesh(self, points: npt.ArrayLike = CORNERS, faces: npt.ArrayLike = FACES, **more: Any) -> int:
        attributes = {"POSITION": self.numbers(points), **more.pop("attributes", {})}
        indices = self.numbers(np.ravel(faces), "<u2")
        return self.add("meshes", primitives=[{"attributes": attributes, "indices": indices, **more}])

    def node(self, *, root: bool = True, **entry: Any) -> int:
        number = self.add("nodes", **entry)
        if root:
            self.json["scenes"][0]["nodes"].append(number)
        return number

    def animate(
        self, node: int, path: str, times: npt.ArrayLike, values: npt.ArrayLike, way: str | None = "LINEAR",
        dtype: str = "<f4",
    ) -> None:  # fmt: skip
        """A channel of the first animation."""
        if "animations" not in self.json:
            self.add("animations", name="walk", channels=[], samplers=[])
        animation = self.json["animations"][0]
        sampler: dict[str, Any] = {"input": self.numbers(times)}
        sampler["output"] = self.numbers(values, dtype, normalized=dtype != "<f4")
        animation["samplers"].append(sampler if way is None else {**sampler, "interpolation": way})
        channel = {"sampler": len(animation["samplers"]) - 1, "target": {"node": node, "path": path}}
        animation["channels"].append(channel)

    def write(self, path: Path) -> Path:
        """A .glb with a binary chunk, or a .gltf with what is in `uri`, or all in itself."""
        buffer: dict[str, Any] = {"byteLength": len(self.data)}
        if path.suffix == ".gltf":
            uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
            buffer["uri"] = self.json.get("uri", uri)
        text = json.dumps({"buffers": [buffer], **self.json}).encode()
        if path.suffix == ".gltf":
            path.write_bytes(text)
            return path
        text += b" " * (-len(text) % 4)
        data = bytes(self.data) + b"\0" * (-len(self.data) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
        return path
