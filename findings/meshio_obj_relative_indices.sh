#!/bin/sh
# meshio 5.3.5: relative indices of OBJ come out as negative numbers that address nothing.
#
# Two triangles, each behind its three vertices, each "f -3 -2 -1".
# One would expect: [[0, 1, 2], [3, 4, 5]], or an error.
# What happens: one is subtracted from every number, as from absolute ones; NumPy then takes -4 for the fourth point
# from the end, so that both triangles are the same wrong one, and nothing says so.
#
# Output seen:
# [[-4, -3, -2], [-4, -3, -2]]
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" meshio==5.3.5 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import meshio

with open("a.obj", "w") as file:
    file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 10 0 0\nv 11 0 0\nv 10 1 0\nf -3 -2 -1\n")
faces = meshio.read("a.obj").cells[0].data.tolist()
print(faces)
raise SystemExit(faces != [[-4, -3, -2], [-4, -3, -2]])
END
