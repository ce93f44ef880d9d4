"""Drawn pieces as the panels that are cut from them: halves unfolded, twins added, seams of both sides."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.pattern.drawn.piece import MIRRORED, DrawnPattern, Piece
from toile.dressing.pattern.pattern import Edge, Panel, Pattern
from toile.dressing.pattern.pattern_curve import polyline_curve
from toile.dressing.pattern.seam import EdgePart, Seam
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError


def unfolded(drawn: DrawnPattern) -> Pattern:
    """Return the panels, each in the plane of its drawing, and the seams of both sides of the body.

    Raises InputError where a seam names a piece, an edge or a mirrored side that does not exist.
    """
    pieces = {piece.name: piece for piece in drawn.pieces}
    seams: list[Seam] = []
    for seam in drawn.seams or ():
        for part in (*seam.a, *seam.b):
            _check(drawn.name, seam, part, pieces)
        _add(seams, seam)
        if all(piece_of(part, pieces).mirrors for part in (*seam.a, *seam.b)):
            _add(seams, mirrored_seam(seam))
    return Pattern(
        name=drawn.name,
        panels=tuple(panel for piece in drawn.pieces for panel in panels_of(piece)),
        stitches=(),
        notes=drawn.notes,
        seams=tuple(
            Seam(*(tuple(_on_panel(part, pieces) for part in run) for run in (seam.a, seam.b)))
            for seam in seams
        ),
    )


def piece_of(part: EdgePart, pieces: dict[str, Piece]) -> Piece:
    """Return the piece whose drawn or mirrored edge a part of a seam is."""
    return pieces[part.panel.removesuffix(MIRRORED)]


def mirrored_seam(seam: Seam) -> Seam:
    """Return the same seam on the other side of the body; loops run the other way there."""
    return Seam(*(tuple(mirrored_part(p).turned() for p in reversed(run)) for run in (seam.a, seam.b)))


def mirrored_part(part: EdgePart) -> EdgePart:
    """Return the mirrored stretch, walked as its image is."""
    bare = part.panel.removesuffix(MIRRORED)
    name = bare if bare != part.panel else bare + MIRRORED
    return EdgePart(name, part.edge, 1.0 - part.start, 1.0 - part.end)


def panels_of(piece: Piece) -> list[Panel]:
    """Return the panels of a piece: one, or one and its mirrored twin. Fold lines come to lie on x = 0."""
    notches = {
        n: tuple(m.along / piece.length(n) for m in piece.notches if m.edge == n)
        for n in range(len(piece.edges))
    }
    if piece.fold is None:
        panel = _panel(
            piece.name, piece.edges, [notches[n] for n in range(len(piece.edges))], piece.warp_degrees,
            piece.lines,
        )  # fmt: skip
        if not piece.pair:
            return [panel]
        edges = [edge[::-1] * [-1.0, 1.0] for edge in reversed(piece.edges)]
        marks = [_turned(notches[n]) for n in reversed(range(len(piece.edges)))]
        twin = [line * [-1.0, 1.0] for line in piece.lines]
        return [panel, _panel(piece.name + MIRRORED, edges, marks, -piece.warp_degrees, twin)]
    order = _drawn_order(piece)
    turn, origin, degrees = _fold_frame(piece)
    half = [(piece.edges[n] - origin) @ turn.T for n in order]
    for edge in (half[0], half[-1]):
        edge[0 if edge is half[0] else -1, 0] = 0.0
    mirrored = [edge[::-1] * [-1.0, 1.0] for edge in reversed(half)]
    marks = [notches[n] for n in order]
    marks += [_turned(notches[n]) for n in reversed(order)]
    lines = [(line - origin) @ turn.T for line in piece.lines]
    lines += [line * [-1.0, 1.0] for line in lines]
    return [_panel(piece.name, [*half, *mirrored], marks, piece.warp_degrees + degrees, lines)]


def _fold_frame(piece: Piece) -> tuple[Float, Float, float]:
    """Return the turn and the origin that bring the fold onto x = 0 and the cloth to x > 0, and the angle.

    The loop runs counter-clockwise, so along the fold it runs down where the cloth is on its right-hand side.
    """
    assert piece.fold is not None
    fold = piece.edges[piece.fold]
    x, y = fold[0] - fold[-1]
    degrees = 90.0 - float(np.degrees(np.arctan2(y, x)))
    length = float(np.hypot(x, y))
    turn = np.array([[y, -x], [x, y]]) / length
    return turn, fold[-1], degrees


def _drawn_order(piece: Piece) -> list[int]:
    """Return the numbers of a half's drawn edges as they follow its fold."""
    assert piece.fold is not None
    count = len(piece.edges)
    return [(piece.fold + 1 + step) % count for step in range(count - 1)]


def _on_panel(part: EdgePart, pieces: dict[str, Piece]) -> EdgePart:
    """Return the stretch in the numbers of the panel that is cut."""
    piece = piece_of(part, pieces)
    other = part.panel != piece.name
    count = len(piece.edges)
    if piece.fold is None:
        return replace(part, edge=count - 1 - part.edge) if other else part
    step = (part.edge - piece.fold - 1) % count
    return replace(part, panel=piece.name, edge=2 * (count - 1) - 1 - step if other else step)


def panel_edge(piece: Piece, edge: int, *, mirrored: bool = False) -> tuple[str, int]:
    """Return panel and number of a drawn edge in the panels that are cut from a piece."""
    part = _on_panel(EdgePart(piece.name + (MIRRORED if mirrored else ""), edge), {piece.name: piece})
    return part.panel, part.edge


def _add(seams: list[Seam], seam: Seam) -> None:
    """Add a seam unless its edges are sewn already, as those of a piece to its own mirror are."""
    if _stretches(seam) not in [_stretches(other) for other in seams]:
        seams.append(seam)


def _stretches(seam: Seam) -> set[frozenset[tuple[str, int, float, float]]]:
    return {
        frozenset(
            (p.panel, p.edge, round(min(p.start, p.end), 9), round(max(p.start, p.end), 9)) for p in run
        )
        for run in (seam.a, seam.b)
    }


def _check(file: str, seam: Seam, part: EdgePart, pieces: dict[str, Piece]) -> None:
    bare = part.panel.removesuffix(MIRRORED)
    where = f"{file}: seam '{seam.name}'"
    if bare not in pieces:
        raise InputError(f"{where}: {unknown_name('piece', bare, list(pieces))}", field="seams")
    piece = pieces[bare]
    if not 0 <= part.edge < len(piece.edges):
        raise InputError(
            f"{where}: piece '{bare}' has no edge {part.edge}, only 0..{len(piece.edges) - 1}", field="seams"
        )
    if part.edge == piece.fold:
        raise InputError(
            f"{where}: edge {bare}.{part.edge} lies on the fold and is no edge of the cloth", field="seams"
        )
    if bare != part.panel and not piece.mirrors:
        raise InputError(
            f"{where}: piece '{bare}' has no mirrored side; say 'pair = true' or 'fold = NUMBER' for it",
            field="seams",
        )


def _turned(notches: Sequence[float]) -> tuple[float, ...]:
    return tuple(1.0 - notch for notch in reversed(notches))


def _panel(
    name: str,
    edges: Sequence[Float],
    notches: Sequence[tuple[float, ...]],
    warp: float,
    lines: Sequence[Float],
) -> Panel:
    count = len(edges)
    return Panel(
        name=name,
        vertices=tuple((float(edge[0, 0]), float(edge[0, 1])) for edge in edges),
        edges=tuple(
            Edge(
                number, (number + 1) % count,
                polyline_curve(np.vstack([edge[:-1], edges[(number + 1) % count][:1]])),
                notches=tuple(sorted(notches[number])),
            )
            for number, edge in enumerate(edges)
        ),
        warp_degrees=warp - 180.0 * round(warp / 180.0),
        lines=tuple(tuple((float(x), float(y)) for x, y in line) for line in lines),
    )  # fmt: skip
