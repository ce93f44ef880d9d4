"""Drawn patterns by the extension of their files, and what is sewn in them: told, sure, or asked for."""

from dataclasses import dataclass, replace
from pathlib import Path

from toile.dressing.files.on_disk import is_file
from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.pattern.drawn.drawing import drawn_svg
from toile.dressing.pattern.drawn.dxf import read_dxf_pattern
from toile.dressing.pattern.drawn.freesewing_svg import read_freesewing_svg
from toile.dressing.pattern.drawn.piece import DrawnPattern
from toile.dressing.pattern.drawn.seams_file import Told, apply_seams_file, seams_file_of, seams_toml
from toile.dressing.pattern.drawn.suggest import Suggestions, suggest_seams
from toile.dressing.pattern.seam import read_seam
from toile.geometry.errors import InputError

DRAWN_FORMATS = (".dxf", ".svg")
"""Extensions of patterns that are drawn without seams."""
SHOWN_QUESTIONS = 4
"""Questions that an error message lists; all are in the file."""


@dataclass(frozen=True, kw_only=True)
class DrawnOptions:
    """How a drawn pattern is read: size, units, seam allowance [m], and its seams file or seams as texts."""

    size: str | None = None
    units: str | None = None
    allowance: float | None = None
    seams: Path | tuple[str, ...] | None = None

    def seams_file(self, path: Path) -> Path:
        """Return the seams file of a pattern: the one given, or the one beside it."""
        return self.seams if isinstance(self.seams, Path) else seams_file_of(path)


def read_drawn(path: Path, options: DrawnOptions) -> DrawnPattern:
    """Return the pieces of a file. Raises InputError naming what is wrong, or an option it does not take."""
    if path.suffix.lower() == ".dxf":
        return read_dxf_pattern(path, size=options.size, units=options.units, allowance=options.allowance)
    for field in ("size", "units", "allowance"):
        if getattr(options, field) is not None:
            raise InputError(
                f"{path.name}: {field} is for DXF patterns; an SVG holds one size in mm", field=field
            )
    return read_freesewing_svg(path)


def told(path: Path, options: DrawnOptions) -> Told:
    """Return the pieces of a file with what a seams file says: the one given, or the one beside it."""
    drawn = read_drawn(path, options)
    file = options.seams_file(path)
    said = Told(drawn, {})
    if isinstance(options.seams, Path) or is_file(file):
        said = apply_seams_file(drawn, file)
    if isinstance(options.seams, tuple):
        seams = tuple(read_seam(text, f"{path.name}: seams") for text in options.seams)
        said = replace(said, drawn=replace(said.drawn, seams=seams))
    return said


def told_or_sure(path: Path, options: DrawnOptions) -> Told:
    """Return the pieces of a file and what is sewn: as told, or where nobody said it, if all of it is sure.

    Suggestions are written beside the pattern as a seams file and a picture.

    Raises
    ------
    InputError
        As `read_drawn` and the seams file do; or what is sewn is not sure: the questions are named.
    """
    said = told(path, options)
    if said.drawn.seams is not None:
        return said
    suggestions = suggest_seams(said.drawn)
    file = options.seams_file(path)
    if not is_file(file):
        write_suggestions(said.drawn, suggestions, file)
    if suggestions.questions:
        shown = "; ".join(suggestions.questions[:SHOWN_QUESTIONS])
        more = len(suggestions.questions) - SHOWN_QUESTIONS
        raise InputError(
            f"{path.name}: what is sewn is not sure: {shown}{f'; and {more} more' if more > 0 else ''}; "
            f"write the seams into {file} (edges are numbered in {file.with_suffix('.svg').name})",
            file=path,
            field="seams",
        )
    note = f"Seams were found by lengths and corners, and are listed in {file.name}."
    return replace(said, drawn=replace(said.drawn, seams=suggestions.sure, notes=(*said.drawn.notes, note)))


def write_suggestions(drawn: DrawnPattern, suggestions: Suggestions, file: Path) -> None:
    """Write a seams file and, beside it, a picture with the numbers of all edges."""
    try:
        write_atomic(file, seams_toml(drawn, suggestions.sure, suggestions.questions).encode())
        picture = drawn_svg(replace(drawn, seams=suggestions.sure), suggestions.questions)
        write_atomic(file.with_suffix(".svg"), picture.encode())
    except OSError as error:
        raise InputError(
            f"{file}: the seams file cannot be written ({error}); copy the pattern to a folder of yours",
            file=file,
        ) from None
