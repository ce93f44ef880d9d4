"""Data of the 3-D view as scripts: the garments of a job, and each body once."""

import base64
import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.files.gltf.gltf_file import GltfFile
from toile.dressing.files.writers.atomic import write_atomic

STEPS = 65535
"""Steps of a coordinate over the size of a mesh: 0.03 mm on a body of 1.8 m."""
BODY = "body"
"""Name of the body's node in dressed.glb."""


def write_view(result: Path, place: Path, name: str) -> bool:
    """Write views/NAME.js, and the body it needs, from a result's dressed.glb; False if there is none."""
    source, view = result / "dressed.glb", place / "views" / f"{name}.js"
    if not source.is_file():
        return False
    if view.is_file() and view.stat().st_mtime_ns >= source.stat().st_mtime_ns:
        return True
    garments = []
    body = ""
    for part in parts_of(GltfFile(source)):
        if part["name"] != BODY:
            garments.append(part)
            continue
        content = json.dumps(part, separators=(",", ":"))
        body = hashlib.sha256(content.encode()).hexdigest()[:16]
        path = place / "bodies" / f"{body}.js"
        if not path.is_file():
            write_atomic(path, f"showBody({content});\n".encode())
    shown = {"name": name, "body": body, "garments": garments}
    write_atomic(view, f"showJob({json.dumps(shown, separators=(',', ':'))});\n".encode())
    return True


def parts_of(file: GltfFile) -> list[dict[str, Any]]:
    """Return the meshes of a GLB that toile wrote: name, colour, and arrays in base64.

    Positions are whole steps between `low` and `low + size` [m], normals 127ths.
    """
    parts = []
    for mesh in file.content["meshes"]:
        primitive = mesh["primitives"][0]
        positions = file.numbers(primitive["attributes"]["POSITION"], "VEC3")
        normals = file.numbers(primitive["attributes"]["NORMAL"], "VEC3")
        indices = file.numbers(primitive["indices"], "SCALAR").ravel()
        material = file.content["materials"][primitive["material"]]
        low, size = positions.min(axis=0), np.maximum(np.ptp(positions, axis=0), 1e-9)
        steps = np.rint((positions - low) / size * STEPS).astype("<u2")
        wide = len(positions) > STEPS
        parts.append(
            {
                "name": mesh["name"],
                "colour": material["pbrMetallicRoughness"]["baseColorFactor"][:3],
                "low": low.tolist(),
                "size": size.tolist(),
                "positions": _base64(steps.tobytes()),
                "normals": _base64(np.rint(127.0 * normals).astype("<i1").tobytes()),
                "indices": _base64(indices.astype("<u4" if wide else "<u2").tobytes()),
                "wide": wide,
            }
        )
    return parts


def _base64(content: bytes) -> str:
    """Return bytes as text."""
    return base64.b64encode(content).decode()
