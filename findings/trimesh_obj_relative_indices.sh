#!/bin/sh
# trimesh 5.2.0: relative indices of OBJ count from the end of the file instead of from their own line.
#
# Two triangles, each behind its three vertices, each "f -3 -2 -1".
# One would expect: two triangles 10 m apart. The OBJ specification: -1 is the vertex that was defined last before the
# face.
# What happens: both faces get the last three vertices of the file: the same triangle twice, the other is gone.
#
# Output seen:
# faces [[0, 1, 2], [0, 1, 2]], x from 10.0 to 11.0
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" trimesh==5.2.0 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import io
import trimesh

text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 10 0 0\nv 11 0 0\nv 10 1 0\nf -3 -2 -1\n"
mesh = trimesh.load_mesh(io.BytesIO(text.encode()), file_type="obj", process=False)
low, high = float(mesh.vertices[:, 0].min()), float(mesh.vertices[:, 0].max())
print(f"faces {mesh.faces.tolist()}, x from {low} to {high}")
raise SystemExit((mesh.faces.tolist(), low, high) != ([[0, 1, 2], [0, 1, 2]], 10.0, 11.0))
END
