"""seams.toml: what a drawn pattern does not say - folds, pairs, places on the body, and what is sewn to what.

    seams = ["front.2 + back~.2 = sleeve.2", "front.1 = back~.1"]

    [piece.front]
    fold = 5

A name with `~` is the mirrored half or the mirrored twin of a piece; seams of one side are sewn on the other
too.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, get_args

from toile.dressing.files.parse_text import parse_toml
from toile.dressing.files.suggestion import unknown_name
from toile.dressing.files.toml_lines import LineNumbers
from toile.dressing.pattern.drawn.piece import DrawnPattern, Piece
from toile.dressing.pattern.seam import Seam, read_seam
from toile.geometry.errors import InputError

Place = Literal["front", "back", "sleeve", "waistband", "collar"]
"""Where a piece goes."""
Worn = Literal["top", "bottom"]
"""Whether a garment hangs from the shoulders or sits on the waist."""
_KEYS = ("open", "seams", "worn", "piece")
_PIECE_KEYS = {"fold": int, "pair": bool, "place": str}


@dataclass(frozen=True)
class Told:
    """What a seams file tells about a pattern: seams if it has any, places by piece, how it is worn."""

    drawn: DrawnPattern
    places: dict[str, Place]
    worn: Worn | None = None


def seams_file_of(pattern: Path) -> Path:
    """Return where the seams file of a pattern lies: beside it."""
    return pattern.with_name(f"{pattern.stem}.seams.toml")


def apply_seams_file(drawn: DrawnPattern, path: Path) -> Told:
    """Return the pattern with what a seams file adds. Raises InputError naming file and line."""
    try:
        text = path.read_text(encoding="utf-8-sig")
        data = parse_toml(text)
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such seams file; check the path", file=path) from None
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: not a valid TOML file ({error})", file=path) from None
    lines = LineNumbers(text)

    def wrong(key: tuple[str | int, ...], message: str) -> InputError:
        line = lines.of(key)
        where = f"{path}, line {line}" if line else str(path)
        return InputError(f"{where}: {message}", file=path, field=".".join(map(str, key)))

    for key in data:
        if key not in _KEYS:
            raise wrong((key,), unknown_name("key", key, _KEYS))
    if data.get("open"):
        raise wrong(
            ("open",),
            f"{data['open']} questions about seams are open; answer them in the file and "
            "remove the line 'open'",
        )
    worn = data.get("worn")
    if worn is not None and worn not in get_args(Worn):
        raise wrong(("worn",), f"worn must be {' or '.join(get_args(Worn))}, got {worn!r}")
    pieces = {piece.name: piece for piece in drawn.pieces}
    places: dict[str, Place] = {}
    for name, values in _tables(data.get("piece", {}), wrong).items():
        if name not in pieces:
            raise wrong(("piece", name), unknown_name("piece", name, list(pieces)))
        for key, value in values.items():
            if key not in _PIECE_KEYS:
                raise wrong(("piece", name, key), unknown_name("key", key, list(_PIECE_KEYS)))
            if type(value) is not _PIECE_KEYS[key]:
                raise wrong(
                    ("piece", name, key), f"{key} must be of type {_PIECE_KEYS[key].__name__}, got {value!r}"
                )
        pieces[name] = _told(pieces[name], values, lambda text, n=name: wrong(("piece", n), text))
        if "place" in values:
            if values["place"] not in get_args(Place):
                raise wrong(("piece", name, "place"), unknown_name("place", values["place"], get_args(Place)))
            places[name] = values["place"]
    seams = data.get("seams")
    if seams is not None and not isinstance(seams, list):
        raise wrong(("seams",), "seams must be a list of texts such as 'front.1 = back~.1'")
    line = lines.of(("seams",))
    where = f"{path}, line {line}" if line else str(path)
    known = None if seams is None else tuple(read_seam(text, where) for text in seams)
    if known is None:
        known = drawn.seams
    return Told(replace(drawn, pieces=tuple(pieces.values()), seams=known), places, worn)


def _tables(pieces: Any, wrong: Any) -> dict[str, dict[str, Any]]:
    if not isinstance(pieces, dict) or not all(isinstance(values, dict) for values in pieces.values()):
        raise wrong(("piece",), "piece must be tables: write [piece.NAME]")
    return pieces


def _told(piece: Piece, values: dict[str, Any], wrong: Any) -> Piece:
    """Return the piece with what its table says."""
    fold, pair = values.get("fold", piece.fold), values.get("pair", piece.pair)
    if fold is not None and not 0 <= fold < len(piece.edges):
        raise wrong(f"piece '{piece.name}' has no edge {fold}, only 0..{len(piece.edges) - 1}")
    if fold is not None and pair:
        raise wrong(f"piece '{piece.name}' is cut on the fold or as a pair, not both")
    return replace(piece, fold=fold, pair=pair)


def seams_toml(drawn: DrawnPattern, seams: Sequence[Seam], open_questions: Sequence[str]) -> str:
    """Return the text of a seams file: the seams that are sure, and what is open as comments."""
    lines = [
        f"# What is sewn in {drawn.name}. PIECE.NUMBER is an edge; PIECE~ is its mirrored half or twin.",
        "# What stands left of '=' is walked with the loop, right of it against; '-' turns an edge around.",
        "# Numbers are in the picture beside this file. A seam of one side is sewn on the other side too.",
        "",
        *(
            [f"open = {len(open_questions)}   # remove this line once the questions below are answered"]
            if open_questions
            else []
        ),
        "seams = [",
        *(f'    "{seam.name}",' for seam in seams),
        "]",
    ]
    if open_questions:
        lines += ["", "# Open: move what is right into the list above."]
        lines += [f"# {question}" for question in open_questions]
    for piece in drawn.pieces:
        lines += ["", f'[piece."{piece.name}"]']
        if piece.fold is not None:
            lines.append(f"fold = {piece.fold}")
        else:
            lines.append(f"pair = {str(piece.pair).lower()}")
            if not piece.pair:
                lines.append("# fold = NUMBER   # if it is a half, the edge on the fold")
    return "\n".join(lines) + "\n"
