"""Pieces as a picture: edges with numbers and lengths, seams in colours, folds, notches, grain."""

from collections.abc import Sequence
from html import escape

import numpy as np

from toile.dressing.pattern.drawn.piece import MIRRORED, DrawnPattern, Piece
from toile.dressing.pattern.pattern import Pattern
from toile.dressing.pattern.pattern_curve import edge_points
from toile.geometry.arrays import Float

MARGIN, ROW_WIDTH = 40.0, 2000.0
"""Space around pieces, and width of a row of them [mm]."""
TEXT = 12.0
"""Height of letters [mm]."""
COLOURS = (
    "#c0392b",
    "#2471a3",
    "#1e8449",
    "#b9770e",
    "#7d3c98",
    "#117a65",
    "#a04000",
    "#5d6d7e",
    "#cb4335",
    "#2e86c1",
)
UNSEWN = "#222222"
EdgeKey = tuple[str, int]


def drawn_svg(drawn: DrawnPattern, problems: Sequence[str] = ()) -> str:
    """Return the picture of pieces as drawn."""
    seams: dict[EdgeKey, int] = {}
    names = []
    for number, seam in enumerate(drawn.seams or ()):
        names.append(seam.name)
        for part in (*seam.a, *seam.b):
            seams.setdefault((part.panel.removesuffix(MIRRORED), part.edge), number)
    return _page(drawn.name, drawn.pieces, seams, names, [*drawn.notes, *problems])


def pattern_svg(pattern: Pattern) -> str:
    """Return the picture of a pattern's panels, flat, with its stitches and seams."""
    pieces = [
        Piece(
            name=panel.name,
            edges=tuple(edge_points(panel, n, 24 if edge.curve else 1) for n, edge in enumerate(panel.edges)),
            warp_degrees=panel.warp_degrees,
        )
        for panel in pattern.panels
    ]
    seams: dict[EdgeKey, int] = {}
    names = [stitch.name for stitch in pattern.stitches]
    for number, stitch in enumerate(pattern.stitches):
        seams[stitch.panel_a, stitch.edge_a] = seams[stitch.panel_b, stitch.edge_b] = number
    for seam in pattern.seams:
        names.append(seam.name)
        for part in (*seam.a, *seam.b):
            seams.setdefault((part.panel, part.edge), len(names) - 1)
    return _page(pattern.name, pieces, seams, names, list(pattern.notes))


def _page(
    title: str, pieces: Sequence[Piece], seams: dict[EdgeKey, int], names: list[str], notes: list[str]
) -> str:
    body: list[str] = []
    x, y, row = MARGIN, 2 * MARGIN, 0.0
    for piece in pieces:
        outline = 1e3 * piece.outline
        low, high = outline.min(axis=0), outline.max(axis=0)
        width, height = high - low
        if x > MARGIN and x + width > ROW_WIDTH:
            x, y, row = MARGIN, y + row + 2 * MARGIN, 0.0
        # y up in patterns, down in pictures.
        body.append(_piece(piece, np.array([x - low[0], y + high[1]]), seams))
        x, row = x + width + 2 * MARGIN, max(row, height)
    y += row + 2 * MARGIN
    for number, name in enumerate(names):
        body.append(_text(MARGIN, y, f"{number + 1}: {name}", COLOURS[number % len(COLOURS)]))
        y += 1.4 * TEXT
    for note in notes:
        body.append(_text(MARGIN, y, note, UNSEWN))
        y += 1.4 * TEXT
    size = f'width="{ROW_WIDTH + 2 * MARGIN:g}mm" height="{y + MARGIN:.0f}mm"'
    box = f'viewBox="0 0 {ROW_WIDTH + 2 * MARGIN:g} {y + MARGIN:.0f}"'
    head = _text(MARGIN, 1.2 * MARGIN, title, UNSEWN, 1.5 * TEXT)
    lines = "\n".join([head, *body])
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} {box} font-family="sans-serif">\n'
        f'<rect width="100%" height="100%" fill="white"/>\n{lines}\n</svg>\n'
    )


def _piece(piece: Piece, shift: Float, seams: dict[EdgeKey, int]) -> str:
    def at(points: Float) -> Float:
        return np.asarray(shift + 1e3 * points * [1.0, -1.0])

    centre = at(0.5 * (piece.outline.min(axis=0) + piece.outline.max(axis=0)))
    found = []
    for number, edge in enumerate(piece.edges):
        seam = seams.get((piece.name, number))
        colour = UNSEWN if seam is None else COLOURS[seam % len(COLOURS)]
        dash = ' stroke-dasharray="12 6"' if number == piece.fold else ""
        found.append(f'<path d="{_d(at(edge))}" fill="none" stroke="{colour}" stroke-width="2"{dash}/>')
        middle = at(_middle(edge)[None])[0]
        inwards = centre - middle
        label = middle + 1.3 * TEXT * inwards / max(float(np.linalg.norm(inwards)), 1e-9)
        words = "fold" if number == piece.fold else f"{100 * piece.length(number):.1f} cm"
        found.append(_text(label[0], label[1], f"{number}: {words}", colour, 0.8 * TEXT, "middle"))
    for line in (*piece.lines, *piece.holes):
        found.append(f'<path d="{_d(at(line))}" fill="none" stroke="#999" stroke-width="1"/>')
    for notch in piece.notches:
        fill = "#222" if notch.back else "none"
        x, y = at(_along(piece.edges[notch.edge], notch.along)[None])[0]
        found.append(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="3" fill="{fill}" stroke="#222"/>')
    warp = np.radians(piece.warp_degrees)
    arm = 30.0 * np.array([-np.sin(warp), -np.cos(warp)])
    low = centre + np.array([0.0, 3 * TEXT])
    ends = np.array([low - arm, low + arm])
    found.append(f'<path d="{_d(ends)}" fill="none" stroke="#888" stroke-width="1.5"/>')
    how = " (on the fold)" if piece.fold is not None else " (pair)" if piece.pair else ""
    found.append(_text(centre[0], centre[1], piece.name + how, UNSEWN, TEXT, "middle"))
    return "\n".join(found)


def _d(points: Float) -> str:
    return "M " + " L ".join(f"{x:.2f},{y:.2f}" for x, y in points)


def _middle(edge: Float) -> Float:
    lengths = np.linalg.norm(np.diff(edge, axis=0), axis=1)
    return _along(edge, 0.5 * float(lengths.sum()))


def _along(edge: Float, length: float) -> Float:
    walked = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(edge, axis=0), axis=1))])
    return np.array([np.interp(length, walked, edge[:, axis]) for axis in (0, 1)])


def _text(x: float, y: float, text: str, colour: str, size: float = TEXT, anchor: str = "start") -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size:g}" fill="{colour}" text-anchor="{anchor}">'
        f"{escape(text)}</text>"
    )
