#!/bin/sh
# trimesh 5.2.0: triangle fans of glTF are dropped without a word.
#
# A square is written as two triangles (mode 4), as a strip (mode 5) and as a fan (mode 6), all of them modes of
# section 3.7.2.1 of the glTF 2.0 specification.
# One would expect: area 1.0 three times, or an error that names the mode.
# What happens: the scene of the fan is empty, and loading it raises and warns of nothing.
#
# Output seen:
# mode 4: 1 mesh, area 1.0
# mode 5: 1 mesh, area 1.0
# mode 6: 0 meshes, area 0.0
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

found = []
for mode, order in ((4, [0, 1, 2, 0, 2, 3]), (5, [0, 1, 3, 2]), (6, [0, 1, 2, 3])):
    count = len(order)
    file = glb(
        {
            "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}]}],
            "accessors": [positions, {"bufferView": 1, "componentType": 5123, "count": count, "type": "SCALAR"}],
            "bufferViews": [
                {"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 2 * count},
            ],
        },
        corners + np.array(order, "<u2").tobytes(),
    )
    meshes = trimesh.load_scene(file, file_type="glb", process=False).geometry.values()
    found.append((len(meshes), sum(mesh.area for mesh in meshes)))
    plural = "mesh" if len(meshes) == 1 else "meshes"
    print(f"mode {mode}: {len(meshes)} {plural}, area {float(found[-1][1])}")
raise SystemExit(found != [(1, 1.0), (1, 1.0), (0, 0)])
END
