#!/bin/sh
# meshio 5.3.5: a file called .msh is written for ANSYS Fluent, not for Gmsh, and the data of its cells are gone.
#
# Gmsh's own files are called .msh, and meshio reads and writes them, with data of points and cells.
# One would expect: `Mesh.write("cloth.msh")` writes a Gmsh file, which keeps the numbers of its cells.
# What happens: it writes ANSYS' format of the same ending, without the data and without a warning; `file_format="gmsh"` does
# what one wants.
#
# Output seen:
# cloth.msh begins with '(1 "meshio 5.3.5")', cell data read back: []
# with file_format="gmsh": '$MeshFormat', cell data read back: ['panel']
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" meshio==5.3.5 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - 2>warnings <<'END'
import meshio

points = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
mesh = meshio.Mesh(points, [("triangle", [[0, 1, 2], [0, 2, 3]])], cell_data={"panel": [[5, 6]]})


def first_line() -> str:
    with open("cloth.msh", "rb") as file:
        return file.readline().decode().strip()


def kept() -> list[str]:
    return [name for name in meshio.read("cloth.msh").cell_data if not name.startswith("gmsh:")]


mesh.write("cloth.msh")
plain = first_line(), kept()
print(f"cloth.msh begins with {plain[0]!r}, cell data read back: {plain[1]}")
mesh.write("cloth.msh", file_format="gmsh")
named = first_line(), kept()
print(f'with file_format="gmsh": {named[0]!r}, cell data read back: {named[1]}')
raise SystemExit(plain != ('(1 "meshio 5.3.5")', []) or named != ("$MeshFormat", ["panel"]))
END
