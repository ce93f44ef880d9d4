#!/bin/sh
# trimesh 5.2.0: a concave polygon of OBJ gets another area for another first corner.
#
# An L of six corners, one face, area 3, written from each of its corners in turn.
# One would expect: area 3 six times; the order of the corners is the same, only the first one differs.
# What happens: polygons are split as fans from their first corner, which for four of the six lie outside the L.
#
# Output seen:
# areas [3.0, 4.0, 4.0, 3.0, 4.0, 4.0]
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" trimesh==5.2.0 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import io
import trimesh

ring = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
areas = []
for first in range(6):
    text = "".join(f"v {x} {y} 0\n" for x, y in ring)
    text += "f " + " ".join(str((first + k) % 6 + 1) for k in range(6)) + "\n"
    mesh = trimesh.load_mesh(io.BytesIO(text.encode()), file_type="obj", process=False)
    areas.append(round(float(mesh.area), 9))
print(f"areas {areas}")
raise SystemExit(areas != [3.0, 4.0, 4.0, 3.0, 4.0, 4.0])
END
