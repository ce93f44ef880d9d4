#!/bin/sh
# meshio 5.3.5: `meshio.read` ends the program where a file holds what it cannot read.
#
# Legacy VTK files of surfaces are mostly of the kind POLYDATA, which meshio does not know.
# One would expect: an exception, such as meshio's own ReadError, that a program can catch by `except Exception`.
# What happens: `read` calls `sys.exit(1)`: SystemExit is no `Exception`, and a program that reads a hundred files ends at the first.
#
# Output seen:
# raised SystemExit, an Exception: False, a ReadError: False
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" meshio==5.3.5 numpy==2.4.6
cd "$folder"
cat > triangle.vtk <<'END'
# vtk DataFile Version 3.0
one triangle
ASCII
DATASET POLYDATA
POINTS 3 float
0 0 0 1 0 0 0 1 0
POLYGONS 1 4
3 0 1 2
END
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - 2>warnings >said <<'END'
import meshio

try:
    meshio.read("triangle.vtk")
    raised = None
except BaseException as error:
    raised = error
with open("outcome", "w") as file:
    kinds = isinstance(raised, Exception), isinstance(raised, meshio.ReadError)
    print(f"raised {type(raised).__name__}, an Exception: {kinds[0]}, a ReadError: {kinds[1]}", file=file)
END
cat outcome
grep -q "raised SystemExit, an Exception: False" outcome
