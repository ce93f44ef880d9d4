"""The entities of a DXF file: group codes as pairs of lines, blocks kept apart even if they share a name."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

SKIPPED_BLOCKS = ("*", "$")
"""First letters of blocks that hold the drawing as a whole."""


@dataclass(frozen=True)
class Entity:
    """One entity: kind, layer, points in file units, text, whether it is closed, its angle [degrees]."""

    kind: str
    layer: str
    points: Float
    text: str = ""
    closed: bool = False
    angle: float | None = None


@dataclass(frozen=True)
class Block:
    """A block: its name and its entities."""

    name: str
    entities: tuple[Entity, ...]


@dataclass(frozen=True)
class DxfFile:
    """Blocks, entities of the drawing itself, and variables of the header, first value each."""

    blocks: tuple[Block, ...]
    entities: tuple[Entity, ...]
    header: dict[str, str] = field(default_factory=dict)


@dataclass
class _Raw:
    kind: str
    groups: list[tuple[int, str]]
    vertices: list["_Raw"] = field(default_factory=list)

    def first(self, code: int, default: str = "") -> str:
        return next((value for at, value in self.groups if at == code), default)


def read_dxf(path: Path) -> DxfFile:
    """Return what a text DXF file holds. Raises InputError naming the line that cannot be read."""
    raw, header = _entities(path, _text(path).splitlines())
    blocks: list[Block] = []
    loose: list[Entity] = []
    section, block, inside = "", "", list[Entity]()
    for entity in raw:
        if entity.kind == "SECTION":
            section = entity.first(2).strip()
        elif entity.kind == "BLOCK":
            block, inside = entity.first(2).strip(), []
        elif entity.kind == "ENDBLK":
            if block and not block.startswith(SKIPPED_BLOCKS):
                blocks.append(Block(block, tuple(inside)))
            block = ""
        elif section in ("BLOCKS", "ENTITIES"):
            (inside if section == "BLOCKS" else loose).append(_entity(entity, path))
    return DxfFile(tuple(blocks), tuple(loose), header)


def _text(path: Path) -> str:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: the pattern cannot be read ({error})", file=path) from None
    if data.startswith(b"AutoCAD Binary DXF"):
        raise InputError(f"{path.name}: a binary DXF; export it as text (ASCII)", file=path)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _entities(path: Path, lines: list[str]) -> tuple[list[_Raw], dict[str, str]]:
    """Return the entities of pairs of lines (code, value), vertices with their polylines, and the header."""
    found: list[_Raw] = []
    header: dict[str, str] = {}
    variable = ""
    for number in range(0, len(lines) - 1, 2):
        try:
            code = int(lines[number])
        except ValueError:
            raise InputError(
                f"{path.name}, line {number + 1}: '{lines[number][:30]}' is no group code; this is not a "
                "text DXF file, export it again",
                file=path,
            ) from None
        value = lines[number + 1]
        if code == 0:
            _start(found, value.strip())
            variable = ""
        elif code == 9:
            variable = value.strip()
        elif variable:
            header.setdefault(variable, value.strip())
        elif found:
            owner = found[-1].vertices[-1] if found[-1].vertices else found[-1]
            owner.groups.append((code, value))
    return [entity for entity in found if entity.kind not in ("SEQEND", "EOF")], header


def _start(found: list[_Raw], kind: str) -> None:
    """Begin an entity; a vertex belongs to the polyline before it."""
    if kind == "VERTEX" and found and found[-1].kind == "POLYLINE":
        found[-1].vertices.append(_Raw(kind, []))
    else:
        found.append(_Raw(kind, []))


def _entity(raw: _Raw, path: Path) -> Entity:
    try:
        points = _points(raw)
        angle = float(raw.first(50)) if raw.kind == "POINT" and raw.first(50) else None
        closed = raw.kind in ("POLYLINE", "LWPOLYLINE") and int(float(raw.first(70, "0"))) & 1 == 1
    except (ValueError, OverflowError):
        raise InputError(
            f"{path.name}: a {raw.kind} on layer {raw.first(8).strip()} has a coordinate that is no number",
            file=path,
        ) from None
    text = raw.first(1).strip() if raw.kind in ("TEXT", "MTEXT") else raw.first(2).strip()
    return Entity(raw.kind, raw.first(8).strip(), points, text, closed, angle)


def _points(raw: _Raw) -> Float:
    if raw.kind == "POLYLINE":
        rows = [(float(vertex.first(10)), float(vertex.first(20))) for vertex in raw.vertices]
    elif raw.kind == "LWPOLYLINE":
        xs, ys = ([float(value) for code, value in raw.groups if code == at] for at in (10, 20))
        rows = list(zip(xs, ys, strict=True))
    elif raw.kind == "LINE":
        rows = [(float(raw.first(10)), float(raw.first(20))), (float(raw.first(11)), float(raw.first(21)))]
    elif raw.kind in ("POINT", "TEXT", "INSERT"):
        rows = [(float(raw.first(10, "0")), float(raw.first(20, "0")))]
    else:
        rows = []
    points = np.array(rows, dtype=np.float64).reshape(-1, 2)
    if not np.isfinite(points).all():
        raise ValueError("not finite")
    return points
