"""The command `toile fabric`."""

import argparse
from pathlib import Path

from toile.dressing.cli.fabric_fit import add_fabric_fit
from toile.dressing.cli.parser import DONE, Commands, Parser


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
    weave.add_argument(
        "--yarn", required=True, metavar="FIBRE:COUNT",
        help="warp yarn, such as cotton:20tex; counts in tex, dtex, den, Ne or Nm",
    )  # fmt: skip
    weave.add_argument("--weft", metavar="FIBRE:COUNT", help="weft yarn (default: as the warp)")
    weave.add_argument("--ends", type=float, required=True, metavar="N", help="warp yarns per centimetre")
    weave.add_argument("--picks", type=float, required=True, metavar="N", help="weft yarns per centimetre")
    weave.add_argument(
        "--weave", default="plain", help="plain, twill, satin, or A/B, such as 3/1 (default: plain)"
    )
    weave.add_argument(
        "--warp-wave", type=float, default=0.5, metavar="SHARE",
        help="share of the waves that is the warp's (default: 0.5)",
    )  # fmt: skip
    weave.add_argument("--name", default="woven", help="name of the fabric (default: woven)")
    weave.add_argument(
        "-o", "--output", type=Path, metavar="FILE.toml", help="write the fabric, and its picture as .svg"
    )
    weave.set_defaults(run=_run_weave)


def _run_weave(options: argparse.Namespace) -> int:
    """Print what is known of a weave, and write it."""
    from toile.dressing.weave.weave_picture import weave_svg
    from toile.dressing.weave.weave_text import weave_lines, weave_table
    from toile.dressing.weave.woven import woven

    cloth = woven(
        options.yarn, options.weft or options.yarn, ends=100.0 * options.ends, picks=100.0 * options.picks,
        weave=options.weave, warp_wave=options.warp_wave,
    )  # fmt: skip
    print("\n".join(weave_lines(cloth)))
    if options.output is not None:
        options.output.write_text(weave_table(cloth, options.name), encoding="utf-8")
        options.output.with_suffix(".svg").write_text(weave_svg(cloth), encoding="utf-8")
    return DONE
