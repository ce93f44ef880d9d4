"""Data of the 3-D views as scripts: a page that is opened from disk may load those, but no other files."""

import json
from pathlib import Path

from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.view.result_folder import facts_of_folder, view_of_folder
from toile.dressing.view.view_page import packed_view


def write_view(result: Path, place: Path, name: str) -> bool:
    """Write views/NAME.js from a result's dressed.glb; False if there is none."""
    source, view = result / "dressed.glb", place / "views" / f"{name}.js"
    if not source.is_file():
        return False
    if view.is_file() and view.stat().st_mtime_ns >= source.stat().st_mtime_ns:
        return True
    header, numbers = packed_view(name, view_of_folder(result), facts_of_folder(result))
    write_atomic(view, f"showJob({header}, {json.dumps(numbers)});\n".encode())
    return True
