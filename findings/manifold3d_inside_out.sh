#!/bin/sh
# manifold3d 3.5.4: the union with a solid turned inside out is what the two have in common, with status NoError.
#
# A unit cube and another moved by a half and two quarters: they share 0.28125, together they fill 1.71875. The same with
# the faces of the first turned over, as in bodies that were mirrored in a modelling program.
# One would expect: a status other than NoError for a closed surface that looks inwards, or the same union.
# What happens: it counts as a solid of volume -1, and uniting keeps only what lies in both cubes.
#
# Output seen:
# outwards: NoError, volume 1.0, union 1.71875
# inwards: NoError, volume -1.0, union 0.28125
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" manifold3d==3.5.4 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import manifold3d
import numpy as np

corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float32)
faces = np.array(
    [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
     (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)], np.uint32
)  # fmt: skip

def cube(order):
    return manifold3d.Manifold(manifold3d.Mesh(vert_properties=corners, tri_verts=np.ascontiguousarray(order)))

other = cube(faces).translate([0.5, 0.25, 0.25])
found = []
for name, order in (("outwards", faces), ("inwards", faces[:, ::-1])):
    solid = cube(order)
    union = solid + other
    found.append((solid.status().name, round(solid.volume(), 6), union.status().name, round(union.volume(), 6)))
    print(f"{name}: {found[-1][0]}, volume {found[-1][1]}, union {found[-1][3]}")
raise SystemExit(found != [("NoError", 1.0, "NoError", 1.71875), ("NoError", -1.0, "NoError", 0.28125)])
END
