#!/bin/sh
# meshio 5.3.5: texture coordinates of OBJ go to vertices by their order in the file; what faces say is not read.
#
# A triangle "f 1/3 2/2 3/1", and a square with a seam, whose six texture coordinates belong to four vertices.
# One would expect: vertex 1 with the third texture coordinate (1, 0); for the square coordinates per corner, or none.
# What happens: vertex 1 gets the first one in the file, silently. The square is refused, as are all files with another
# number of texture coordinates or normals than of vertices: any garment with texture seams.
#
# Output seen:
# vertex 1: (0.0, 1.0), its corner says (1.0, 0.0)
# seam: ValueError: len(points) = 4, but len(point_data["obj:vt"]) = 6
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" meshio==5.3.5 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
from pathlib import Path
import meshio

square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
Path("triangle.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 1\nvt 0 0\nvt 1 0\nf 1/3 2/2 3/1\n")
Path("seam.obj").write_text(
    square + "vt 0 0\nvt 1 0\nvt 1 1\nvt 5 5\nvt 6 6\nvt 5 6\nf 1/1 2/2 3/3\nf 1/4 3/5 4/6\n"
)
first = tuple(meshio.read("triangle.obj").point_data["obj:vt"][0].tolist())
print(f"vertex 1: {first}, its corner says (1.0, 0.0)")
try:
    said = f"read: {meshio.read('seam.obj')}"
except ValueError as error:
    said = f"ValueError: {error}"
print(f"seam: {said}")
expected = 'ValueError: len(points) = 4, but len(point_data["obj:vt"]) = 6'
raise SystemExit((first, said) != ((0.0, 1.0), expected))
END
