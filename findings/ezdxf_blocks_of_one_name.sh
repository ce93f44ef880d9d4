#!/bin/sh
# ezdxf 1.4.5: blocks of one name in a DXF become one block that holds the lines of all, and the audit finds nothing.
#
# Pattern files (DXF-AAMA) hold a block for each piece and size; some programs give the sizes of a piece one name.
# One would expect: both blocks, or an error, or at least a note of `Drawing.audit`.
# What happens: the block holds the outline of both sizes, each line of its own size, without a word.
#
# Output seen:
# blocks in the file: 2, in the drawing: 1
# FRONT holds lines to [1.0, 2.0], audit: 0 errors, 0 fixes
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" ezdxf==1.4.5
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import ezdxf


def block(name: str, width: int) -> str:
    line = f"0\nLINE\n8\n1\n10\n0\n20\n0\n11\n{width}\n21\n0\n"
    return f"0\nBLOCK\n8\n0\n2\n{name}\n70\n0\n10\n0\n20\n0\n3\n{name}\n{line}0\nENDBLK\n8\n0\n"


blocks = block("FRONT", 1) + block("FRONT", 2)
insert = "0\nINSERT\n8\n1\n2\nFRONT\n10\n0\n20\n0\n"
with open("tee.dxf", "w") as file:
    file.write(f"0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{insert}0\nENDSEC\n0\nEOF\n")
drawing = ezdxf.readfile("tee.dxf")
pieces = [each for each in drawing.blocks if not each.name.startswith("*")]
print(f"blocks in the file: {blocks.count('ENDBLK')}, in the drawing: {len(pieces)}")
ends = [line.dxf.end.x for line in pieces[0]]
audit = drawing.audit()
print(f"{pieces[0].name} holds lines to {ends}, audit: {len(audit.errors)} errors, {len(audit.fixes)} fixes")
raise SystemExit(len(pieces) != 1 or ends != [1.0, 2.0] or bool(audit.errors or audit.fixes))
END
