"""The command `toile yarns`."""

import argparse
from pathlib import Path

from toile.dressing.cli.parser import DONE, FAILED, Commands, Parser, say_progress
from toile.dressing.cli.weave_options import add_weave_options, weave_of
from toile.geometry.errors import InputError

KINDS = ("uniaxial", "bias", "shear", "bend", "pull-out", "sag", "snag")


def add_yarns(commands: "Commands[Parser]") -> None:
    """Add the yarns command."""
    yarns = commands.add_parser("yarns", help="woven cloth at the level of its yarns")
    kinds = yarns.add_subparsers(dest="kind", required=True)
    swatch = kinds.add_parser(
        "swatch",
        help="pull, shear or bend a swatch yarn by yarn",
        description="Pull, shear or bend a swatch of woven cloth yarn by yarn, in equilibrium, and print its "
        "force curve; -o writes it as a table, with a picture. Ask a lawyer about the patents that "
        "docs/swatch.md names before commercial use.",
    )
    swatch.add_argument("experiment", choices=KINDS, help="what is done to the swatch")
    add_weave_options(swatch)
    swatch.add_argument("--crossings", type=int, metavar="N", help="crossings along a side of the swatch")
    swatch.add_argument(
        "--friction", type=float, metavar="MU",
        help="coefficient between yarns (default: 0.3 for pull-out and snag; yarns are stuck elsewhere)",
    )  # fmt: skip
    swatch.add_argument(
        "--along", choices=("warp", "weft"), default="warp", help="pull along it in uniaxial (default: warp)"
    )
    swatch.add_argument(
        "-o", "--output", type=Path, metavar="FILE.csv", help="write the curve, and its picture as .svg"
    )
    swatch.set_defaults(run=_run_swatch)


def _run_swatch(options: argparse.Namespace) -> int:
    """Carry out an experiment, print its figures, and write them."""
    from toile.dressing.swatch.experiments import EXPERIMENTS, RUBBED
    from toile.dressing.swatch.swatch_picture import swatch_svg
    from toile.dressing.swatch.uniaxial import AXES

    name = options.experiment
    given: dict[str, object] = {}
    if options.crossings is not None:
        given["crossings"] = options.crossings
    if options.friction is not None:
        if name not in RUBBED:
            raise InputError(f"yarns do not slide in {name}: leave out --friction", field="friction")
        given["friction"] = options.friction
    if name == "uniaxial":
        given["axis"] = AXES[options.along]
    elif options.along != "warp":
        raise InputError("--along is for uniaxial", field="along")
    curve = EXPERIMENTS[name](weave_of(options), watch=say_progress, **given)
    print(curve.title)
    print("  ".join(curve.columns))
    for row in curve.rows:
        print(
            "  ".join(f"{figure:{len(column)}.5g}" for figure, column in zip(row, curve.columns, strict=True))
        )
    print("\n".join(curve.notes))
    if options.output is not None:
        options.output.write_text(curve.csv(), encoding="utf-8")
        options.output.with_suffix(".svg").write_text(swatch_svg(curve), encoding="utf-8")
    return DONE if curve.complete else FAILED
