"""FreeSewing designs drafted to measurements by Node, an optional tool, with the design's own packages."""

import json
import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path

from toile.geometry.errors import InputError

_SCRIPT = Path(__file__).with_suffix(".mjs")
_NO_PACKAGE, _NO_MEASUREMENT = 3, 4
"""Exit codes of the script."""
SECONDS = 120


def draft_freesewing(design: str, measurements: Mapping[str, float], folder: Path) -> str:
    """Return the SVG of a design.

    Parameters
    ----------
    design
        Its name, such as "teagan".
    measurements
        FreeSewing's names to millimetres, and degrees.
    folder
        Where `npm install` has put the packages (the folder that holds node_modules).

    Raises
    ------
    InputError
        There is no node, a package or a measurement is missing, or the design cannot be drafted.
    """
    if not re.fullmatch(r"[a-z][a-z0-9]*", design):
        raise InputError(f"'{design}' is no FreeSewing design; write a name such as teagan", field="--draft")
    node = shutil.which("node")
    if node is None:
        raise InputError(
            f"drafting {design} needs Node.js 20 or later, which is not installed; install it, or draft on "
            "freesewing.eu and give toile the SVG",
            field="--draft",
        )
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump(dict(measurements), file)
        file.flush()
        done = subprocess.run(
            [node, "--input-type=module", "-e", _SCRIPT.read_text(encoding="utf-8"), "--", design, file.name],
            cwd=folder, capture_output=True, text=True, timeout=SECONDS, check=False,
        )  # fmt: skip
    said = done.stderr.strip().splitlines()
    if done.returncode == _NO_PACKAGE:
        raise InputError(
            f"drafting {design}: the package {said[-1]} is missing in {folder}; there, run "
            f"npm install --legacy-peer-deps {said[-1]}",
            field="--draft",
        )
    if done.returncode == _NO_MEASUREMENT:
        raise InputError(f"drafting {design} needs the measurements {said[-1]} [mm]", field="--measurements")
    if done.returncode or "<svg" not in done.stdout:
        reason = said[-1] if said else "it returned no drawing"
        raise InputError(
            f"drafting {design} failed: {reason}; check the measurements", field="--measurements"
        )
    # The date in the drawing would make the same input give different bytes.
    return re.sub(r"[A-Z][a-z]+day, [^<]*\d{4}", "", done.stdout)
