#!/bin/sh
# svgpathtools 1.8.0: svg2paths leaves out transforms, and draws what <defs> only defines.
#
# A pattern drawn in centimetres: one piece of 4 cm x 5 cm in a group that is scaled to millimetres and moved, and a
# notch symbol in <defs> that nothing uses.
# One would expect: one path, 40 by 50 and moved by 100, as in every viewer, or a warning that transforms are not applied.
# What happens: two paths, one of 4 by 5 at the origin. The class Document of the same package applies transforms and
# leaves out <defs>.
#
# Output seen:
# svg2paths: [(0.0, 4.0, 0.0, 5.0), (0.0, 9.0, 0.0, 0.0)]
# Document: [(100.0, 140.0, 0.0, 50.0)]
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" svgpathtools==1.8.0 svgwrite==1.4.3 scipy==1.17.1 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
from pathlib import Path
import svgpathtools

Path("pattern.svg").write_text(
    '<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="100mm" viewBox="0 0 200 100">'
    '<defs><path id="notch" d="M0,0 L9,0"/></defs>'
    '<g transform="translate(100,0) scale(10)"><path d="M0,0 L4,0 L4,5 L0,5 Z"/></g></svg>'
)
paths, _ = svgpathtools.svg2paths("pattern.svg")
boxes = sorted(tuple(map(float, path.bbox())) for path in paths)
seen = [tuple(map(float, path.bbox())) for path in svgpathtools.Document("pattern.svg").paths()]
print(f"svg2paths: {boxes}")
print(f"Document: {seen}")
raise SystemExit((boxes, seen) != ([(0.0, 4.0, 0.0, 5.0), (0.0, 9.0, 0.0, 0.0)], [(100.0, 140.0, 0.0, 50.0)]))
END
