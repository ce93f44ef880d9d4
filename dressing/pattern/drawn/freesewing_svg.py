"""Reader of the SVG files that FreeSewing writes: classes, markers and ids say what paths are."""

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from toile.dressing.pattern.drawn.corners import (
    counter_clockwise,
    cut_at_corners,
    edge_on_line,
    projected_notches,
    warp_of_line,
    without_repeats,
)
from toile.dressing.pattern.drawn.piece import DrawnPattern, Piece
from toile.dressing.pattern.drawn.svg_path import flat_path
from toile.dressing.pattern.pattern_outline import crossing_sides, signed_area
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError, about

METRES = {"mm": 0.001, "cm": 0.01, "in": 0.0254}
LEAST_AREA = 1e-5
_PART = re.compile(r"fs-stack-.*-part-(?P<design>[^.]+)\.(?P<part>.+)")


def read_freesewing_svg(path: str | Path) -> DrawnPattern:
    """Read the pieces of a FreeSewing SVG.

    Pieces that are not cut on the fold are taken for mirrored pairs, since the file does not say how often
    they are cut.

    Raises
    ------
    InputError
        The file is no SVG of FreeSewing, has no scale, or a piece has no closed outline or no area.
    """
    path = Path(path)
    with about(file=path):
        root = _root(path)
        metres = _scale(path.name, root)
        if not any(key.split("}")[-1] == "freesewing" for key in root.attrib):
            raise InputError(
                f"{path.name}: an SVG that FreeSewing did not write; what its paths mean is not known, "
                "export the pattern as DXF (AAMA or ASTM)"
            )
        pieces = []
        for group in root.iter():
            found = _PART.fullmatch(group.get("id", ""))
            if found is not None:
                piece = _piece(path.name, group, found["part"], metres)
                pieces += [piece] if piece is not None else []
        if not pieces:
            raise InputError(
                f"{path.name}: no pattern pieces (paths of class 'fabric'); draft the pattern again"
            )
    pairs = [piece.name for piece in pieces if piece.pair]
    notes = (
        (f"Taken for mirrored pairs: {', '.join(pairs)}; the seams file can say otherwise.",) if pairs else ()
    )
    return DrawnPattern(name=path.stem, pieces=tuple(pieces), notes=notes)


def _root(path: Path) -> ElementTree.Element:
    try:
        return ElementTree.parse(path).getroot()
    except FileNotFoundError:
        raise InputError(f"{path}: no such pattern file; check the path") from None
    except (ElementTree.ParseError, OSError, ValueError, LookupError) as error:
        # Encodings that Python does not know, or that are none of texts, are a LookupError or a ValueError.
        raise InputError(f"{path.name}: not a valid SVG ({error}); save it again") from None


def _scale(file: str, root: ElementTree.Element) -> float:
    """Return metres per unit of the drawing."""
    width = re.fullmatch(r"\s*([0-9.eE+-]+)\s*(mm|cm|in)\s*", root.get("width", ""))
    box = root.get("viewBox", "").replace(",", " ").split()
    try:
        across = float(box[2])
        metres = float(width[1]) * METRES[width[2]] / across if width is not None else 0.0
    except (IndexError, ValueError, ZeroDivisionError):
        metres = 0.0
    if not 0.0 < metres < 1.0:
        raise InputError(
            f"{file}: an SVG without scale; its root needs a width in mm and a viewBox, such as "
            'width="900mm" viewBox="0 0 900 600"'
        )
    return metres


def _piece(file: str, group: ElementTree.Element, name: str, metres: float) -> Piece | None:
    """Return the piece of a part, None if the part draws no fabric."""
    where = f"{file}: piece '{name}'"
    paths = [
        (e, flat_path(e.get("d", ""), where) * [metres, -metres]) for e in group.iter() if _tag(e) == "path"
    ]
    if not any(e.get("class") == "fabric" for e, _ in paths):
        return None
    # What draws nothing is no fault, unless it is all there is.
    paths = [(e, points) for e, points in paths if len(points) > 1]
    fabric = [points for e, points in paths if e.get("class") == "fabric"]
    if not fabric:
        raise InputError(f"{where} has no area: its outline draws nothing; draft the pattern again")
    outlines = [without_repeats(points) for points in fabric]
    largest = max(range(len(outlines)), key=lambda n: abs(_area(outlines[n])))
    outline = outlines[largest]
    if abs(_area(outline)) < LEAST_AREA:
        raise InputError(f"{where} has no area; draft the pattern again")
    outline = counter_clockwise(outline)
    if crossing_sides(outline) is not None:
        raise InputError(f"{where} crosses itself; draft the pattern again")
    edges = cut_at_corners(outline)
    marker = {e.get("marker-start", ""): points for e, points in paths}
    on_fold = marker.get("url(#cutonfoldFrom)")
    if on_fold is not None and not np.ptp(on_fold[[0, -1]], axis=0).any():
        raise InputError(f"{where}: its fold line has no length; draft the pattern again")
    fold = None if on_fold is None else edge_on_line(edges, on_fold[[0, -1]])
    grain = marker.get("url(#grainlineFrom)", on_fold)
    signs = [
        (e, name.lstrip("#"))
        for e in group.iter()
        for key, name in e.attrib.items()
        if _tag(e) == "use" and key.endswith("href") and name in ("#notch", "#bnotch")
    ]
    marks = [_place(where, e) * [metres, -metres] for e, _ in signs]
    return Piece(
        name=name,
        edges=edges,
        fold=fold,
        pair=fold is None,
        notches=projected_notches(edges, marks, back=[sign == "bnotch" for _, sign in signs]),
        warp_degrees=warp_of_line(None if grain is None else grain[[0, -1]]),
        words=name,
        lines=tuple(points for n, points in enumerate(fabric) if n != largest),
    )


def _place(where: str, element: ElementTree.Element) -> Float:
    """Return where a notch lies in the drawing, shape (2,)."""
    try:
        place = np.array([float(element.get("x", "0")), float(element.get("y", "0"))])
    except ValueError:
        place = np.full(2, np.nan)
    if not np.isfinite(place).all():
        raise InputError(
            f"{where}: a notch lies at x={element.get('x')!r}, y={element.get('y')!r}, which are no numbers; "
            "save the drawing again"
        )
    return place


def _area(points: Float) -> float:
    return signed_area(points) if len(points) > 2 else 0.0


def _tag(element: ElementTree.Element) -> str:
    return element.tag.split("}")[-1] if isinstance(element.tag, str) else ""
