#!/bin/sh
# trimesh 5.2.0: an extension that a glTF file lists in extensionsRequired is passed over in silence.
#
# One square that EXT_mesh_gpu_instancing shows twice, 10 m apart; the extension is required.
# One would expect: bounds 11 m wide, or an error: section 3.12 of the glTF 2.0 specification says of
# required extensions that they must be supported to load the file.
# What happens: one square, no error, no warning.
#
# Output seen:
# 1 instance, bounds [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]
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
shifts = np.array([[0, 0, 0], [10, 0, 0]], "<f4").tobytes()
name = "EXT_mesh_gpu_instancing"
file = glb(
    {
        "extensionsUsed": [name], "extensionsRequired": [name], "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "extensions": {name: {"attributes": {"TRANSLATION": 2}}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            positions, {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12},
            {"buffer": 0, "byteOffset": 60, "byteLength": 24},
        ],
    },
    corners + order + shifts,
)
scene = trimesh.load_scene(file, file_type="glb", process=False)
count = len(scene.graph.nodes_geometry)
print(f"{count} instance{'s' * (count != 1)}, bounds {scene.bounds.tolist()}")
raise SystemExit((count, scene.bounds.tolist()) != (1, [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]))
END
