"""Reads fit.json."""

import json
from pathlib import Path
from typing import Any

from toile.geometry.errors import InputError

TABLES = "fit.json"
"""Name in the output folder."""


def read_fit(folder: Path) -> dict[str, Any]:
    """Return the tables of a fit in a result's folder. Raises InputError if there are none."""
    path = folder / TABLES
    try:
        tables = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(
            f"{path}: there is no fit here; make one with toile dress --fit -o {folder}", file=path
        ) from None
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a fit ({error})", file=path) from None
    if not isinstance(tables, dict) or not {"findings", "garments", "body"} <= tables.keys():
        raise InputError(f"{path}: holds no fit of toile; make it again with toile dress --fit", file=path)
    return tables
