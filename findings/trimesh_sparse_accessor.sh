#!/bin/sh
# trimesh 5.2.0: sparse accessors of glTF are read without their replacements, and nothing says so.
#
# A square whose third corner is moved to (5, 5, 0) by the sparse part of its POSITION accessor (section 3.6.2.3 of
# the glTF 2.0 specification, a core feature; exporters use it for morph targets and edited meshes).
# One would expect: bounds from 0 to 5.
# What happens: the values below the sparse part are read, although accessor.max says 5, too.
#
# Output seen:
# bounds [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]], accessor.max [5, 5, 0]
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" trimesh==5.2.0 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import io, json, struct
import numpy as np
import trimesh

def glb(doc, data):
    """A GLB file of a document and its binary chunk."""
    doc = {"asset": {"version": "2.0"}, "scene": 0, **doc, "buffers": [{"byteLength": len(data)}]}
    text = json.dumps(doc).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return io.BytesIO(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)

corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "<f4").tobytes()
positions = {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}

order = np.array([0, 1, 2, 0, 2, 3], "<u2").tobytes()
moved = np.array([2, 0], "<u2").tobytes() + np.array([[5, 5, 0]], "<f4").tobytes()
sparse = {
    "count": 1,
    "indices": {"bufferView": 2, "componentType": 5123},
    "values": {"bufferView": 3},
}
file = glb(
    {
        "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {**positions, "max": [5, 5, 0], "sparse": sparse},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12},
            {"buffer": 0, "byteOffset": 60, "byteLength": 2}, {"buffer": 0, "byteOffset": 64, "byteLength": 12},
        ],
    },
    corners + order + moved,
)
bounds = trimesh.load_mesh(file, file_type="glb", process=False).bounds.tolist()
print(f"bounds {bounds}, accessor.max [5, 5, 0]")
raise SystemExit(bounds != [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]])
END
