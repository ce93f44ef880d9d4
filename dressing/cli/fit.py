"""The command `toile fit`."""

import argparse
import json
from pathlib import Path

from toile.dressing.cli.parser import DONE, Commands, Parser


def add_fit(commands: "Commands[Parser]") -> None:
    """Add the fit command."""
    fit = commands.add_parser(
        "fit",
        help="say how the garments of a result fit",
        description="Say in words where the garments of a result are tight or loose, and what has moved; "
        "toile dress --fit has written it.",
    )
    fit.add_argument("output", type=Path, metavar="OUTDIR", help="folder that toile dress --fit wrote")
    fit.add_argument("--json", action="store_true", help="print fit.json, with all tables")
    fit.set_defaults(run=_run_fit)


def _run_fit(options: argparse.Namespace) -> int:
    """Print how garments fit."""
    from toile.dressing.fit.findings import fit_sentences
    from toile.dressing.fit.read_fit import read_fit

    tables = read_fit(options.output)
    print(json.dumps(tables, indent=1) if options.json else "\n".join(fit_sentences(tables)))
    return DONE
