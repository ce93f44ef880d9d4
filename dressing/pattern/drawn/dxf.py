"""Reader of DXF-AAMA and ASTM D6673 patterns: one block per piece and size, meaning by layer numbers."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.pattern.drawn.corners import (
    counter_clockwise,
    cut_at_corners,
    distance_to_line,
    edge_on_line,
    inset,
    projected_notches,
    warp_of_line,
    without_repeats,
)
from toile.dressing.pattern.drawn.dxf_entities import Block, DxfFile, Entity, read_dxf
from toile.dressing.pattern.drawn.piece import DrawnPattern, Notch, Piece
from toile.dressing.pattern.pattern_outline import crossing_sides, signed_area
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError, about

CUT, TURN, NOTCH, MIRROR, GRAIN, INNER, CUT_OUT = "1", "2", "4", "6", "7", "8", "11"
SEW = ("14", "8")
"""Layers of the sew line: ASTM's own; in AAMA files of some programs that of inner lines."""
METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "inch": 0.0254, "inches": 0.0254}
INSUNITS = {"1": "in", "4": "mm", "5": "cm", "6": "m"}
GAP = 0.001
"""Open polylines of an outline whose ends are farther apart leave it open [m]."""
LEAST_AREA = 1e-5
"""Smallest piece [m^2]."""


def read_dxf_pattern(
    path: str | Path, *, size: str | None = None, units: str | None = None, allowance: float | None = None
) -> DrawnPattern:
    """Read the pieces of one size.

    Parameters
    ----------
    path
        The file.
    size
        Which of several sizes; None takes the only one, or the file's sample size.
    units
        "mm", "cm", "m" or "in" where the file does not say it.
    allowance
        Seam allowance [m] of outlines that have no sew line; 0 if the outline is the sew line.

    Raises
    ------
    InputError
        The file is no pattern, lacks its units or a sew line and was not given them, or a piece is open, has
        no area or crosses itself.
    """
    path = Path(path)
    with about(file=path):
        drawing = read_dxf(path)
        blocks = [
            block
            for block in drawing.blocks
            if any(e.layer == CUT and len(e.points) > 1 for e in block.entities)
        ]
        if not blocks:
            raise InputError(
                f"{path.name}: no pattern pieces (blocks with an outline on layer 1); "
                "export it as DXF-AAMA or ASTM"
            )
        metres = _metres(path.name, drawing, units)
        chosen, notes = _of_size(path.name, drawing, blocks, size)
        pieces, names = [], list[str]()
        for block in chosen:
            words = _all_words(block, blocks)
            base = words.get("PIECE NAME") or _bare(block.name, words.get("SIZE", ""))
            name = _plain(base)
            if name in names:
                number = next(n for n in range(2, len(names) + 3) if f"{name}_{n}" not in names)
                notes.append(
                    f"Piece '{name}' is there more than once; a further one is called '{name}_{number}'."
                )
                name = f"{name}_{number}"
            names.append(name)
            pieces.append(_piece(path.name, block, name, words, metres, allowance))
        if any(piece.holes for piece in pieces):
            notes.append("Holes inside pieces are shown, but not cut out.")
    return DrawnPattern(name=path.stem, pieces=tuple(pieces), notes=tuple(notes))


def _metres(file: str, drawing: DxfFile, units: str | None) -> float:
    """Return metres per unit of the file."""
    if units is not None:
        if units not in METRES:
            raise InputError(f"{file}: {unknown_name('unit', units, list(METRES))}", field="units")
        return METRES[units]
    for entity in [*drawing.entities, *(e for block in drawing.blocks for e in block.entities)]:
        if said := re.match(r"\s*UNITS\s*:\s*(\w+)", entity.text, re.IGNORECASE):
            word = said[1].upper()
            return METRES["in"] if word in ("ENGLISH", "INCH", "INCHES") else METRES["mm"]
    if name := INSUNITS.get(drawing.header.get("$INSUNITS", "").strip()):
        return METRES[name]
    raise InputError(
        f"{file}: does not say its units; give them (--pattern-units mm, cm or in)", field="units"
    )


def _of_size(
    file: str, drawing: DxfFile, blocks: Sequence[Block], size: str | None
) -> tuple[list[Block], list[str]]:
    """Return the blocks of a size, and a note if there was a choice."""
    sizes = list(dict.fromkeys(s for block in blocks if (s := _words(block).get("SIZE"))))
    if size is None and len(sizes) < 2:
        return list(blocks), []
    notes = []
    if size is None:
        size = next(
            (found[1].strip() for e in drawing.entities
             if (found := re.match(r"\s*SAMPLE SIZE\s*:\s*(.+)", e.text, re.IGNORECASE))),
            None,
        )  # fmt: skip
        if size not in sizes:
            raise InputError(
                f"{file}: holds the sizes {', '.join(sizes)}; choose one (--size {sizes[0]})", field="size"
            )
        notes.append(f"Size {size}, the sample size, of {', '.join(sizes)}.")
    if size not in sizes:
        raise InputError(
            f"{file}: there is no size {size}; "
            + (f"the sizes are {', '.join(sizes)}" if sizes else "the file has one size without a name"),
            field="size",
        )
    return [block for block in blocks if _words(block).get("SIZE", size) == size], notes


def _words(block: Block) -> dict[str, str]:
    """Return the texts of a block that have a key, such as PIECE NAME, first of each."""
    words: dict[str, str] = {}
    for entity in block.entities:
        key, colon, value = entity.text.partition(":")
        if entity.kind == "TEXT" and colon:
            words.setdefault(key.strip().upper(), value.strip())
    return words


def _bare(block: str, size: str) -> str:
    return block.removesuffix(f"_{size}") if size else block


def _plain(name: str) -> str:
    """Return a name that can stand in a seam's text."""
    return re.sub(r"[\s.=+\[\]~]+", "_", name).strip("_-") or "piece"


def _all_words(block: Block, blocks: Sequence[Block]) -> dict[str, str]:
    """Return a block's texts, and those that only another size of the same piece has (quantity, category)."""
    words = _words(block)
    name = words.get("PIECE NAME")
    others = [_words(other) for other in blocks] if name else []
    for other in others:
        if other.get("PIECE NAME") == name:
            words = {**other, **words}
    return words


def _piece(
    file: str, block: Block, name: str, words: dict[str, str], metres: float, allowance: float | None
) -> Piece:
    where = f"{file}: piece '{name}'"
    layers: dict[str, list[Entity]] = {}
    for entity in block.entities:
        layers.setdefault(entity.layer, []).append(entity)
    mirror = _mirror_line(where, layers, metres)
    cut = _loop(where, _chains(layers, CUT), metres, mirror, _points(layers, TURN) * metres)
    sew, sew_layer = _sew_line(where, layers, metres, mirror, cut)
    if sew is None and allowance is None:
        raise InputError(
            f"{where} has no sew line (layer 14 or 8), and nothing says how wide its seam allowance is; "
            "give it (--allowance 10mm, or 0 if the outline is the sew line)",
            field="allowance",
        )
    fold = edge_on_line(cut if sew is None else sew, mirror)
    edges = inset(cut, allowance or 0.0, fold) if sew is None else sew
    grain = next((e.points for e in layers.get(GRAIN, []) if e.kind == "LINE"), None)
    texts = [e.text for e in layers.get("15", []) if e.kind == "TEXT"]
    return Piece(
        name=name,
        edges=edges,
        fold=fold,
        pair=fold is None and _is_pair(words.get("QUANTITY", "")),
        notches=_notches(edges, layers.get(NOTCH, []), metres),
        warp_degrees=warp_of_line(grain),
        words=" ".join([block.name, *words.values(), *texts]),
        lines=tuple(
            e.points * metres
            for e in layers.get(INNER, [])
            if len(e.points) > 1 and not (sew_layer == INNER and _is_outline(e))
        ),
        holes=tuple(e.points * metres for e in layers.get(CUT_OUT, []) if len(e.points) > 2),
    )


def _notches(edges: Sequence[Float], entities: Sequence[Entity], metres: float) -> tuple[Notch, ...]:
    """Return marks of the cut line on the sew line, in the direction of their own lines or angles."""
    marks = [e for e in entities if e.kind in ("POINT", "LINE")]
    inwards = [
        e.points[1] - e.points[0] if e.kind == "LINE"
        else None if e.angle is None else np.array([np.cos(np.radians(e.angle)), np.sin(np.radians(e.angle))])
        for e in marks
    ]  # fmt: skip
    return projected_notches(edges, [e.points[0] * metres for e in marks], inwards=inwards)


def _is_outline(entity: Entity) -> bool:
    return entity.kind in ("POLYLINE", "LWPOLYLINE") and entity.closed


def _points(layers: dict[str, list[Entity]], layer: str) -> Float:
    found = [e.points for e in layers.get(layer, []) if e.kind == "POINT"]
    return np.concatenate(found) if found else np.empty((0, 2))


def _chains(layers: dict[str, list[Entity]], layer: str) -> list[Entity]:
    return [
        e for e in layers.get(layer, []) if e.kind in ("POLYLINE", "LWPOLYLINE", "LINE") and len(e.points) > 1
    ]


def _loop(
    where: str, chains: list[Entity], metres: float, mirror: Float | None, turns: Float
) -> tuple[Float, ...]:
    """Return the edges of an outline: one closed polyline cut at corners, or open ones head to tail.

    Where the ends lie on the mirror line, it closes the outline. Raises InputError if it stays open.
    """
    closed = [
        e
        for e in chains
        if e.closed
        or (len(e.points) > 3 and np.allclose(e.points[0], e.points[-1], rtol=0, atol=GAP / metres))
    ]
    if closed:
        largest = max(closed, key=lambda e: abs(signed_area(e.points)))
        outline = _checked(where, counter_clockwise(without_repeats(largest.points * metres)))
        return cut_at_corners(outline, turns)
    left = [without_repeats(e.points * metres, closed=False) for e in chains]
    left = [points for points in left if len(points) > 1]
    if not left:
        raise InputError(f"{where} has no area: its outline is a point; remove it or draw it again")
    edges = [left.pop(0)]
    while left:
        gaps = [(np.linalg.norm(points[-1 if turn else 0] - edges[-1][-1]), index, turn)
                for index, points in enumerate(left) for turn in (False, True)]  # fmt: skip
        gap, index, turn = min(gaps)
        if gap > GAP:
            raise _open(where, edges[-1][-1], float(gap))
        following = left.pop(index)
        edges.append(following[::-1] if turn else following)
    rest = float(np.linalg.norm(edges[0][0] - edges[-1][-1]))
    if rest > GAP:
        if (
            mirror is None
            or max(distance_to_line(mirror, edges[0][0]), distance_to_line(mirror, edges[-1][-1])) > 2e-3
        ):
            raise _open(where, edges[-1][-1], rest)
        edges.append(np.array([edges[-1][-1], edges[0][0]]))
    ends = [edge[0] for edge in edges]
    for number, edge in enumerate(edges):
        edges[number] = np.vstack([edge[:-1], ends[(number + 1) % len(edges)][None]])
    outline = _checked(where, np.concatenate([edge[:-1] for edge in edges]))
    if signed_area(outline) < 0.0:
        edges = [np.ascontiguousarray(edge[::-1]) for edge in reversed(edges)]
    return tuple(edges)


def _open(where: str, end: Float, gap: float) -> InputError:
    return InputError(
        f"{where} has an open outline: {1e3 * gap:.3g} mm are missing at "
        f"({1e3 * end[0]:.1f}, {1e3 * end[1]:.1f}) mm; close it and export it again"
    )


def _checked(where: str, outline: Float) -> Float:
    if len(outline) < 3 or abs(signed_area(outline)) < LEAST_AREA:
        raise InputError(f"{where} has no area; remove it or draw it again")
    if crossing_sides(outline) is not None:
        raise InputError(f"{where} crosses itself; draw its outline again")
    return outline


def _sew_line(
    where: str, layers: dict[str, list[Entity]], metres: float, mirror: Float | None, cut: tuple[Float, ...]
) -> tuple[tuple[Float, ...] | None, str]:
    """Return the edges of the sew line and its layer; it lies within the cut line and is nearly as large."""
    area = signed_area(np.concatenate([edge[:-1] for edge in cut]))
    for layer in SEW:
        chains = _chains(layers, layer)
        if layer == INNER:
            chains = [e for e in chains if _is_outline(e)]
        if not chains:
            continue
        try:
            edges = _loop(where, chains, metres, mirror, np.empty((0, 2)))
        except InputError:
            if layer == INNER:
                continue
            raise
        if signed_area(np.concatenate([edge[:-1] for edge in edges])) > 0.5 * area:
            return edges, layer
    return None, ""


def _mirror_line(where: str, layers: dict[str, list[Entity]], metres: float) -> Float | None:
    lines = [e.points[[0, -1]] * metres for e in layers.get(MIRROR, []) if len(e.points) > 1]
    if lines and not np.ptp(lines[0], axis=0).any():
        raise InputError(f"{where}: its mirror line has no length; remove it or draw it again")
    return lines[0] if lines else None


def _is_pair(quantity: str) -> bool:
    """Tell whether a quantity means a mirrored pair: "1,1" as drawn and mirrored, or "2"."""
    # As texts: Python makes no number of thousands of digits.
    numbers = [digits.lstrip("0") for digits in re.findall(r"\d+", quantity)]
    if len(numbers) > 1 and "," in quantity:
        return bool(numbers[1])
    return bool(numbers) and numbers[0] == "2"
