"""Patterns drawn without seams, DXF and SVG of FreeSewing, and seams files: valid small ones, and reads."""

from collections.abc import Iterable
from functools import cache
from pathlib import Path

from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.stored_mannequin import stored_mannequin
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.drawn.drawing import drawn_svg, pattern_svg
from toile.dressing.pattern.drawn.freesewing_svg import read_freesewing_svg
from toile.dressing.pattern.drawn.piece import DrawnPattern
from toile.dressing.pattern.drawn.place import placed_pattern
from toile.dressing.pattern.drawn.read_drawn import DrawnOptions, read_drawn, told_or_sure
from toile.dressing.pattern.drawn.seams_file import apply_seams_file, seams_file_of
from toile.dressing.pattern.drawn.suggest import suggest_seams
from toile.dressing.pattern.drawn.unfold import unfolded
from toile.dressing.pattern.garmentcode import check_pattern
from toile.geometry.errors import InputError

Point = tuple[float, float]
FRONT: list[Point] = [
    (0, 0), (250, 0), (250, 370), (200, 420), (185, 500), (190, 560), (80, 600), (60, 540), (0, 500)
]  # fmt: skip
BACK: list[Point] = [*FRONT[:7], (40, 585), (0, 580)]
SLEEVE: list[Point] = [(0, 0), (300, 0), (330, 160), (250, 240), (165, 290), (80, 240), (-30, 160)]
SVG_SEAMS = """
seams = ["front.1 = back~.1", "front.3 = back~.3", "sleeve.1 = sleeve.3",
    "sleeve.2 = front~.2[0.01:1] + back.2"]
worn = "top"

[piece.front]
fold = 5
place = "front"

[piece.sleeve]
pair = true
place = "sleeve"
"""


def dxfs() -> Iterable[tuple[str, bytes]]:
    """A tee: halves and a pair of sleeves in polylines, and in lines with a sew line, in two sizes."""
    inner = [(10.0, 10.0), (240.0, 10.0), (240.0, 360.0), (10.0, 480.0)]
    whole = [
        *_block("FRONT", "FRONT", "1", _polyline("1", FRONT) + _marks(FRONT)),
        *_block("BACK", "BACK", "1", _polyline("1", BACK) + _marks(BACK)),
        *_block("SLEEVE", "SLEEVE", "1,1", _polyline("1", SLEEVE) + _marks()),
    ]
    sizes = []
    for number, size in enumerate(("S", "M")):
        grown = [(1.0 + 0.1 * number) * x for x, _ in FRONT]
        outline = list(zip(grown, [y for _, y in FRONT], strict=True))
        sides = [
            ("LINE", "1", (10, a[0]), (20, a[1]), (11, b[0]), (21, b[1]))
            for a, b in zip(outline, outline[1:] + outline[:1], strict=True)
        ]
        light: tuple[object, ...] = ("LWPOLYLINE", "14", (70, 1))
        light += tuple(pair for x, y in inner for pair in ((10, x), (20, y)))
        sizes += _block(f"FRONT_{size}", "FRONT", "2", [*sides, light, *_marks()], size)
    units = [(0, "TEXT"), (8, "1"), (10, 0), (20, 0), (1, "UNITS: METRIC")]
    sample = [(0, "TEXT"), (8, "1"), (10, 0), (20, 0), (1, "SAMPLE SIZE: M")]
    return [(".dxf", _dxf(whole, units)), (".dxf", _dxf(sizes, [*units, *sample]))]


def _dxf(blocks: list[tuple[int, object]], entities: list[tuple[int, object]]) -> bytes:
    groups = [
        (0, "SECTION"), (2, "HEADER"), (9, "$INSUNITS"), (70, 4), (0, "ENDSEC"),
        (0, "SECTION"), (2, "BLOCKS"), *blocks, (0, "ENDSEC"),
        (0, "SECTION"), (2, "ENTITIES"), *entities, (0, "ENDSEC"), (0, "EOF"),
    ]  # fmt: skip
    return "".join(f"{code}\n{value}\n" for code, value in groups).encode()


def _block(
    block: str, piece: str, quantity: str, entities: list[tuple[object, ...]], size: str = ""
) -> list[tuple[int, object]]:
    """Return the groups of a block: its words, and entities as (kind, layer, further groups...)."""
    words = [f"PIECE NAME: {piece}", f"QUANTITY: {quantity}", *([f"SIZE: {size}"] if size else [])]
    groups: list[tuple[int, object]] = [(0, "BLOCK"), (8, "1"), (2, block)]
    for word in words:
        groups += [(0, "TEXT"), (8, "1"), (10, 5), (20, 5), (1, word)]
    for kind, layer, *rest in entities:
        groups += [(0, kind), (8, layer), *rest]  # type: ignore[list-item]
    return [*groups, (0, "ENDBLK")]


def _polyline(layer: str, points: list[Point]) -> list[tuple[object, ...]]:
    vertices: list[tuple[object, ...]] = [("VERTEX", layer, (10, x), (20, y)) for x, y in points]
    return [("POLYLINE", layer, (66, 1), (70, 1)), *vertices, ("SEQEND", layer)]


def _marks(half: list[Point] | None = None) -> list[tuple[object, ...]]:
    """Grain, notches, a line inside, a hole, and of a half its mirror line and turn points."""
    hole = [(140, 40), (160, 40), (150, 60)]
    marks: list[tuple[object, ...]] = [
        ("LINE", "7", (10, 50), (20, 50), (11, 50), (21, 250)),
        ("POINT", "4", (10, 250), (20, 100), (50, 180)),
        ("LINE", "4", (10, 120), (20, 0), (11, 120), (21, 6)),
        ("LINE", "8", (10, 20), (20, 20), (11, 30), (21, 120)),
        ("LWPOLYLINE", "11", (70, 1), *(pair for x, y in hole for pair in ((10, x), (20, y)))),
    ]
    if half is not None:
        marks.append(("LINE", "6", (10, 0), (20, 0), (11, 0), (21, half[-1][1])))
        marks += [("POINT", "2", (10, x), (20, y)) for x, y in half]
    return marks


def svgs() -> Iterable[tuple[str, bytes]]:
    """A tee of two halves and a sleeve, with curves, notches, folds and grain."""
    front = "M 0,0 L 250,0 L 250,-370 C 200,-380 180,-440 190,-560 L 80,-600 Q 60,-520 0,-500 z"
    back = "m 0 0 h 250 v -370 C 205,-380 185,-440 190,-560 L 80,-600 Q 40,-585 0,-580 Z"
    sleeve = "M 0,0 L 300,0 L 330,-160 C 290,-190 230,-290 165,-290 C 100,-290 10,-190 -30,-160 z"
    bent = '<path marker-start="url(#cutonfoldFrom)" d="M 0,-450 L 20,-450 L 20,-50 L 0,-50"/>'
    straight = '<path marker-start="url(#cutonfoldFrom)" d="M 0,-450 L 0,-50"/>'
    grain = '<path class="note" marker-start="url(#grainlineFrom)" d="M 150,-20 L 150,-240"/>'
    groups = "".join(
        f'<g id="fs-stack-tee.{name}-part-tee.{name}"><path class="fabric" d="{d}"/>{more}</g>'
        for name, d, more in [
            ("front", front, straight + _sign("notch", 190, -470)),
            ("back", back, straight + _sign("bnotch", 190, -470)),
            ("sleeve", sleeve, grain + _sign("notch", 265, -240) + _sign("bnotch", 40, -240)),
        ]
    )
    text = (
        '<?xml version="1.0" encoding="UTF-8"?>\n<svg xmlns="http://www.w3.org/2000/svg" '
        'xmlns:xlink="http://www.w3.org/1999/xlink" xmlns:freesewing="http://freesewing.org/namespaces/'
        'freesewing" freesewing="3.0" width="900mm" height="700mm" viewBox="0 0 900 700">\n<!-- tee -->'
    )
    return [(".svg", f"{text}{body}</svg>".encode()) for body in (groups, groups.replace(straight, bent))]


def _sign(kind: str, x: int, y: int) -> str:
    return f'<use xlink:href="#{kind}" x="{x}" y="{y}"/>'


def seams() -> Iterable[tuple[str, bytes]]:
    """What is sewn in the tee of `svgs`."""
    return [(".toml", SVG_SEAMS.encode())]


@cache
def form() -> DressForm:
    """The built-in mannequin."""
    return DressForm(stored_mannequin())


def drawn(path: Path) -> object:
    """Read a drawn pattern, sew it as suggested and place it."""
    beside = seams_file_of(path)
    for file in (beside, beside.with_suffix(".svg")):
        file.unlink(missing_ok=True)
    options = DrawnOptions(allowance=0.0 if path.suffix == ".dxf" else None)
    pieces = read_drawn(path, options)
    drawn_svg(pieces, suggest_seams(pieces).questions)
    try:
        told_or_sure(path, options)
    except InputError as error:
        if error.field != "seams":
            raise
    # What was written must be read again, once its open questions are answered.
    text = beside.read_text(encoding="utf-8")
    beside.write_text("\n".join(line for line in text.split("\n") if not line.startswith("open")), "utf-8")
    return sewn(pieces, beside)


def drawn_in_a_size(path: Path) -> object:
    """Read one size of a DXF file with a seam allowance, and unfold its pieces."""
    return unfolded(read_drawn(path, DrawnOptions(size="S", units="mm", allowance=0.01)))


def sewn(pieces: DrawnPattern, file: Path) -> object:
    """Sew pieces as a seams file says, place them on the mannequin and mesh them coarsely."""
    said = apply_seams_file(pieces, file)
    placed = placed_pattern(said.drawn, form().measurements, said.places, said.worn)
    check_pattern(placed)
    pattern_svg(placed)
    return mesh_pattern(placed, edge_length=0.05, curve_edge_length=0.05)


def seams_file(path: Path) -> object:
    """Read a seams file for the tee, and sew it."""
    return sewn(_tee(path.parent), path)


def _tee(folder: Path) -> DrawnPattern:
    """Return the pieces that the seams file is for."""
    file = folder / "tee.svg"
    if not file.exists():
        file.write_bytes(next(iter(svgs()))[1])
    return read_freesewing_svg(file)
