#!/bin/sh
# trimesh 5.2.0: a binary PLY of quads and triangles, which is what Blender writes, cannot be read.
#
# A quad and a triangle in one binary file; the same in text is read.
# One would expect: area 1.5 from both.
# What happens: every row of a list is taken to be as long as the first, and the length of the file does not fit.
#
# Output seen:
# text: area 1.5
# binary: ValueError: PLY is unexpected length!
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" trimesh==5.2.0 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import io
import struct
import trimesh

header = (
    "ply\nformat {} 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
)
points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0)]
faces = [(0, 1, 2, 3), (1, 4, 2)]
rows = points + [(len(face), *face) for face in faces]
text = header.format("ascii") + "".join(" ".join(map(str, row)) + "\n" for row in rows)
binary = header.format("binary_little_endian").encode()
binary += b"".join(struct.pack("<3f", *point) for point in points)
binary += b"".join(struct.pack(f"<B{len(face)}i", len(face), *face) for face in faces)
found = []
for name, data in (("text", text.encode()), ("binary", binary)):
    try:
        found.append(f"area {float(trimesh.load_mesh(io.BytesIO(data), file_type='ply', process=False).area)}")
    except Exception as error:
        found.append(f"{type(error).__name__}: {error}")
    print(f"{name}: {found[-1]}")
raise SystemExit(found != ["area 1.5", "ValueError: PLY is unexpected length!"])
END
