"""The command `toile pattern`, and the options of drawn patterns."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from toile.dressing.cli.parser import DONE, Commands, Parser
from toile.geometry.errors import InputError

if TYPE_CHECKING:
    from toile.dressing.pattern.drawn.read_drawn import DrawnOptions
    from toile.dressing.pattern.pattern import Pattern


def add_pattern_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that say how patterns drawn without seams are read."""
    parser.add_argument("--size", metavar="SIZE", help="size of a DXF pattern that holds several")
    parser.add_argument(
        "--allowance", type=_length, metavar="LENGTH",
        help="seam allowance of a DXF pattern without a sew line, such as 10mm; 0 if none is drawn",
    )  # fmt: skip
    parser.add_argument(
        "--seams", type=Path, metavar="FILE.toml",
        help="what is sewn in a DXF or FreeSewing pattern (default: NAME.seams.toml beside it)",
    )  # fmt: skip
    parser.add_argument("--pattern-units", metavar="UNIT", help="units of a DXF pattern: mm, cm, m or in")


def add_pattern(commands: "Commands[Parser]") -> None:
    """Add the pattern command."""
    pattern = commands.add_parser(
        "pattern",
        help="show a sewing pattern, and convert it",
        description="Show a sewing pattern: its pieces, edges and seams, and what is open about them. "
        "A pattern without seams receives a seams file to edit.",
    )
    pattern.add_argument(
        "pattern", type=Path, metavar="FILE", help="GarmentCode .json, .dxf or FreeSewing .svg"
    )
    pattern.add_argument(
        "--draft", metavar="DESIGN",
        help="first draft a FreeSewing design, such as teagan, to FILE.svg (needs Node and its npm packages)",
    )  # fmt: skip
    pattern.add_argument(
        "--measurements",
        type=Path,
        metavar="FILE.json",
        help="for --draft: FreeSewing's names to millimetres",
    )
    pattern.add_argument(
        "--packages", type=Path, default=Path(), metavar="DIR",
        help="for --draft: folder that holds node_modules (default: this one)",
    )  # fmt: skip
    pattern.add_argument(
        "-o", "--output", type=Path, metavar="OUT", help=".svg: a picture; .json: the pattern in GarmentCode"
    )
    pattern.add_argument(
        "--avatar", type=Path, metavar="BODY", help="body to place pieces on (default: built-in mannequin)"
    )
    add_pattern_options(pattern)
    pattern.set_defaults(run=_run_pattern)


def _length(text: str) -> float:
    """Return a length [m] from "10mm", "1cm", "0.4in" or "0"."""
    number = text.strip().lower()
    for unit, metres in (("mm", 0.001), ("cm", 0.01), ("in", 0.0254), ("m", 1.0)):
        if number.endswith(unit):
            number, factor = number.removesuffix(unit), metres
            break
    else:
        factor = 0.0
    try:
        value = float(number)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no length; write 10mm or 0.4in") from None
    if value and not factor:
        raise argparse.ArgumentTypeError(f"{text!r} has no unit; write {text}mm or {text}cm")
    return value * factor


def _run_pattern(options: argparse.Namespace) -> int:
    """Print what a pattern holds; write its picture or convert it."""
    from toile.dressing.files.on_disk import is_file
    from toile.dressing.pattern.drawn.read_drawn import DRAWN_FORMATS, DrawnOptions

    path: Path = options.pattern
    output: Path | None = options.output
    if output is not None and output.suffix.lower() not in (".svg", ".json"):
        raise InputError(f"{output}: write a picture (.svg) or GarmentCode (.json)", file=output)
    if options.draft is not None:
        _draft(options.draft, options.measurements, options.packages, path)
    if not is_file(path):
        raise InputError(f"{path}: no such pattern file; check the path", file=path)
    drawn = DrawnOptions(
        size=options.size, units=options.pattern_units, allowance=options.allowance, seams=options.seams
    )
    if path.suffix.lower() in DRAWN_FORMATS:
        return _show_drawn(path, output, drawn, options.avatar)
    from toile.dressing.garment.readers import garment_formats, read_garment
    from toile.dressing.pattern.drawn.drawing import pattern_svg
    from toile.dressing.pattern.pattern import Pattern

    if path.suffix.lower() not in garment_formats():
        raise InputError(f"{path}: not a pattern file; use .json, {', '.join(DRAWN_FORMATS)}", file=path)
    pattern = read_garment(path)
    if not isinstance(pattern, Pattern):
        raise InputError(f"{path}: holds a mesh, not a sewing pattern", file=path)
    _print_pattern(pattern)
    if output is not None:
        _write(output, pattern, pattern_svg(pattern))
    return DONE


def _draft(design: str, measurements: Path | None, packages: Path, path: Path) -> None:
    """Draft a FreeSewing design to a file of measurements."""
    from toile.dressing.files.parse_text import parse_json
    from toile.dressing.files.writers.atomic import writable_folder, write_atomic
    from toile.dressing.pattern.drawn.freesewing_draft import draft_freesewing

    if path.suffix.lower() != ".svg":
        raise InputError(f"{path}: a draft of FreeSewing is an .svg file", file=path)
    if measurements is None:
        raise InputError("--draft needs --measurements FILE.json", field="--measurements")
    try:
        data = parse_json(measurements.read_text(encoding="utf-8"))
        given = {str(name): float(value) for name, value in data.get("freesewing", data).items()}
    except (OSError, ValueError, TypeError, AttributeError, OverflowError) as error:
        raise InputError(
            f"{measurements}: not a file of measurements, names to millimetres ({error})", file=measurements
        ) from None
    picture = draft_freesewing(design, given, packages)
    writable_folder(path.parent)
    write_atomic(path, picture.encode())
    print(f"wrote {path}")


def _show_drawn(path: Path, output: Path | None, options: "DrawnOptions", avatar: Path | None) -> int:
    """Print the pieces and seams of a drawn pattern, and what is open."""
    from dataclasses import replace

    from toile.dressing.files.on_disk import is_file
    from toile.dressing.pattern.drawn.drawing import drawn_svg
    from toile.dressing.pattern.drawn.read_drawn import read_drawn, told, told_or_sure, write_suggestions
    from toile.dressing.pattern.drawn.suggest import suggest_seams
    from toile.dressing.pattern.drawn.unfold import unfolded
    from toile.dressing.pattern.garmentcode import check_pattern

    left: tuple[str, ...] = ()
    try:
        drawn = told(path, options).drawn
    except InputError as error:
        if error.field != "open":
            raise
        drawn, left = read_drawn(path, options), (str(error),)
    questions: tuple[str, ...] = ()
    if drawn.seams is None:
        suggestions = suggest_seams(drawn)
        drawn, questions = replace(drawn, seams=suggestions.sure), (*suggestions.questions, *left)
        file = options.seams_file(path)
        if not is_file(file):
            write_suggestions(drawn, suggestions, file)
            print(f"wrote {file} and {file.with_suffix('.svg').name}")
    for piece in drawn.pieces:
        how = "half on the fold" if piece.fold is not None else "pair" if piece.pair else "once"
        lengths = "  ".join(
            f"{n}:{'fold' if n == piece.fold else f'{100 * piece.length(n):.1f}'}"
            for n in range(len(piece.edges))
        )
        print(f"{piece.name:<20}{how:<18}{1e4 * piece.area:8.1f} cm2   {lengths} cm")
    for seam in drawn.seams or ():
        print(f"sewn  {seam.name}")
    for question in questions:
        print(f"open  {question}")
    for note in drawn.notes:
        print(note)
    check_pattern(unfolded(drawn))
    if output is not None and output.suffix.lower() == ".svg":
        _write(output, None, drawn_svg(drawn, questions))
    elif output is not None:
        from toile.dressing.body.dress_form import DressForm
        from toile.dressing.pattern.drawn.place import placed_pattern
        from toile.dressing.run.scene import AvatarFile, MannequinSize
        from toile.dressing.run.scene_avatar import load_scene_avatar

        said = told_or_sure(path, options)
        source = MannequinSize() if avatar is None else AvatarFile(path=avatar)
        body = DressForm(load_scene_avatar(source)).measurements
        _write(output, placed_pattern(said.drawn, body, said.places, said.worn), "")
    return DONE


def _print_pattern(pattern: "Pattern") -> None:
    """Print the panels and stitches of a pattern with seams."""
    from toile.dressing.pattern.pattern_curve import edge_length

    for panel in pattern.panels:
        lengths = "  ".join(f"{n}:{100 * edge_length(panel, n):.1f}" for n in range(len(panel.edges)))
        print(f"{panel.name:<28}{lengths} cm")
    for stitch in pattern.stitches:
        print(f"sewn  {stitch.name}")
    for seam in pattern.seams:
        print(f"sewn  {seam.name}")
    for note in pattern.notes:
        print(note)


def _write(output: Path, pattern: "Pattern | None", picture: str) -> None:
    """Write a picture, or the pattern in GarmentCode, by the extension asked for."""
    from toile.dressing.files.writers.atomic import writable_folder, write_atomic
    from toile.dressing.pattern.garmentcode_write import write_garmentcode

    writable_folder(output.parent)
    if output.suffix.lower() == ".json" and pattern is not None:
        write_garmentcode(pattern, output)
    else:
        write_atomic(output, picture.encode())
    print(f"wrote {output}")
