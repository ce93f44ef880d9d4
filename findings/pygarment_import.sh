#!/bin/sh
# pygarment 2.0.2: the package of GarmentCode holds no package pygarment, which its own files import.
#
# Installed without its dependencies, which are not needed to look for a name.
# One would expect: "import pygarment" finds it, as the modules themselves expect.
# What happens: the wheel lays four packages of other names at the top level, one of them called "pattern"; the modules
# in them import pygarment, which is not there.
#
# Output seen:
# at the top: ['garmentcode', 'mayaqltools', 'meshgen', 'pattern']; pygarment found: False; modules that import it: 20
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" --no-deps pygarment==2.0.2
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import importlib.util
import re
from pathlib import Path

site = Path("site")
packages = sorted(path.name for path in site.iterdir() if path.is_dir() and any(path.glob("*.py")))
found = importlib.util.find_spec("pygarment") is not None
needy = sum(
    bool(re.search(r"^\s*(?:from|import) pygarment\b", path.read_text(encoding="utf-8"), re.MULTILINE))
    for path in site.rglob("*.py")
)
print(f"at the top: {packages}; pygarment found: {found}; modules that import it: {needy}")
raise SystemExit((packages, found, needy) != (["garmentcode", "mayaqltools", "meshgen", "pattern"], False, 20))
END
