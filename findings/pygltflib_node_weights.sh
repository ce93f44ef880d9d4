#!/bin/sh
# pygltflib 1.16.5: the morph weights of a node are lost when a glTF file is loaded and saved.
#
# Two nodes show one mesh with a morph target, the second with weights of its own: what makes a body stout (glTF 2.0,
# section 5.25 node, property weights: a core feature; they take the place of those of the mesh).
# One would expect: the weights in the file that is saved, or an error.
# What happens: the class of nodes has no such member; the weights are gone without a word, and both bodies are the same.
#
# Output seen:
# loaded [0.75], saved None
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" pygltflib==1.16.5 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import json
from pathlib import Path
import numpy as np
import pygltflib

corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4")
Path("data.bin").write_bytes(corners.tobytes() + (corners * 0 + [0, 0, 1]).astype("<f4").tobytes())
accessor = {"componentType": 5126, "count": 3, "type": "VEC3"}
document = {
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"mesh": 0}, {"mesh": 0, "weights": [0.75]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}]}], "weights": [0.0]}],
    "accessors": [
        {**accessor, "bufferView": 0, "min": [0, 0, 0], "max": [1, 1, 0]},
        {**accessor, "bufferView": 1, "min": [0, 0, 1], "max": [0, 0, 1]},
    ],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 36}],
    "buffers": [{"byteLength": 72, "uri": "data.bin"}],
}
Path("two.gltf").write_text(json.dumps(document))
pygltflib.GLTF2().load("two.gltf").save("saved.gltf")
before, after = (json.loads(Path(name).read_text())["nodes"][1].get("weights") for name in ("two.gltf", "saved.gltf"))
print(f"loaded {before}, saved {after}")
raise SystemExit((before, after) != ([0.75], None))
END
