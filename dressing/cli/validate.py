"""The command `toile validate`."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from toile.dressing.cli.parser import DONE, MISSED, Commands, Parser, say_progress
from toile.geometry.errors import InputError

if TYPE_CHECKING:
    from toile.studies.validation.validation_row import ValidationRow


def add_validate(commands: "Commands[Parser]") -> None:
    """Add the validate command."""
    validate = commands.add_parser(
        "validate",
        help="compare the physics with theory and with measured cloth",
        description="Compare the physics with theory and with measured cloth. "
        "The exit code is 1 if a bar is missed.",
    )
    validate.add_argument("case", nargs="*", metavar="NAME", help="only these cases (default: all)")
    validate.add_argument("--json", type=Path, metavar="FILE", help="store the figures")
    validate.set_defaults(run=_run_validate)


def _run_validate(options: argparse.Namespace) -> int:
    """Run cases; the exit code tells whether all bars were met."""
    from toile.dressing.files.suggestion import unknown_name
    from toile.studies.validation.validate import VALIDATIONS, run_validation
    from toile.studies.validation.validation_row import validation_table

    for name in options.case:
        if name not in VALIDATIONS:
            raise InputError(unknown_name("case", name, VALIDATIONS))
    rows: list[ValidationRow] = []
    # Stored at once, so that an unwritable file is known before minutes are spent.
    _store(rows, options.json)
    for row in run_validation(options.case or list(VALIDATIONS)):
        rows.append(row)
        say_progress(f"{row.case}: {row.variant}, {row.quantity}{'' if row.met else ' missed its bar'}")
        _store(rows, options.json)
    print(validation_table(rows))
    return DONE if all(row.met for row in rows) else MISSED


def _store(rows: "list[ValidationRow]", path: Path | None) -> None:
    """Write the figures so far to a file, if there is one."""
    import json

    from toile.dressing.files.writers.atomic import write_atomic
    from toile.studies.validation.validation_row import stored

    if path is None:
        return
    try:
        write_atomic(path, (json.dumps([stored(row) for row in rows], indent=2) + "\n").encode())
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise InputError(
            f"{path}: cannot be written ({reason}); choose another with --json", file=path
        ) from None
