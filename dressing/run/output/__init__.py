"""What a run keeps in its output folder: a lock, its state, its report's schema, what an earlier run left."""

import json
from pathlib import Path
from typing import Any


def report_schema() -> dict[str, Any]:
    """Return the JSON Schema of report.json."""
    text = (Path(__file__).resolve().parent / "report.schema.json").read_text(encoding="utf-8")
    schema: dict[str, Any] = json.loads(text)
    return schema
