#!/bin/sh
# trimesh 5.2.0: a skinned mesh is placed by its own node, so that the scale of an armature counts twice.
#
# What Blender writes for a character whose armature is scaled to a half: vertices of the scaled body, a bind matrix
# of twice the size, joint and mesh below the scaled node.
# One would expect: a square of side 0.5. Section 3.7.3.3 of the glTF 2.0 specification: only the joint transforms
# apply to a skinned mesh; the transform of its own node must be ignored. The joint's (0.5) times the bind matrix (2) is
# the identity.
# What happens: the vertices are scaled by the parent node once more.
#
# Output seen:
# side 0.25 (0.5 in the file, and in a viewer)
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

half = (np.frombuffer(corners, "<f4") / 2).astype("<f4").tobytes()
order = np.array([0, 1, 2, 0, 2, 3], "<u2").tobytes() + b"\0" * 4
joints = np.zeros((4, 4), "u1").tobytes()
weights = np.tile([1, 0, 0, 0], (4, 1)).astype("<f4").tobytes()
bind = np.diag([2, 2, 2, 1]).astype("<f4").tobytes()
parts = (half, order, joints, weights, bind)
starts = np.cumsum([0, *map(len, parts)]).tolist()
file = glb(
    {
        "scenes": [{"nodes": [0]}],
        "nodes": [{"scale": [0.5, 0.5, 0.5], "children": [1, 2]}, {}, {"mesh": 0, "skin": 0}],
        "skins": [{"joints": [1], "inverseBindMatrices": 4}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3}, "indices": 1}]}
        ],
        "accessors": [
            {**positions, "max": [0.5, 0.5, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5121, "count": 4, "type": "VEC4"},
            {"bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC4"},
            {"bufferView": 4, "componentType": 5126, "count": 1, "type": "MAT4"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": len(part)} for start, part in zip(starts, parts)
        ],
    },
    b"".join(parts),
)
side = float(trimesh.load_scene(file, file_type="glb", process=False).bounds[1, 0])
print(f"side {side} (0.5 in the file, and in a viewer)")
raise SystemExit(side != 0.25)
END
