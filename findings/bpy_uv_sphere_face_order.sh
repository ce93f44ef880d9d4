#!/bin/sh
# bpy 4.5.15: primitive_uv_sphere_add gives its faces in another order in every process.
#
# The same call makes a sphere of 8 segments and 6 rings in four fresh processes; so does primitive_ico_sphere_add. A cloth
# solver that visits faces in their order, as most do, then drapes over another mesh each time the script is run.
# One would expect: the same mesh from the same call, as every other primitive gives it.
# What happens: vertices and faces are the same, but the UV sphere's faces stand in another order each time.
#
# Output seen:
# uv sphere: same vertices True, same faces True, same order False
# ico sphere: same vertices True, same faces True, same order True
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" bpy==4.5.15
cd "$folder"
cat > sphere.py <<'END'
import json
import sys

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
if sys.argv[1] == "uv":
    bpy.ops.mesh.primitive_uv_sphere_add(segments=8, ring_count=6)
else:
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2)
mesh = bpy.context.active_object.data
vertices = [[round(c, 6) for c in vertex.co] for vertex in mesh.vertices]
json.dump([vertices, [list(face.vertices) for face in mesh.polygons]], open(sys.argv[2], "w"))
END
for kind in uv ico; do
    for run in 1 2 3 4; do
        PYTHONPATH="$folder/site" "${PYTHON:-python3}" sphere.py $kind $kind$run.json > /dev/null
    done
done
"${PYTHON:-python3}" - <<'END'
import json

told = []
for kind in ("uv", "ico"):
    vertices, faces = zip(*(json.load(open(f"{kind}{run}.json")) for run in (1, 2, 3, 4)))
    whole = [sorted(map(sorted, own)) for own in faces]
    told.append([all(one == many[0] for one in many) for many in (vertices, whole, faces)])
    print(f"{kind} sphere: same vertices {told[-1][0]}, same faces {told[-1][1]}, same order {told[-1][2]}")
raise SystemExit(told != [[True, True, False], [True, True, True]])
END
