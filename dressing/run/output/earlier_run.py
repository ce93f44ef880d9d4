"""What an earlier run has left in an output folder."""

import json
import re
from collections.abc import Iterable
from pathlib import Path

from toile.dressing.files.writers.field_mesh import FORMATS

REPORT = "report.json"
FRAMES, FILM, MOVING = "frames", "dressed.usdc", "moving.glb"
"""Names in the output folder of the frames of a film, and of the files that hold them all."""
FRAME_FILE = re.compile(r".+\.\d{4,}\.ply")
"""Names of the files of frames."""
SHAPES = (".ply", ".obj", ".mdd", ".pc2", *(f".{kind}" for kind in FORMATS), ".h5")
"""Ends of the names of files of garments."""


def garments_of_report(folder: Path) -> tuple[str, ...]:
    """Return the names of the garments of the report in a folder; none if there is no readable one."""
    try:
        report = json.loads((folder / REPORT).read_bytes())
        return tuple(str(garment["name"]) for garment in report["garments"])
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return ()


def remove_earlier_run(folder: Path, garments: Iterable[str] = ()) -> None:
    """Remove what an earlier run wrote, the report first, and nothing else.

    Files of garments are those of the names in its report, and of `garments`.
    """
    from toile.dressing.run.result import file_stem

    stems = dict.fromkeys(file_stem(name) for name in (*garments_of_report(folder), *garments))
    for name in (REPORT, "dressed.glb", "preview.png", "view.html", FILM, MOVING):
        (folder / name).unlink(missing_ok=True)
    for stem in stems:
        for end in SHAPES:
            (folder / f"{stem}{end}").unlink(missing_ok=True)
    frames = folder / FRAMES
    if frames.is_dir():
        for path in list(frames.iterdir()):
            if FRAME_FILE.fullmatch(path.name):
                path.unlink()
        if not any(frames.iterdir()):
            frames.rmdir()
