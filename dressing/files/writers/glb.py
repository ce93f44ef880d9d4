"""Binary glTF 2.0: named nodes with positions, normals, texture coordinates and one colour each."""

import json
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from toile.geometry.arrays import Float, Int

FLOAT, UNSIGNED_INT = 5126, 5125
VERTICES, INDICES = 34962, 34963
"""Constants of the glTF 2.0 specification (component types and buffer targets)."""


@dataclass(frozen=True, kw_only=True)
class GlbMesh:
    """One node of the file.

    Attributes
    ----------
    name
        Name of the node, mesh and material.
    positions, normals
        Vertices [m], Y up, and their unit normals, shape (n, 3).
    faces
        Triangles, shape (t, 3).
    colour
        Linear red, green and blue in 0..1.
    uv
        Texture coordinates, v upwards, shape (n, 2), or None.
    double_sided
        True for cloth, which is seen from both sides.
    fields
        Further values of vertices, shape (n,), by their names: attributes such as _PRESSURE_PA.
    vertex_colours
        Linear red, green and blue in 0..1, shape (n, 3), that replace the colour; or None.
    shapes
        Shapes of a film, as far as vertices are from `positions` [m], each of shape (n, 3); none of a still.
    way
        How far the whole is at the times of a film [m], shape (f, 3), or None.
    """

    name: str
    positions: Float
    normals: Float
    faces: Int
    colour: tuple[float, float, float]
    uv: Float | None = None
    double_sided: bool = False
    fields: Mapping[str, Float] = field(default_factory=dict)
    vertex_colours: Float | None = None
    shapes: Sequence[Float] = ()
    way: Float | None = None


class _Buffer:
    """The binary chunk, its views and accessors."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, array: npt.NDArray[Any], kind: str, target: int | None, *, bounds: bool = False) -> int:
        """Append an array of 4-byte numbers and return its accessor's index."""
        component = UNSIGNED_INT if array.dtype == np.uint32 else FLOAT
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": array.nbytes}
        if target is not None:
            view["target"] = target
        accessor: dict[str, Any] = {
            "bufferView": len(self.views),
            "componentType": component,
            "count": len(array),
            "type": kind,
        }
        if bounds:
            low, high = np.atleast_1d(array.min(axis=0)), np.atleast_1d(array.max(axis=0))
            accessor |= {"min": low.tolist(), "max": high.tolist()}
        self.data += array.tobytes()
        self.views.append(view)
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def glb_bytes(meshes: Sequence[GlbMesh], times: Float | None = None) -> bytes:
    """Return a GLB file with one node per mesh; with the times [s], shape (f,), of their shapes and ways."""
    buffer = _Buffer()
    gltf_meshes = []
    for index, mesh in enumerate(meshes):
        attributes = {
            "POSITION": buffer.add(mesh.positions.astype("<f4"), "VEC3", VERTICES, bounds=True),
            "NORMAL": buffer.add(mesh.normals.astype("<f4"), "VEC3", VERTICES),
        }
        if mesh.uv is not None:
            # glTF counts v downwards.
            flipped = np.column_stack([mesh.uv[:, 0], 1.0 - mesh.uv[:, 1]]).astype("<f4")
            attributes["TEXCOORD_0"] = buffer.add(flipped, "VEC2", VERTICES)
        if mesh.vertex_colours is not None:
            attributes["COLOR_0"] = buffer.add(mesh.vertex_colours.astype("<f4"), "VEC3", VERTICES)
        for name, values in mesh.fields.items():
            attributes[f"_{name.upper()}"] = buffer.add(values.astype("<f4"), "SCALAR", VERTICES)
        indices = buffer.add(mesh.faces.ravel().astype(np.uint32), "SCALAR", INDICES)
        primitive: dict[str, Any] = {"attributes": attributes, "indices": indices, "material": index}
        if mesh.shapes:
            primitive["targets"] = [
                {"POSITION": buffer.add(shape.astype("<f4"), "VEC3", VERTICES, bounds=True)}
                for shape in mesh.shapes
            ]
        gltf_meshes.append({"name": mesh.name, "primitives": [primitive]})
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "toile"},
        "scene": 0,
        "scenes": [{"name": "dressed", "nodes": list(range(len(meshes)))}],
        "nodes": [{"name": mesh.name, "mesh": index} for index, mesh in enumerate(meshes)],
        "meshes": gltf_meshes,
        "materials": [_material(mesh) for mesh in meshes],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.data)}],
    }
    if times is not None:
        # Adds accessors to the buffer that the document lists.
        document["animations"] = [_animation(meshes, times, buffer)]
        document["buffers"] = [{"byteLength": len(buffer.data)}]
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    total = 12 + 8 + len(text) + 8 + len(buffer.data)
    return b"".join(
        [
            struct.pack("<4sII", b"glTF", 2, total),
            struct.pack("<I4s", len(text), b"JSON"),
            text,
            struct.pack("<I4s", len(buffer.data), b"BIN\0"),
            bytes(buffer.data),
        ]
    )


def _animation(meshes: Sequence[GlbMesh], times: Float, buffer: _Buffer) -> dict[str, Any]:
    """Return the animation that shows the shapes one after another, and moves what has a way."""
    at = buffer.add(times.astype("<f4"), "SCALAR", None, bounds=True)
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []
    for index, mesh in enumerate(meshes):
        outputs = {}
        if mesh.shapes:
            weights = np.eye(len(times), dtype="<f4").ravel()
            outputs["weights"] = buffer.add(weights, "SCALAR", None)
        if mesh.way is not None:
            outputs["translation"] = buffer.add(mesh.way.astype("<f4"), "VEC3", None)
        for path, output in outputs.items():
            channels.append({"sampler": len(samplers), "target": {"node": index, "path": path}})
            samplers.append({"input": at, "output": output, "interpolation": "LINEAR"})
    return {"name": "film", "samplers": samplers, "channels": channels}


def _material(mesh: GlbMesh) -> dict[str, Any]:
    """Return a dull, rough material of the mesh's colour; white where its vertices have their own."""
    colour = mesh.colour if mesh.vertex_colours is None else (1.0, 1.0, 1.0)
    return {
        "name": mesh.name,
        "doubleSided": mesh.double_sided,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*colour, 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.9,
        },
    }
