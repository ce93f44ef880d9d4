"""Jobs from a file: a CSV table, or JSON objects one per line."""

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from toile.dressing.batch.job import BadJob, Job, job_name
from toile.dressing.files.parse_text import parse_json
from toile.dressing.files.suggestion import unknown_name
from toile.dressing.run.scene_file import SCENE_KEYS, scene_of_line
from toile.geometry.errors import InputError

AVATAR_KEYS = tuple(key for key in SCENE_KEYS["avatar"] if key != "file")
SCENE_COLUMNS = ("quality", "edge_length", "remesh", "max_frames", "gravity", "friction")
COLUMNS = ("name", "avatar", "garment", "fabric", *SCENE_COLUMNS, *AVATAR_KEYS)
"""Columns of a CSV file; of JSON objects they are keys, beside all keys of a scene file."""
FORMATS = (".csv", ".jsonl")


Row = dict[str, Any]
"""A job by columns or keys."""


class JobsFile:
    """The jobs of a file, read anew each time they are gone through; checked as a whole when opened."""

    def __init__(self, path: Path, defaults: Mapping[str, Any]) -> None:
        """Check all jobs.

        `defaults` are values of columns where a job has none. A line that is at fault is a BadJob, and the
        others are jobs. Raises InputError naming the file if it cannot be read, or if all lines are at fault.
        """
        self._path, self._defaults = path, dict(defaults)
        if path.suffix.lower() not in FORMATS:
            raise InputError(f"{path}: unknown kind of jobs file; use one of {', '.join(FORMATS)}", file=path)
        lines = good = 0
        first: InputError | None = None
        for _, job in self._jobs():
            lines += 1
            good += isinstance(job, Job)
            if isinstance(job, InputError):
                first = first or job
        if first is not None and not good:
            raise first
        if not lines:
            raise InputError(f"{path}: holds no jobs", file=path)
        self._count = lines

    def __len__(self) -> int:
        """Return the number of jobs."""
        return self._count

    def __iter__(self) -> Iterator[Job | BadJob]:
        """Go through the jobs."""
        for line, job in self._jobs():
            yield BadJob(f"line_{line}", str(job)) if isinstance(job, InputError) else job

    def _jobs(self) -> Iterator[tuple[int, Job | InputError]]:
        """Yield every job with its line, or what is wrong with the line."""
        first: dict[str, int] = {}
        for line, row in self._rows():
            try:
                job = self._job(line, row) if not isinstance(row, InputError) else row
            except InputError as error:
                where = f"{self._path}, line {line}"
                job = (
                    error
                    if where in str(error)
                    else InputError(
                        str(error).replace(str(self._path), where), file=self._path, field=error.field
                    )
                )
            if isinstance(job, Job) and first.setdefault(job.name, line) != line:
                job = InputError(
                    f"{self._path}, line {line}: job '{job.name}' appears twice, first in line "
                    f"{first[job.name]}; give each a name of its own",
                    file=self._path,
                    field="name",
                )
            yield line, job

    def _rows(self) -> Iterator[tuple[int, "Row | InputError"]]:
        """Yield every row with its line, or what is wrong with the line."""
        try:
            with open(self._path, newline="", encoding="utf-8-sig") as file:
                yield from self._csv(file) if self._path.suffix.lower() == ".csv" else self._json(file)
        except FileNotFoundError:
            raise InputError(
                f"{self._path}: there is no such jobs file; check the path", file=self._path
            ) from None
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise InputError(
                f"{self._path}: cannot be read as a jobs file ({error})", file=self._path
            ) from None

    def _csv(self, file: Any) -> Iterator[tuple[int, Row | InputError]]:
        """Yield the rows of a table, numbers as numbers, empty cells left out."""
        reader = csv.DictReader(file, skipinitialspace=True)
        for column in reader.fieldnames or ():
            if column not in COLUMNS:
                raise InputError(
                    f"{self._path}, line 1: {unknown_name('column', column, COLUMNS)}",
                    file=self._path,
                    field=column,
                )
        columns = list(reader.fieldnames or ())
        if len(set(columns)) < len(columns):
            twice = next(column for column in columns if columns.count(column) > 1)
            raise InputError(
                f"{self._path}, line 1: column '{twice}' appears twice", file=self._path, field=twice
            )
        for row in reader:
            line = reader.line_num
            try:
                yield line, self._cells(line, row)
            except InputError as error:
                yield line, error

    def _cells(self, line: int, row: Mapping[str, Any]) -> Row:
        """Return the cells of a row that are not empty, as what their columns hold."""
        if None in row or None in row.values():
            raise InputError(
                f"{self._path}, line {line}: has a different number of cells than line 1 has columns",
                file=self._path,
            )
        filled = {column: cell.strip() for column, cell in row.items() if cell.strip()}
        return {column: self._value(line, column, cell) for column, cell in filled.items()}

    def _value(self, line: int, column: str, cell: str) -> Any:
        """Return a cell as what its column holds."""
        kind = (SCENE_KEYS[""] | SCENE_KEYS["avatar"]).get(column, (str, ""))[0]
        if kind is str or column in ("avatar", "garment", "fabric", "measurements"):
            return cell
        if kind is list:
            return [name.strip() for name in cell.split(";")]
        if cell.lower() in ("true", "false"):
            return cell.lower() == "true"
        try:
            return int(cell) if kind is int else float(cell)
        except ValueError:
            if isinstance(kind, tuple) and str in kind:
                return cell
            raise InputError(
                f"{self._path}, line {line}: {column} must be a number, got '{cell}'",
                file=self._path,
                field=column,
            ) from None

    def _json(self, file: Any) -> Iterator[tuple[int, Row | InputError]]:
        """Yield the objects of a file with one per line."""
        for line, text in enumerate(file, start=1):
            if text.strip():
                try:
                    yield line, self._object(line, text)
                except InputError as error:
                    yield line, error

    def _object(self, line: int, text: str) -> Row:
        """Return the object of a line; null is what is not there."""
        known = dict.fromkeys((*COLUMNS, *SCENE_KEYS[""]))
        try:
            row = parse_json(text)
        except ValueError as error:
            raise InputError(f"{self._path}, line {line}: not valid JSON: {error}", file=self._path) from None
        if not isinstance(row, dict):
            raise InputError(
                f"{self._path}, line {line}: must be a JSON object, got {text.strip()[:40]}",
                file=self._path,
            )
        for key in row:
            if key not in known:
                raise InputError(
                    f"{self._path}, line {line}: {unknown_name('key', key, known)}",
                    file=self._path,
                    field=key,
                )
        found: Row = _without_nulls(row)
        return found

    def _error(self, line: int, message: str, field: str) -> InputError:
        """Return the error about a key of a line."""
        return InputError(f"{self._path}, line {line}: {message}", file=self._path, field=field)

    def _job(self, line: int, row: Mapping[str, Any]) -> Job:
        """Return the job of a row."""
        row = self._defaults | dict(row)
        data: dict[str, Any] = {key: value for key, value in row.items() if key in SCENE_KEYS[""]}
        avatar = row.get("avatar", {})
        avatar = {"file": avatar} if isinstance(avatar, str) else avatar
        if not isinstance(avatar, dict):
            raise self._error(line, f"avatar must be a file or a table of keys, got {avatar!r}", "avatar")
        avatar = avatar | {key: row[key] for key in AVATAR_KEYS if key in row}
        garments = row.get("garment", [])
        if isinstance(garments, str):
            garments = [part.strip() for part in garments.split(";")]
        if not isinstance(garments, list) or not all(isinstance(entry, str | dict) for entry in garments):
            raise self._error(
                line, f"garment must be a list of files, names or tables of keys, got {garments!r}", "garment"
            )
        garments = [{"source": entry} if isinstance(entry, str) else entry for entry in garments]
        if isinstance(fabric := row.get("fabric"), str):
            data.pop("fabric")
            fabrics = [part.strip() for part in fabric.split(";")]
            if len(fabrics) not in (1, len(garments)):
                raise self._error(line, f"{len(fabrics)} fabrics for {len(garments)} garments", "fabric")
            fabrics = fabrics * len(garments) if len(fabrics) == 1 else fabrics
            garments = [{"fabric": name} | entry for name, entry in zip(fabrics, garments, strict=True)]
        data |= {"garment": garments} | ({"avatar": avatar} if avatar else {})
        scene = scene_of_line(data, self._path, line)
        try:
            return Job(str(row["name"]) if "name" in row else job_name(scene), scene)
        except InputError as error:
            raise error.at(f"{self._path}, line {line}", file=self._path) from None


def _without_nulls(value: Any) -> Any:
    """Return JSON without entries of objects that are null, as programs write values that are missing."""
    if isinstance(value, dict):
        return {key: _without_nulls(entry) for key, entry in value.items() if entry is not None}
    if isinstance(value, list):
        return [_without_nulls(entry) for entry in value]
    return value
