"""Reader of Wavefront OBJ that keeps shared vertices, texture coordinates per corner, and groups.

General loaders split vertices along texture seams and where normals differ, which cuts a garment into its UV
islands and numbers the vertices of every frame of a motion anew; here `v` lines stay vertices.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from toile.dressing.files.corner_surface import Surface
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError


def read_obj(path: Path, shape: Float | None = None) -> Surface:
    """Return the surface of an OBJ file in the file's units; its groups and objects are panels.

    `shape` are positions by which polygons are split, see `Surface.from_polygons`. Raises InputError naming
    file and line.
    """
    positions: list[list[float]] = []
    uvs: list[list[float]] = []
    corners: list[list[int]] = []
    uv_corners: list[list[int]] = []
    group_of: list[int] = []
    line_of: list[int] = []
    groups: dict[str, int] = {}
    group = ""
    text = path.read_text(encoding="utf-8-sig", errors="replace")
    for number, line in _statements(text):
        words = line.split()
        if not words:
            continue
        try:
            if words[0] == "v":
                positions.append(_numbers(words[1:], 3, "a vertex needs three coordinates"))
            elif words[0] == "vt":
                # A texture of one dimension has no second coordinate.
                uvs.append(_numbers([*words[1:], *["0"][: len(words) == 2]], 2, "a texture vertex needs two"))
            elif words[0] in ("g", "o"):
                group = " ".join(words[1:])
            elif words[0] == "f":
                face = [word.split("/") for word in words[1:]]
                if len(face) < 3:
                    raise ValueError("a face needs three corners")
                corners.append([_index(part[0], len(positions)) for part in face])
                has_uv = all(len(part) > 1 and part[1] for part in face)
                uv_corners.append([_index(part[1], len(uvs)) if has_uv else -1 for part in face])
                group_of.append(groups.setdefault(group, len(groups)))
                line_of.append(number)
        except ValueError as error:
            raise InputError(f"{path}, line {number}: {error} in '{line.strip()[:60]}'", file=path) from None
    for used, count, what in (
        (corners, len(positions), "vertices"),
        (uv_corners, len(uvs), "texture vertices"),
    ):
        _check_numbers(path, used, count, what, line_of)
    surface = Surface.from_polygons(
        positions=np.array(positions, dtype=np.float64).reshape(-1, 3),
        corners=corners,
        uv=np.array(uvs, dtype=np.float64).reshape(-1, 2),
        uv_corners=uv_corners,
        panel=np.array(group_of, dtype=np.int32),
        shape=shape,
    )
    return surface.with_panel_names(tuple(groups))


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """Yield statements without their comments, with the line each begins on; a backslash continues a line."""
    begun, start = "", 0
    for number, line in enumerate(text.split("\n"), start=1):
        start = start if begun else number
        # A sign of comment is one within the name of a group only where it stands apart.
        cut = line.find(" #") if line.lstrip()[:2] in ("g ", "o ") else line.find("#")
        line = line if cut < 0 else line[:cut]
        if line.rstrip().endswith("\\"):
            begun += line.rstrip()[:-1] + " "
            continue
        yield start, begun + line
        begun = ""
    if begun:
        yield start, begun


def _numbers(words: list[str], count: int, need: str) -> list[float]:
    """Return the first numbers of a statement."""
    if len(words) < count:
        raise ValueError(need)
    return [float(word) for word in words[:count]]


def _index(word: str, count: int) -> int:
    """Return the zero-based index of a one-based, or negative and relative, OBJ index.

    Positive ones may refer to what is yet to come, and are checked in the end.
    """
    value = int(word)
    index = value - 1 if value > 0 else count + value
    if value == 0 or index < 0:
        raise ValueError(f"index {value} of {count} vertices")
    return index


def _check_numbers(path: Path, corners: list[list[int]], count: int, what: str, lines: list[int]) -> None:
    """Raise InputError naming the first line that refers to what does not exist."""
    for face, line in zip(corners, lines, strict=True):
        if max(face) >= count:
            raise InputError(f"{path}, line {line}: index {max(face) + 1} of {count} {what}", file=path)
