"""The command `toile verify`."""

import argparse
from pathlib import Path

from toile.dressing.cli.parser import DONE, MISSED, Commands, Parser
from toile.geometry.errors import InputError


def add_verify(commands: "Commands[Parser]") -> None:
    """Add the verify command."""
    verify = commands.add_parser(
        "verify",
        help="check results again by their certificates",
        description="Check results that toile dress --certificate has written, from their files alone: every "
        "byte by its hash, and all triangles of every shape by the audit. The exit code is 1 if anything is "
        "not as certified.",
    )
    verify.add_argument("output", nargs="+", type=Path, metavar="OUTDIR", help="folder of a result; repeat")
    verify.set_defaults(run=_run_verify)


def _run_verify(options: argparse.Namespace) -> int:
    """Check results, and print a line for each, and for each fault."""
    from toile.dressing.certificate.verify import read_certificate, verify

    failed = 0
    for folder in options.output:
        try:
            faults = verify(folder)
        except InputError as error:
            if len(options.output) == 1:
                raise
            faults = [str(error)]
        failed += bool(faults)
        for fault in faults:
            print(f"{folder}: {fault}")
        if not faults:
            certificate = read_certificate(folder)
            pairs = sum(sum(shape["crossings"].values()) for shape in certificate["shapes"])
            status, files = certificate["status"].replace("_", " "), len(certificate["outputs"])
            print(
                f"{folder}: {status}; {files} files and {len(certificate['shapes'])} shapes are as "
                f"certified, {pairs} pairs of triangles cross"
            )
    if len(options.output) > 1:
        print(f"{len(options.output) - failed} of {len(options.output)} results are as certified")
    return MISSED if failed else DONE
