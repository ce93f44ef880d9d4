"""Line numbers of the keys of a TOML file, which the standard parser does not keep."""

import re

KeyPath = tuple[str | int, ...]
PART = r"(?:\"[^\"]*\"|'[^']*'|[A-Za-z0-9_-]+)"
HEADER = re.compile(rf"^\s*(\[\[?)\s*({PART}(?:\s*\.\s*{PART})*)\s*\]\]?\s*(?:#.*)?$")
ASSIGNMENT = re.compile(rf"^\s*({PART}(?:\s*\.\s*{PART})*)\s*=")


class LineNumbers:
    """Line of each key of a TOML text; keys inside inline tables have the line of the outer key."""

    def __init__(self, text: str) -> None:
        self._lines: dict[KeyPath, int] = {}
        counts: dict[KeyPath, int] = {}
        table: KeyPath = ()
        for number, line in enumerate(text.splitlines(), start=1):
            header = HEADER.match(line)
            assignment = ASSIGNMENT.match(line)
            if header:
                name = self._inside_lists(_parts(header[2]), counts, is_list=header[1] == "[[")
                table = name
                self._lines.setdefault(table, number)
            elif assignment:
                parts = _parts(assignment[1])
                for length in range(1, len(parts) + 1):
                    self._lines.setdefault((*table, *parts[:length]), number)

    def of(self, key: KeyPath) -> int | None:
        """Return the line of a key such as ("garment", 1, "fabric"), or of the nearest table around it."""
        for length in range(len(key), 0, -1):
            if key[:length] in self._lines:
                return self._lines[key[:length]]
        return None

    def _inside_lists(self, parts: tuple[str, ...], counts: dict[KeyPath, int], *, is_list: bool) -> KeyPath:
        """Return the key path of a table header, with the index after every list of tables on its way."""
        path: KeyPath = ()
        for position, part in enumerate(parts):
            path = (*path, part)
            if position == len(parts) - 1 and is_list:
                counts[path] = counts.get(path, -1) + 1
            if path in counts:
                path = (*path, counts[path])
        return path


class OneLine:
    """The line of data that all stand on one."""

    def __init__(self, line: int) -> None:
        self._line = line

    def of(self, key: KeyPath) -> int:
        """Return the line."""
        return self._line


def key_path(field: str | None) -> KeyPath:
    """Return the path of a key that is written with dots, such as "elastic.0.rest"; empty for None."""
    return tuple(int(part) if part.isdigit() else part for part in field.split(".")) if field else ()


def _parts(dotted: str) -> tuple[str, ...]:
    """Return the parts of a dotted key without quotes."""
    return tuple(part.strip().strip("\"'") for part in re.findall(PART, dotted))
