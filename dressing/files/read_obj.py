"""Reader of Wavefront OBJ that keeps shared vertices, texture coordinates per corner, and groups.

General loaders split vertices along texture seams and reorder them, which cuts a garment into its
UV islands; here `v` lines stay nodes.
"""

from pathlib import Path

import numpy as np

from toile.dressing.files.corner_surface import Surface
from toile.geometry.errors import InputError


def read_obj(path: Path) -> Surface:
    """Return the surface of an OBJ file in the file's units. Raises InputError naming file and line."""
    positions: list[list[float]] = []
    uvs: list[list[float]] = []
    corners: list[list[int]] = []
    uv_corners: list[list[int]] = []
    sizes: list[int] = []
    group_of: list[int] = []
    groups: dict[str, int] = {}
    group = ""
    for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), start=1):
        words = line.split()
        if not words:
            continue
        try:
            if words[0] == "v":
                positions.append([float(word) for word in words[1:4]])
                if len(positions[-1]) != 3:
                    raise ValueError("a vertex needs three coordinates")
            elif words[0] == "vt":
                uvs.append([float(word) for word in words[1:3]])
                if len(uvs[-1]) != 2:
                    raise ValueError("a texture vertex needs two coordinates")
            elif words[0] in ("g", "o"):
                group = " ".join(words[1:])
            elif words[0] == "f":
                face = [word.split("/") for word in words[1:]]
                if len(face) < 3:
                    raise ValueError("a face needs three corners")
                corners.append([_index(part[0], len(positions)) for part in face])
                has_uv = all(len(part) > 1 and part[1] for part in face)
                uv_corners.append([_index(part[1], len(uvs)) if has_uv else -1 for part in face])
                sizes.append(len(face))
                group_of.append(groups.setdefault(group, len(groups)))
        except ValueError as error:
            raise InputError(f"{path}, line {number}: {error} in '{line.strip()[:60]}'", file=path) from None
    surface = Surface.from_polygons(
        positions=np.array(positions, dtype=np.float64).reshape(-1, 3),
        corners=corners,
        uv=np.array(uvs, dtype=np.float64).reshape(-1, 2),
        uv_corners=uv_corners,
        panel=np.array(group_of, dtype=np.int32),
    )
    return surface.with_panel_names(tuple(groups))


def _index(word: str, count: int) -> int:
    """Return the zero-based index of a one-based, or negative and relative, OBJ index."""
    value = int(word)
    index = value - 1 if value > 0 else count + value
    if value == 0 or not 0 <= index < count:
        raise ValueError(f"index {value} of {count} vertices")
    return index
