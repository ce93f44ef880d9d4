"""The report as a file: JSON without dates, checked when it is read."""

import json
import math
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from toile.dressing.files.writers.atomic import write_atomic
from toile.geometry.errors import InputError
from toile.studies.speed_error.point import Bar, Chart, Point

FORMAT = "toile speed-error report 1"


@dataclass(frozen=True, kw_only=True)
class Report:
    """Charts, whether they are of the quick kind, and on what and with which versions they were measured."""

    quick: bool
    machine: dict[str, str]
    versions: dict[str, str]
    charts: tuple[Chart, ...]


def report_bytes(report: Report) -> bytes:
    """Return the report as indented JSON, numbers that are not finite as null."""
    return (
        json.dumps({"format": FORMAT} | _plain(asdict(report)), indent=1, allow_nan=False) + "\n"
    ).encode()


def write_report(path: Path, report: Report) -> None:
    """Write the report. Raises InputError where the file cannot be written."""
    try:
        write_atomic(path, report_bytes(report))
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise InputError(f"{path}: cannot be written ({reason}); choose another file") from None


def read_report(path: Path) -> Report:
    """Read a report. Raises InputError naming the file and what is wrong with it."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(
            f"{path}: there is no such report; make one with toile bench --json {path}"
        ) from None
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a stored report ({error})") from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise InputError(f"{path}: not a stored report (no format '{FORMAT}'); make one with toile bench")
    try:
        report: Report = _typed(Report, data, "report")
    except ValueError as error:
        raise InputError(f"{path}: {error}; make the report anew with toile bench") from None
    return report


NAMES = {"float": "a number", "int": "a whole number", "bool": "true or false", "str": "a text"}
"""Types as people know them."""
PARTS: dict[str, type] = {"charts": Chart, "points": Point, "bars": Bar}
"""Fields that hold tuples of parts."""


def _typed(kind: type, data: Any, where: str) -> Any:
    """Return a dataclass of plain data. Raises ValueError naming what does not fit."""
    if not isinstance(data, dict):
        raise ValueError(f"{where} must be a table")
    values = {}
    for entry in fields(kind):
        name = f"{where}: {entry.name}"
        if entry.name not in data:
            raise ValueError(f"{name} is missing")
        value = data[entry.name]
        if entry.name in PARTS:
            if not isinstance(value, list):
                raise ValueError(f"{name} must be a list")
            part = PARTS[entry.name]
            value = tuple(_typed(part, one, f"{name} {index}") for index, one in enumerate(value))
        else:
            value = _checked(getattr(entry.type, "__name__", str(entry.type)), value, name)
        values[entry.name] = value
    return kind(**values)


def _checked(kind: str, value: Any, name: str) -> Any:
    """Return a value of a field of a kind; null as infinity where a number is wanted."""
    if kind == "float" and value is None:
        return math.inf
    numeric = isinstance(value, int | float) and not isinstance(value, bool)
    fits = {
        "float": numeric,
        "int": isinstance(value, int) and not isinstance(value, bool),
        "bool": isinstance(value, bool),
        "str": isinstance(value, str),
    }.get(kind, isinstance(value, dict) and all(isinstance(one, str | int | float) for one in value.values()))
    if not fits:
        raise ValueError(f"{name} must be {NAMES.get(kind, 'a table of numbers or texts')}, got {value!r}")
    return value


def _plain(value: Any) -> Any:
    """Return a value as JSON holds it, in five digits: more than a time has."""
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, float):
        return float(f"{value:.5g}") if math.isfinite(value) else None
    return value
