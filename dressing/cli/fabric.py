"""The command `toile fabric`."""

import argparse
from pathlib import Path

from toile.dressing.cli.fabric_fit import add_fabric_fit
from toile.dressing.cli.parser import DONE, Commands, Parser
from toile.dressing.cli.weave_options import add_weave_options, weave_of


def add_fabric(commands: "Commands[Parser]") -> None:
    """Add the fabric command."""
    fabric = commands.add_parser("fabric", help="make a fabric of measurements or yarns")
    kinds = fabric.add_subparsers(dest="kind", required=True)
    add_fabric_fit(kinds)
    weave = kinds.add_parser(
        "weave",
        help="a fabric from yarn count, ends and picks",
        description="Say what a woven fabric weighs, how it stretches, bends, shears and locks, by its "
        "yarns alone; -o writes it as a fabric of a scene file, with a picture.",
    )
    add_weave_options(weave)
    weave.add_argument("--name", default="woven", help="name of the fabric (default: woven)")
    weave.add_argument(
        "-o", "--output", type=Path, metavar="FILE.toml", help="write the fabric, and its picture as .svg"
    )
    weave.set_defaults(run=_run_weave)


def _run_weave(options: argparse.Namespace) -> int:
    """Print what is known of a weave, and write it."""
    from toile.dressing.weave.weave_picture import weave_svg
    from toile.dressing.weave.weave_text import weave_lines, weave_table

    cloth = weave_of(options)
    print("\n".join(weave_lines(cloth)))
    if options.output is not None:
        options.output.write_text(weave_table(cloth, options.name), encoding="utf-8")
        options.output.with_suffix(".svg").write_text(weave_svg(cloth), encoding="utf-8")
    return DONE
