"""Write a batch's pages: index.html, summary.html, view.html, and the data they show."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from toile.dressing.batch.gallery.summary import Summary
from toile.dressing.batch.gallery.view_file import write_view
from toile.dressing.batch.job_folder import LOGS, RESULTS
from toile.dressing.batch.ledger import rows
from toile.dressing.files.writers.atomic import replacing, writable_folder
from toile.dressing.view.view_page import SCRIPTS, static

NAME = "gallery"
STATIC = Path(__file__).resolve().parent / "static"
SHOWN = (
    "name", "state", "failure_class", "message", "status", "avatar", "garments", "fabrics", "quality",
    "cpu_seconds", "strain_p99", "faces", "avatar_intersections", "self_intersections", "min_gap_mm",
)  # fmt: skip
"""Columns of the ledger that the pages get."""


def write_gallery(folder: Path, progress: Callable[[int], None] | None = None) -> Path:
    """Write the pages of a batch into its folder and return the first one.

    `progress` is called with the number of jobs written so far. What is there already and still fits is left
    as it is, so that a running batch can be looked at again and again. Raises InputError if the folder
    holds no batch.
    """
    table = rows(folder)
    first = next(table, None)
    place = writable_folder(folder / NAME)
    (place / "views").mkdir(exist_ok=True)
    for page in STATIC.iterdir():
        shutil.copyfile(page, place / page.name)
    for name in (*SCRIPTS, "viewer.css"):
        (place / name).write_text(static(name), encoding="utf-8")
    view = (place / "view.html").read_text(encoding="utf-8")
    (place / "view.html").write_text(view.replace("VIEWER", static("viewer.html")), encoding="utf-8")
    summary = Summary()
    # The data are scripts: a page that is opened from disk may load those, but no other files.
    with replacing(place / "jobs.js") as temporary, open(temporary, "w", encoding="utf-8") as data:
        data.write(f"const COLUMNS = {json.dumps([*SHOWN, 'view', 'log'])};\nconst JOBS = [\n")
        row, count = first, 0
        while row is not None:
            shown = [_rounded(row[column]) for column in SHOWN]
            seen = write_view(folder / RESULTS / row["name"], place, row["name"])
            logged = (folder / LOGS / f"{row['name']}.txt").is_file()
            data.write(json.dumps([*shown, seen, logged], separators=(",", ":")) + ",\n")
            summary.add(row)
            count += 1
            if progress is not None:
                progress(count)
            row = next(table, None)
        data.write("];\n")
    with replacing(place / "summary.html") as temporary:
        temporary.write_text(summary.page(folder.absolute().name), encoding="utf-8")
    return place / "index.html"


def _rounded(value: Any) -> Any:
    """Return a number with as many digits as anyone looks at."""
    return float(f"{value:.4g}") if isinstance(value, float) else value
